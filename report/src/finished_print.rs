//! Ended: a print that is over, as the parts of the simulator know it. The summary of the command and of the page is
//! made here.

use crate::mesh::MeshSummary;
use crate::moves::StoredMoves;
use crate::summary::{Names, Summary};
use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use corehbot_sim::bed_plant::FLOOR_MM;
use corehbot_sim::check::Findings;
use corehbot_sim::host::{FileHost, Requests};
use corehbot_sim::limits::Limits;
use corehbot_sim::tally::Figures;
use corehbot_sim::world::{Desk, Outcome};

/// Message about a file with M92: its steps have two sizes.
const UNITS_CHANGED: &str = "M92 changes the steps: speeds and paths are shown in the old unit and not judged";

/// What each part knows.
pub struct Ended<'a, M> {
    /// File, machine and motors.
    pub names: Names<'a>,
    /// The machine.
    pub settings: &'a Settings,
    /// Its limits in this print.
    pub limits: &'a Limits,
    /// The host that has sent the file.
    pub host: &'a FileHost,
    /// The result of the world.
    pub outcome: &'a Outcome,
    /// Speeds and steps.
    pub figures: &'a Figures,
    /// Violations.
    pub findings: &'a Findings,
    /// The moves.
    pub moves: &'a StoredMoves<M>,
    /// SHA-256 of the step trace.
    pub trace_sha256: &'a str,
}

impl<M> Ended<'_, M> {
    /// The summary. Belts on the desk ring out first.
    #[must_use]
    pub fn summary(&self, desk: &mut Desk) -> Summary {
        let Self { names, settings, limits, host, outcome, figures, findings, moves, trace_sha256 } = *self;
        let mut summary = Summary::new(names, host, outcome, figures, findings, trace_sha256.to_owned());
        summary.note_moves(moves, host.notes());
        summary.note_desk(desk, outcome);
        summary.note_asked(host.asked(), settings);
        if !limits.is_judged {
            summary.warnings.push(format!("{}: {UNITS_CHANGED}", names.file));
            summary.warnings_total += 1;
        }
        summary
    }
}

impl Summary {
    /// Notes the belts, the mesh that z followed, and how deep the nozzle was in the bed, if deeper than a bed stands.
    fn note_desk(&mut self, desk: &mut Desk, outcome: &Outcome) {
        self.belt = desk.belt.as_mut().map(|plant| {
            plant.ring_out();
            plant.figures()
        });
        let bed = desk.bed.as_deref();
        let effect = desk.mesh_log.as_ref().and_then(|log| log.effect(bed));
        self.mesh = effect.map(|effect| MeshSummary::new(effect, outcome.slowed_moves));
        if let Some(depth) = bed.and_then(|bed| bed.deepest()).filter(|depth| depth.mm > FLOOR_MM) {
            let (mm, [x, y, z]) = (depth.mm, depth.nozzle);
            self.ok = false;
            self.violations_total += 1;
            self.violations.push(format!("the nozzle was {mm:.3} mm below the bed, at X{x:.2} Y{y:.2} Z{z:.3}"));
        }
    }

    /// Notes requests that had no effect on this machine: heat without a heater, and filament that never moved.
    fn note_asked(&mut self, asked: Requests, settings: &Settings) {
        let has_heaters = Heater::ALL.into_iter().any(|heater| settings.thermal.heater(heater).is_fitted);
        if asked.heating > 0 && !has_heaters {
            let commands = if asked.heating == 1 { "command" } else { "commands" };
            self.warnings.push(format!(
                "{}: {} heating {commands} ignored: no heater fitted, see [heaters] in the machine file",
                self.file, asked.heating
            ));
            self.warnings_total += 1;
        }
        let extruder = settings.mechanism.extruder().map(|motor| settings.name_of(motor));
        let steps = extruder.and_then(|extruder| self.steps.iter().find(|(name, _)| *name == extruder));
        if asked.filament && !asked.dry_run && steps.is_some_and(|(_, steps)| steps == 0) {
            let why = format!("{}: filament was commanded, but none moved: was the hotend cold?", self.file);
            self.ok = false;
            self.failure.get_or_insert(why);
        }
    }
}
