//! Job: the machine, its plants and their accidents, as the page asks for them. It says what the options of
//! `corehbot run` say, in the same words.

use anyhow::{Context as _, Result};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::{self as machine_file, Machine};
use corehbot_rig::bed::BedPlant;
use corehbot_sim::accident::{Accident, ROWS};
use corehbot_sim::belt::BeltPlant;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::options::{self, Belts, Breaks, Refusal};
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
    /// `WHAT[:WHERE[:HOW]]@TIME[+TIME]`.
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
    pub probe_accidents: Vec<Accident>,
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
        let breaks = self.breaks(settings)?;
        Ok(Prepared {
            belt: self.belt(&machine, homed, &breaks)?,
            heat: HeatSetup { truth: None, accidents: breaks.heat },
            bed: self.bed(settings)?,
            probe_accidents: breaks.probe,
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
            let refusal = job.breaks(settings).and_then(|breaks| job.belt(&machine, place, &breaks)).err();
            found.extend(refusal.filter(|refusal| !found.contains(refusal)));
        }
        serde_json::to_string(&found).unwrap_or_default()
    }

    /// The job without its accidents, and each of them alone: the first wrong one hides no other one.
    fn parted(&self) -> Vec<Self> {
        let mut bare = self.clone();
        let lists: [fn(&mut Self) -> &mut Vec<String>; 2] = [|job| &mut job.hits, |job| &mut job.breaks];
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
            return Ok(Machine {
                name: Some("CoreH-bot prototype".to_owned()),
                board: None,
                settings,
                twin,
                texts: Vec::new(),
            });
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
        let place = |text| options::place(text).map_err(|why| Refusal::new("assume-homed", text, &why));
        self.homed.as_deref().map(place).transpose()
    }

    fn breaks(&self, settings: &Settings) -> Result<Breaks, Refusal> {
        let texts = self.breaks.iter().map(|text| ("break", text.as_str()));
        Breaks::read(texts, settings, self.has_belt_plant)
    }

    fn belt(
        &self,
        machine: &Machine,
        homed: Option<[Mm; 3]>,
        breaks: &Breaks,
    ) -> Result<Option<Box<BeltPlant>>, Refusal> {
        let Self { has_belt_plant, seed, hits, .. } = self;
        if !has_belt_plant {
            let asked = [("seed", seed.as_ref()), ("hit", hits.first())];
            return match asked.into_iter().filter_map(|(option, text)| Some((option, text?))).next() {
                Some((option, text)) => Err(Refusal::new(option, text, &"only belts that stretch take it")),
                None => Ok(None),
            };
        }
        let whole = |text: &str| {
            let why = format!("expected a whole number, 0 to {}", u64::MAX);
            text.parse::<u64>().map_err(|_| Refusal::new("seed", text, &why))
        };
        let seed = seed.as_deref().map(whole).transpose()?;
        Belts { seed, hits }.plant(machine, homed, breaks).map(Some)
    }

    fn bed(&self, settings: &Settings) -> Result<Option<Box<BedPlant>>, Refusal> {
        self.bed.as_deref().map(|text| options::bed(text, settings)).transpose()
    }
}

/// A row of the table of accidents.
#[derive(Serialize)]
struct Known {
    word: &'static str,
    family: &'static str,
    says: &'static str,
    /// The names of its places; none for parts of belts, which the machine names.
    places: Vec<&'static str>,
    needs_belts: bool,
    /// What HOW is, in which unit.
    how: Option<[&'static str; 2]>,
}

/// The table of accidents, as JSON.
#[must_use]
pub fn accidents() -> String {
    let known = ROWS.iter().map(|row| Known {
        word: row.word,
        family: row.family.name(),
        says: row.says,
        places: row.names().collect(),
        needs_belts: row.family.needs_belts(),
        how: row.how.map(|how| [how.says, how.unit]),
    });
    serde_json::to_string(&known.collect::<Vec<_>>()).unwrap_or_default()
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
        assert!(refusal(&Job { breaks: vec!["rub:m1@1s".into()], ..job.clone() }).contains("add --plant belt"));
        let breaks = ["seized:m9@1s", "seized:99@1s", "kick@1s", "open:hotend@1s"].map(str::to_owned).to_vec();
        let wrong = Job { seed: Some("-1".into()), breaks, ..belts };
        let refusals: Vec<serde_json::Value> = serde_json::from_str(&wrong.refusals()).unwrap();
        let texts: Vec<_> = refusals.iter().filter_map(|refusal| refusal["text"].as_str()).collect();
        assert_eq!(texts, ["-1", "seized:m9@1s", "seized:99@1s", "kick@1s", "open:hotend@1s"]);
        let (machine, machine_file) = (Some("[axes.x]\nlength = 0\n".to_owned()), "mine.toml".to_owned());
        assert!(refusal(&Job { machine, machine_file, ..job }).starts_with("mine.toml:2:"));
        assert!(Job::read("{\"colour\":1}").is_err());
    }

    /// Texts between single quotes with a time, or with a place alone, as the page's buttons have them.
    fn quoted<'s>(script: &'s str, from: &str, to: &str) -> Vec<&'s str> {
        let list = script.split_once(from).and_then(|(_, rest)| rest.split_once(to)).unwrap().0;
        list.split('\'').skip(1).step_by(2).filter(|text| text.contains(':')).collect()
    }

    #[test]
    fn the_buttons_of_the_page_are_accidents_of_the_table() {
        let presets = quoted(include_str!("../www/printing.js"), "const PRESETS = [", "];");
        let at_terminal = quoted(include_str!("../www/terminal.js"), "const ACCIDENTS = [", "];");
        let at_once = at_terminal.iter().map(|text| format!("{text}@0s"));
        for text in presets.iter().map(|text| (*text).to_owned()).chain(at_once) {
            assert!(text.parse::<Accident>().is_ok(), "{text}");
        }
        assert!(presets.len() > 4 && at_terminal.len() > 1, "{presets:?} {at_terminal:?}");
    }
}
