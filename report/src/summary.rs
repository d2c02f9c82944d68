//! Summary: the result of a run, for a person and for a program.

use crate::fault::Fault;
use crate::mesh::MeshSummary;
use crate::moves::StoredMoves;
use crate::sums::{Filament, LayerSum, LimitSum, OutsideSum, TypeSum, by_layer, by_limit, by_type};
use corehbot::motors::{MOTORS, Motor, MotorName, MotorSet};
use corehbot::units::TICKS_PER_SECOND;
use corehbot_machine_file::printable::line;
use corehbot_sim::belt::figures::BeltFigures;
use corehbot_sim::check::Findings;
use corehbot_sim::host::{Answer, FileHost};
use corehbot_sim::slicer::Notes;
use corehbot_sim::tally::{Figures, RATE_WINDOW_MS, SPEED_WINDOW_MS};
use corehbot_sim::world::Outcome;
use serde::{Serialize, Serializer};
use std::fmt;

/// A limit of less than this part of the motion is not told: its percentage would be 0.0.
const LEAST_SHARE: f64 = 0.0005;

/// One number a motor that is fitted, by its name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PerMotor(Vec<(MotorName, i64)>);

impl PerMotor {
    fn new(names: Names<'_>, numbers: [i64; MOTORS]) -> Self {
        let all = Motor::ALL.into_iter().zip(names.motors).zip(numbers);
        let fitted = all.filter(|((motor, _), _)| names.fitted.has(*motor));
        Self(fitted.map(|((_, name), number)| (name, number)).collect())
    }

    /// The names and numbers in the order of the trace's columns.
    pub fn iter(&self) -> impl Iterator<Item = (MotorName, i64)> {
        self.0.iter().copied()
    }
}

impl Serialize for PerMotor {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

/// The figures of one print. The fields have their JSON names.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Summary {
    /// The G-code file.
    pub file: String,
    /// The machine's name.
    pub machine: String,
    /// Whether the print was done and the checker found nothing.
    pub ok: bool,
    /// Lines of the file.
    pub lines: u32,
    /// Commands in them.
    pub commands: u64,
    /// Moves that the planner got from them.
    pub moves: u32,
    /// The whole time, from the printer's start to the last answer: motion, heat and waits.
    pub print_time_s: f64,
    /// Motion time: the clock of the trace and the tool path.
    pub motion_time_s: f64,
    /// The time in which a command waited for a temperature.
    pub heating_time_s: f64,
    /// The rest: waits for the user, and moments in which nothing was under way.
    pub waiting_time_s: f64,
    /// Length of the planned path.
    pub path_mm: f64,
    /// Step pulses, whatever their direction.
    pub steps: PerMotor,
    /// Steps from begin to end, signed.
    pub net_steps: PerMotor,
    /// Fastest the tool moved, over 20 ms.
    pub peak_speed_mm_s: f64,
    /// Most step events a second, over 10 ms.
    pub peak_event_rate_hz: f64,
    /// Instants in which at least one motor stepped.
    pub events: u64,
    /// How often the look-ahead ran dry.
    pub underruns: u32,
    /// Fewest moves in the look-ahead while the stream ran.
    pub look_ahead_low_water: Option<u32>,
    /// Commands that had to be sent again.
    pub resends: u32,
    /// The printer's remarks, the first few.
    pub warnings: Vec<String>,
    /// All of the printer's remarks.
    pub warnings_total: u32,
    /// The printer's answers to the first commands that had one.
    pub answers: Vec<Answer>,
    /// How many commands had one.
    pub answers_total: u32,
    /// Where the host went on instead of a user, the first few places.
    pub pauses: Vec<String>,
    /// How often it did.
    pub pauses_total: u32,
    /// Why the print failed, if it did.
    pub failure: Option<String>,
    /// The same with number, cure, time and document, if the printer said it.
    pub fault: Option<Fault>,
    /// The checker's first few violations.
    pub violations: Vec<String>,
    /// All that the checker found.
    pub violations_total: u64,
    /// The figures of the belt plant, if there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub belt: Option<BeltFigures>,
    /// The mesh that z followed, if it ever did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshSummary>,
    /// Time, way and filament by type of line.
    pub by_type: Vec<TypeSum>,
    /// The same by layer.
    pub by_layer: Vec<LayerSum>,
    /// What comes before the first layer: homing, purge lines.
    pub before_layers: OutsideSum,
    /// What comes after the last printed move.
    pub after_layers: OutsideSum,
    /// How long the print takes by the slicer's estimate, if the file says it.
    pub slicer_time_s: Option<f64>,
    /// The time of moves by what keeps them from being faster.
    pub by_limit: Vec<LimitSum>,
    /// All filament, if any moved.
    pub filament: Option<Filament>,
    /// SHA-256 of the step trace.
    pub trace_sha256: String,
    /// How long the simulation took.
    pub wall_time_s: f64,
}

