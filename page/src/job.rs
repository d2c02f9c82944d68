//! Job: the machine, its plants and their accidents, as the page asks for them. It says what the options of
//! `corehbot run` say, in the same words.

use anyhow::{Context as _, Result, bail, ensure};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::{self as machine_file, Machine};
use corehbot_rig::bed::{BedPlant, has_probe};
use corehbot_sim::bed_plant::{self, ProbeAccident};
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::heat_plant::{Accident, HeatSetup, accident};
use corehbot_twin::description::Description;
use serde::{Deserialize, Serialize};

/// Farthest place of the tool in mm, as `--assume-homed` has it.
const FARTHEST_MM: f64 = 5000.0;

/// What the page asks for.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Job {
    /// The G-code file's name.
    pub file: String,
    /// The machine file's name, and its text; without it, the CoreH-bot prototype.
    pub machine_file: String,
    /// See there.
    pub machine: Option<String>,
    /// `X,Y,Z` in mm: begins as if homed, with the tool there.
    pub homed: Option<String>,
    /// Whether there is the belt plant, and not a rigid machine.
    pub has_belt_plant: bool,
    /// Draws phases and noise of the belt plant.
    pub seed: Option<u64>,
    /// `X,Y,N,MS`.
    pub hits: Vec<String>,
    /// `MOTOR,N,S,MS`.
    pub brakes: Vec<String>,
    /// `WHAT:WHERE@TIME`.
    pub breaks: Vec<String>,
    /// `KEY=VALUE,..`.
    pub bed: Option<String>,
}

/// A machine and its plants that can be switched on.
pub struct Prepared {
    /// The machine.
    pub machine: Machine,
    /// Where it begins as if homed.
    pub homed: Option<[Mm; 3]>,
    /// Its belts, if they stretch.
    pub belt: Option<Box<BeltPlant>>,
    /// Its heat.
    pub heat: HeatSetup,
    /// Its bed.
    pub bed: Option<Box<BedPlant>>,
    /// Accidents of its probe.
    pub probe_accidents: Vec<ProbeAccident>,
}

impl Job {
    /// Reads JSON.
    ///
    /// # Errors
    /// Unknown fields.
    pub fn read(json: &str) -> Result<Self> {
        serde_json::from_str(json).context("the page asks for something unknown")
    }

    /// Everything that can be wrong before there is a printer.
    ///
    /// # Errors
    /// What it is.
    pub fn prepare(&self) -> Result<Prepared> {
        let machine = self.machine()?;
        let settings = &machine.settings;
        let homed = self.homed.as_deref().map(place).transpose()?;
        let (heat, probe_accidents) = self.accidents(settings)?;
        Ok(Prepared {
            belt: self.belt(&machine, homed)?,
            heat,
            bed: self.bed(settings)?,
            probe_accidents,
            homed,
            machine,
        })
    }

    fn machine(&self) -> Result<Machine> {
        let Some(text) = &self.machine else {
            let (settings, twin) = (Settings::prototype(), Description::default());
            return Ok(Machine { name: Some("CoreH-bot prototype".to_owned()), board: None, settings, twin });
        };
        let name = &self.machine_file;
        let parsed = machine_file::parse(text);
        let mut machine = parsed.map_err(|error| match error.place(text) {
            Some(place) => anyhow::anyhow!("{name}:{place}: {error}"),
            None => anyhow::anyhow!("{name}: {error}"),
        })?;
        machine.name = machine.name.or_else(|| Some(name.strip_suffix(".toml").unwrap_or(name).to_owned()));
        Ok(machine)
    }

    fn belt(&self, machine: &Machine, homed: Option<[Mm; 3]>) -> Result<Option<Box<BeltPlant>>> {
        if !self.has_belt_plant {
            ensure!(self.hits.is_empty() && self.brakes.is_empty(), "only belts that stretch have hits and brakes");
            return Ok(None);
        }
        let hits = self.hits.iter().map(|text| text.parse().with_context(|| format!("hit {text}")));
        let brakes = self.brakes.iter().map(|text| text.parse().with_context(|| format!("brake {text}")));
        let mut setup = BeltSetup { twin: machine.twin.clone(), seed: self.seed, accidents: Accidents::default() };
        setup.accidents.hits = hits.collect::<Result<_>>()?;
        setup.accidents.brakes = brakes.collect::<Result<_>>()?;
        let plant = BeltPlant::new(&machine.settings, homed, homed.is_some(), setup, 0);
        Ok(Some(Box::new(plant.context("belts that stretch")?)))
    }

