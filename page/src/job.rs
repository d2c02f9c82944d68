//! Job: the machine, its plants and their accidents, as the page asks for them. It says what the options of
//! `corehbot run` say, in the same words.

use anyhow::{Context as _, Result};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::{self as machine_file, Machine};
use corehbot_rig::bed::BedPlant;
use corehbot_sim::asked::{self, Belts, Refusal};
use corehbot_sim::bed_plant::{self, ProbeAccident};
use corehbot_sim::belt::{BeltPlant, part};
use corehbot_sim::heat_plant::{HeatSetup, accident};
use corehbot_twin::description::Description;
use serde::{Deserialize, Serialize};

/// What the page asks for.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Job {
    /// The G-code file's name.
    pub file: String,
    /// The plate of a file that has several.
    pub plate: Option<u32>,
    /// The machine file's name, and its text; without it, the CoreH-bot prototype.
    pub machine_file: String,
    /// See there.
    pub machine: Option<String>,
    /// `X,Y,Z` in mm: begins as if homed, with the tool there.
    pub homed: Option<String>,
    /// Whether there is the belt plant, and not a rigid machine.
    pub has_belt_plant: bool,
    /// Draws phases and noise of the belt plant: a whole number.
    pub seed: Option<String>,
    /// `X,Y,N,MS`.
    pub hits: Vec<String>,
    /// `MOTOR,N,S,MS`.
    pub brakes: Vec<String>,
    /// `WHAT:WHERE[:HOW]@TIME[+TIME]`.
    pub accidents: Vec<String>,
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
        let homed = self.homed()?;
        let accidents = asked::heat_accidents(&self.breaks, settings)?;
        Ok(Prepared {
            belt: self.belt(&machine, homed)?,
            heat: HeatSetup { truth: None, accidents },
            bed: self.bed(settings)?,
            probe_accidents: asked::probe_accidents(&self.breaks, settings)?,
            homed,
            machine,
        })
    }

    /// The refusals of each field and of each accident, as JSON; none if the machine file is wrong.
    #[must_use]
    pub fn refusals(&self) -> String {
        let Ok(machine) = self.machine() else { return "[]".to_owned() };
        let settings = &machine.settings;
        let homed = self.homed();
        let place = homed.as_ref().ok().copied().flatten();
        let mut found: Vec<Refusal> = homed.err().into_iter().chain(self.bed(settings).err()).collect();
        for job in self.parted() {
            let refusals = [
                job.belt(&machine, place).err(),
                asked::heat_accidents(&job.breaks, settings).err(),
                asked::probe_accidents(&job.breaks, settings).err(),
            ];
            for refusal in refusals.into_iter().flatten() {
                if !found.contains(&refusal) {
                    found.push(refusal);
                }
            }
        }
        serde_json::to_string(&found).unwrap_or_default()
    }

    /// The job without its accidents, and each of them alone: the first wrong one hides no other one.
    fn parted(&self) -> Vec<Self> {
        let mut bare = self.clone();
        let lists: [fn(&mut Self) -> &mut Vec<String>; 4] =
            [|job| &mut job.hits, |job| &mut job.brakes, |job| &mut job.accidents, |job| &mut job.breaks];
        let texts = lists.map(|list| std::mem::take(list(&mut bare)));
        let seedless = Self { seed: None, ..bare.clone() };
        let mut jobs = vec![bare];
        for (list, texts) in lists.into_iter().zip(texts) {
            for text in texts {
                let mut job = seedless.clone();
                list(&mut job).push(text);
                jobs.push(job);
            }
        }
        jobs
    }

    /// The machine.
    ///
    /// # Errors
    /// The file's first error, with its place.
    pub fn machine(&self) -> Result<Machine> {
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

    fn homed(&self) -> Result<Option<[Mm; 3]>, Refusal> {
        let place = |text| asked::place(text).map_err(|why| Refusal::new("assume-homed", text, &why));
        self.homed.as_deref().map(place).transpose()
    }

    fn belt(&self, machine: &Machine, homed: Option<[Mm; 3]>) -> Result<Option<Box<BeltPlant>>, Refusal> {
        let Self { has_belt_plant, seed, hits, brakes, accidents, .. } = self;
        if !has_belt_plant {
            let texts = [("seed", seed.as_ref()), ("hit", hits.first()), ("brake", brakes.first())];
            let asked = texts.into_iter().chain([("accident", accidents.first())]);
            return match asked.filter_map(|(option, text)| Some((option, text?))).next() {
                Some((option, text)) => Err(Refusal::new(option, text, &"only belts that stretch take it")),
                None => Ok(None),
            };
        }
        let whole = |text: &str| {
            let why = format!("expected a whole number, 0 to {}", u64::MAX);
            text.parse::<u64>().map_err(|_| Refusal::new("seed", text, &why))
        };
        let seed = seed.as_deref().map(whole).transpose()?;
        Belts { seed, hits, brakes, accidents }.plant(machine, homed).map(Some)
    }

    fn bed(&self, settings: &Settings) -> Result<Option<Box<BedPlant>>, Refusal> {
        self.bed.as_deref().map(|text| asked::bed(text, settings)).transpose()
    }
}

/// A kind of accident.
#[derive(Serialize)]
struct Known {
    /// The field of [`Job`] that takes it.
    option: &'static str,
    name: &'static str,
    says: &'static str,
    is_of_probe: bool,
    /// What HOW is, in which unit.
    how: Option<[&'static str; 2]>,
}

/// All kinds of accidents that `breaks` and `accidents` may name, as JSON.
#[must_use]
pub fn accidents() -> String {
    let breaks = |name, says, is_of_probe| Known { option: "breaks", name, says, is_of_probe, how: None };
    let heat = accident::KINDS.iter().map(|kind| breaks(kind.name, kind.says, false));
    let probe = bed_plant::accident::KINDS.iter().map(|kind| breaks(kind.name, kind.says, true));
    let parts = part::KINDS.iter().map(|kind| Known {
        option: "accidents",
        name: kind.name,
        says: kind.says,
        is_of_probe: false,
        how: Some([kind.how.says, kind.how.unit]),
    });
    serde_json::to_string(&parts.chain(heat).chain(probe).collect::<Vec<_>>()).unwrap_or_default()
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
        let belts = Job { has_belt_plant: true, ..job.clone() };
        assert!(refusal(&Job { hits: vec!["1,2,3".into()], ..belts.clone() }).contains("X,Y,N,MS"));
        assert!(refusal(&Job { seed: Some("-1".into()), ..belts.clone() }).starts_with("--seed -1: expected a whole"));
        assert!(refusal(&Job { bed: Some("bowl=1".into()), ..job.clone() }).contains("no probe"));
        let [accidents, breaks] = [["seized:m9@1s", "seized:99@1s"], ["kick@1s", "open:hotend@1s"]]
            .map(|two| two.map(str::to_owned).to_vec());
        let wrong = Job { seed: Some("-1".into()), accidents, breaks, ..belts };
        let refusals: Vec<serde_json::Value> = serde_json::from_str(&wrong.refusals()).unwrap();
        let texts: Vec<_> = refusals.iter().filter_map(|refusal| refusal["text"].as_str()).collect();
        assert_eq!(texts, ["-1", "seized:m9@1s", "seized:99@1s", "kick@1s", "open:hotend@1s"]);
        let (machine, machine_file) = (Some("[axes.x]\nlength = 0\n".to_owned()), "mine.toml".to_owned());
        assert!(refusal(&Job { machine, machine_file, ..job }).starts_with("mine.toml:2:"));
        assert!(Job::read("{\"colour\":1}").is_err());
    }
}