/// The names of the run's inputs and parts in a summary.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// The G-code file.
    pub file: &'a str,
    /// The machine.
    pub machine: &'a str,
    /// Its motors.
    pub motors: [MotorName; MOTORS],
    /// Those that there are.
    pub fitted: MotorSet,
}

impl Summary {
    /// Joins the results of each part of the simulator.
    pub(crate) fn new(
        names: Names<'_>,
        host: &FileHost,
        outcome: &Outcome,
        figures: &Figures,
        findings: &Findings,
        trace_sha256: String,
    ) -> Self {
        let at = |text: &dyn fmt::Display| format!("{}:{text}", names.file);
        let failure = match host.failure() {
            Some(remark) => Some(at(remark)),
            None if outcome.halted => Some("the printer halted".to_owned()),
            None if host.commands() == 0 => Some("nothing was printed: the file holds no commands".to_owned()),
            None if figures.events == 0 => Some("nothing was printed: no motor made a step".to_owned()),
            None => None,
        };
        let seconds = |ticks: u64| ticks as f64 / f64::from(TICKS_PER_SECOND);
        let (time, heat) = host.time();
        let (motion, heating) = (seconds(outcome.ticks), seconds(heat));
        let whole = seconds(time).max(motion);
        Self {
            file: names.file.to_owned(),
            machine: names.machine.to_owned(),
            ok: failure.is_none() && findings.total == 0,
            lines: host.lines(),
            commands: host.commands(),
            moves: outcome.moves,
            print_time_s: whole,
            motion_time_s: motion,
            heating_time_s: rounded(heating),
            waiting_time_s: rounded((whole - motion - heating).max(0.0)),
            path_mm: outcome.path_um as f64 / 1000.0,
            steps: PerMotor::new(names, figures.pulses.map(|n| n as i64)),
            net_steps: PerMotor::new(names, figures.position),
            peak_speed_mm_s: rounded(figures.peak_speed),
            peak_event_rate_hz: rounded(figures.peak_rate),
            events: figures.events,
            underruns: outcome.underruns,
            look_ahead_low_water: outcome.low_water,
            resends: host.resends(),
            warnings: host.warnings().iter().map(|w| at(w)).collect(),
            warnings_total: host.warnings_total(),
            answers: host.answers().to_vec(),
            answers_total: host.answers_total(),
            pauses: host.pauses().iter().map(|pause| at(pause)).collect(),
            pauses_total: host.pauses_total(),
            failure,
            fault: host.failure().map(|remark| Fault::new(remark, rounded(whole), rounded(motion))),
            violations: findings.first.iter().map(ToString::to_string).collect(),
            violations_total: findings.total,
            belt: None,
            mesh: None,
            by_type: Vec::new(),
            by_layer: Vec::new(),
            before_layers: OutsideSum::default(),
            after_layers: OutsideSum::default(),
            slicer_time_s: None,
            by_limit: Vec::new(),
            filament: None,
            trace_sha256,
            wall_time_s: 0.0,
        }
    }

    /// Notes the sums of the moves.
    pub(crate) fn note_moves<F>(&mut self, moves: &StoredMoves<F>, notes: &Notes) {
        let heights: Vec<_> = moves.by_layer.keys().copied().collect();
        self.by_type = by_type(&moves.by_type, notes);
        self.by_layer = by_layer(&moves.by_layer, &heights);
        [self.before_layers, self.after_layers] = moves.outside.each_ref().map(OutsideSum::new);
        self.by_limit = by_limit(&moves.by_limit);
        self.slicer_time_s = notes.estimate_s();
        let has_filament = self.by_type.iter().any(|row| row.filament_mm != 0.0);
        self.filament = has_filament.then(|| Filament::new(moves.filament_mm, notes));
    }

    /// The summary as JSON, with a line end.
    ///
    /// # Errors
    /// No known case: all fields are numbers and text.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

/// To three decimals: more would be noise.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, value: String| writeln!(f, "{name:<18} {}", line(&value));
        row("file", format!("{} ({} lines, {} commands)", self.file, self.lines, self.commands))?;
        row("machine", self.machine.clone())?;
        row("print time", format!("{} ({:.3} s)", clock(self.print_time_s), self.print_time_s))?;
        let (motion, heating, waiting) = (self.motion_time_s, self.heating_time_s, self.waiting_time_s);
        row("", format!("motion {motion:.3} s, heat {heating:.3} s, waits {waiting:.3} s"))?;
        if let Some(seconds) = self.slicer_time_s {
            // A slicer does not count heating and waits for a user.
            let off = 100.0 * (motion / seconds - 1.0);
            row("slicer's estimate", format!("{}, and motion takes {off:+.0} %", clock(seconds)))?;
        }
        if self.wall_time_s > 0.0 {
            let factor = self.print_time_s / self.wall_time_s;
            row("simulated in", format!("{:.2} s ({factor:.0} times real time)", self.wall_time_s))?;
        }
        row("moves", format!("{} over {:.1} mm", grouped(self.moves.into()), self.path_mm))?;
        row("peak speed", format!("{:.1} mm/s over {SPEED_WINDOW_MS} ms", self.peak_speed_mm_s))?;
        row("step events", grouped(self.events as i64))?;
        let rate = grouped(self.peak_event_rate_hz as i64);
        row("peak event rate", format!("{rate} /s over {RATE_WINDOW_MS} ms"))?;
        let low = self.look_ahead_low_water.map_or("-".to_owned(), |n| n.to_string());
        row("look-ahead", format!("{low} moves at least, {} underruns", self.underruns))?;
        row("trace sha256", self.trace_sha256.clone())?;
        writeln!(f, "\nmotor {:>14} {:>14}", "steps", "net")?;
        for ((name, steps), (_, net)) in self.steps.iter().zip(self.net_steps.iter()) {
            writeln!(f, "{:<5} {:>14} {:>14}", name.as_str(), grouped(steps), grouped(net))?;
        }
        self.write_sums(f)?;
        if let Some(belt) = &self.belt {
            write!(f, "\n{belt}")?;
        }
        if let Some(mesh) = &self.mesh {
            write!(f, "\n{mesh}")?;
        }
        self.write_answers(f)?;
        self.write_troubles(f)
    }
}