    fn accidents(&self, settings: &Settings) -> Result<(HeatSetup, Vec<ProbeAccident>)> {
        let (mut heat, mut probe) = (Vec::new(), Vec::new());
        for text in &self.breaks {
            if ProbeAccident::is_one(text) {
                if !has_probe(settings) {
                    bail!("{text}: the machine has no probe; its file plugs one in (endstops.probe)");
                }
                probe.push(text.parse::<ProbeAccident>().with_context(|| text.clone())?);
                continue;
            }
            let accident: Accident = text.parse().with_context(|| text.clone())?;
            if let Some(missing) = accident.missing(&settings.thermal) {
                bail!("{text}: {missing}");
            }
            heat.push(accident);
        }
        heat.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        probe.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        Ok((HeatSetup { truth: None, accidents: heat }, probe))
    }

    fn bed(&self, settings: &Settings) -> Result<Option<Box<BedPlant>>> {
        let Some(text) = &self.bed else { return Ok(None) };
        if !has_probe(settings) {
            bail!("a bed of its own: the machine has no probe; its file plugs one in (endstops.probe)");
        }
        let setup = bed_plant::read(text, settings).with_context(|| format!("bed {text}"))?;
        Ok(Some(Box::new(BedPlant::new(settings, &setup))))
    }
}

/// Three numbers in the range of any machine; the firmware decides whether this machine can hold them.
fn place(text: &str) -> Result<[Mm; 3]> {
    let number = |part: &str| part.trim().parse().ok().filter(|mm: &f64| mm.abs() <= FARTHEST_MM);
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some([x, y, z]) => Ok([x, y, z].map(|mm| Mm::from_num(*mm))),
        _ => bail!("`{text}` is not a place: expected three numbers in mm, X,Y,Z"),
    }
}

#[derive(Serialize)]
struct Known {
    name: &'static str,
    says: &'static str,
    is_of_probe: bool,
}

/// All kinds of accidents that `breaks` may name, as JSON.
#[must_use]
pub fn accidents() -> String {
    let heat = accident::KINDS.iter().map(|kind| Known { name: kind.name, says: kind.says, is_of_probe: false });
    let probe =
        bed_plant::accident::KINDS.iter().map(|kind| Known { name: kind.name, says: kind.says, is_of_probe: true });
    serde_json::to_string(&heat.chain(probe).collect::<Vec<_>>()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(job: &Job) -> String {
        job.prepare().map_or_else(|error| format!("{error:#}"), |_| String::new())
    }

    #[test]
    fn what_cannot_be_is_told_before_there_is_a_printer() {
        let job = Job::default();
        assert_eq!(refusal(&job), "");
        assert!(refusal(&Job { homed: Some("1,2".into()), ..job.clone() }).contains("three numbers"));
        assert!(refusal(&Job { breaks: vec!["open:hotend@60s".into()], ..job.clone() }).contains("no hotend"));
        assert!(refusal(&Job { breaks: vec!["kick:hotend@60s".into()], ..job.clone() }).contains("not an accident"));
        assert!(refusal(&Job { hits: vec!["1,2,3,4".into()], ..job.clone() }).contains("belts that stretch"));
        let hit = Job { hits: vec!["1,2,3".into()], has_belt_plant: true, ..job.clone() };
        assert!(refusal(&hit).contains("X,Y,N,MS"));
        let (machine, machine_file) = (Some("[axes.x]\nlength = 0\n".to_owned()), "mine.toml".to_owned());
        assert!(refusal(&Job { machine, machine_file, ..job }).starts_with("mine.toml:2:"));
        assert!(Job::read("{\"colour\":1}").is_err());
    }
}