impl Summary {
    /// Limits; and filament, layers and types, of a print that lays filament.
    fn write_sums(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(filament) = &self.filament else {
            return if self.by_limit.is_empty() { Ok(()) } else { writeln!(f).and_then(|()| self.write_limits(f)) };
        };
        writeln!(f, "\n{:<30} {:>12} {:>14} {:>10}", "line type", "time", "filament, mm", "moves")?;
        for row in &self.by_type {
            let (time, moves) = (clock(row.seconds), grouped(row.moves as i64));
            writeln!(f, "{:<30} {time:>12} {:>14.1} {moves:>10}", line(&row.name), row.filament_mm)?;
        }
        let Filament { diameter_mm, mm, cm3, g, density_g_cm3, is_density_known } = filament;
        let whose = if *is_density_known { "" } else { " of PLA, as no line sent so far names another" };
        writeln!(
            f,
            "\nfilament           {mm:.1} mm of {diameter_mm} mm, {cm3:.2} cm3, {g:.2} g ({density_g_cm3} g/cm3{whose})"
        )?;
        self.write_limits(f)?;
        let seconds = self.by_layer.iter().map(|row| row.seconds);
        let (least, most) = (seconds.clone().fold(f64::INFINITY, f64::min), seconds.fold(0.0, f64::max));
        let (count, before, after) = (self.by_layer.len(), self.before_layers.seconds, self.after_layers.seconds);
        writeln!(
            f,
            "layers             {count}, {least:.1} to {most:.1} s each; {before:.1} s before, {after:.1} s after them"
        )
    }

    fn write_limits(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let whole: f64 = self.by_limit.iter().map(|row| row.seconds).sum();
        let part = |row: &LimitSum| format!("{} {:.1} %", row.limit.name(), 100.0 * row.seconds / whole);
        let is_seen = |row: &&LimitSum| row.seconds >= LEAST_SHARE * whole;
        let limits: Vec<_> = self.by_limit.iter().filter(is_seen).map(part).collect();
        if limits.is_empty() { Ok(()) } else { writeln!(f, "limited by         {}", limits.join(", ")) }
    }

    fn write_answers(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.answers_total > 0 {
            writeln!(f, "\nanswers: {}", self.answers_total)?;
        }
        for answer in &self.answers {
            let place = if answer.line > 0 { format!("{}:{}", self.file, answer.line) } else { self.file.clone() };
            writeln!(f, "  {}: {}", line(&place), line(&answer.command))?;
            for reply in &answer.replies {
                writeln!(f, "    {}", line(reply))?;
            }
        }
        if self.answers_total as usize > self.answers.len() { writeln!(f, "  ...") } else { Ok(()) }
    }

    fn write_troubles(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lists = [
            ("pauses", &self.pauses, self.pauses_total.into()),
            ("warnings", &self.warnings, self.warnings_total.into()),
            ("violations", &self.violations, self.violations_total),
        ];
        for (name, list, total) in lists {
            if total > 0 {
                writeln!(f, "\n{name}: {total}")?;
            }
            for item in list {
                writeln!(f, "  {}", line(item))?;
            }
            if total > list.len() as u64 && !list.is_empty() {
                writeln!(f, "  ...")?;
            }
        }
        if let Some(failure) = &self.failure {
            writeln!(f, "\nfailed: {}", line(failure))?;
        }
        Ok(())
    }
}

/// h:mm:ss.
fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}

/// With a comma between groups of three digits.
fn grouped(value: i64) -> String {
    let digits = value.unsigned_abs().to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    if value < 0 { format!("-{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(grouped(-1_234_567), "-1,234,567");
        assert_eq!(grouped(999), "999");
        assert_eq!(clock(3_725.4), "1:02:05");
    }
}
