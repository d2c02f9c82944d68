//! Asked: plants and their accidents in a user's words. Options of the command and fields of the page are read here, so
//! both take the same words and refuse the same ones.

use crate::bed_plant::{self, ProbeAccident};
use crate::belt::accident::Accidents;
use crate::belt::layout::LayoutError;
use crate::belt::{BeltPlant, BeltSetup};
use crate::heat_plant::Accident;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_machine_file::Machine;
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::bed::{BedPlant, has_probe};
use corehbot_twin::description::Description;
use serde::Serialize;
use std::fmt::{self, Display};
use std::str::FromStr;

/// Farthest place of a tool in mm. No machine here is as large.
const FARTHEST_MM: f64 = 5000.0;

/// An option that cannot be obeyed.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Refusal {
    /// Its name: `hit`, `break`, `plant`.
    pub option: &'static str,
    /// Its text, if this is at fault.
    pub text: String,
    /// The reason.
    pub why: String,
}

impl Refusal {
    /// The refusal of an option with this text.
    #[must_use]
    pub fn new(option: &'static str, text: &str, why: &dyn Display) -> Self {
        Self { option, text: text.to_owned(), why: why.to_string() }
    }
}

impl Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { option, text, why } = self;
        let blank = if text.is_empty() { "" } else { " " };
        write!(f, "--{option}{blank}{text}: {why}")
    }
}

impl std::error::Error for Refusal {}

fn read<T: FromStr<Err: Display>>(option: &'static str, text: &str) -> Result<T, Refusal> {
    text.trim().parse().map_err(|error: T::Err| Refusal::new(option, text, &error))
}

fn read_all<T: FromStr<Err: Display>>(option: &'static str, texts: &[String]) -> Result<Vec<T>, Refusal> {
    texts.iter().map(|text| read(option, text)).collect()
}

/// Belts that stretch.
#[derive(Clone, Copy, Default, Debug)]
pub struct Belts<'a> {
    /// Draws phases and noise.
    pub seed: Option<u64>,
    /// `X,Y,N,MS`.
    pub hits: &'a [String],
    /// `MOTOR,N[,S[,MS]]`.
    pub brakes: &'a [String],
    /// `WHAT:WHERE[:HOW]@TIME[+TIME]`.
    pub accidents: &'a [String],
}

impl Belts<'_> {
    /// The setup of a machine that is described so.
    ///
    /// # Errors
    /// No such accident.
    pub fn setup(&self, twin: &Description) -> Result<BeltSetup, Refusal> {
        let (hits, brakes) = (read_all("hit", self.hits)?, read_all("brake", self.brakes)?);
        let accidents = Accidents { hits, brakes, parts: read_all("accident", self.accidents)? };
        Ok(BeltSetup { twin: twin.clone(), seed: self.seed, accidents })
    }

    /// The plant of a machine, which may begin as if homed.
    ///
    /// # Errors
    /// No such accident, no such part, or no belts do what the machine's motors do.
    pub fn plant(&self, machine: &Machine, homed: Option<[Mm; 3]>) -> Result<Box<BeltPlant>, Refusal> {
        let setup = self.setup(&machine.twin)?;
        let plant = BeltPlant::new(&machine.settings, homed, homed.is_some(), setup, 0);
        plant.map(Box::new).map_err(|error| match &error {
            LayoutError::NoBrake(name, _) => {
                let is_of = |text: &&String| text.split(',').next().is_some_and(|motor| motor.trim() == name.as_str());
                let text = self.brakes.iter().find(is_of);
                Refusal::new("brake", text.map_or(name.as_str(), |text| text), &error)
            }
            LayoutError::NoPart(text, ..) => Refusal::new("accident", text, &error),
            _ => Refusal::new("plant", "belt", &error),
        })
    }
}

/// Accidents of heat among those of `break`, by time.
///
/// # Errors
/// No such accident, or no heater that could break.
pub fn heat_accidents(breaks: &[String], settings: &Settings) -> Result<Vec<Accident>, Refusal> {
    let mut accidents = Vec::new();
    for text in breaks.iter().filter(|text| !ProbeAccident::is_one(text)) {
        let accident: Accident = read("break", text)?;
        if let Some(missing) = accident.missing(&settings.thermal) {
            return Err(Refusal::new("break", text, &missing));
        }
        accidents.push(accident);
    }
    accidents.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    Ok(accidents)
}

/// Why a machine without a probe has no bed of its own, and no accidents of a probe.
const NO_PROBE: &str = "the machine has no probe; its file plugs one in (endstops.probe)";

const NO_BLTOUCH: &str = "the machine has no BLTouch, and no other probe is ever in alarm (probe.kind)";

/// Accidents of the probe among those of `break`, by time.
///
/// # Errors
/// No such accident, or no probe that could break.
pub fn probe_accidents(breaks: &[String], settings: &Settings) -> Result<Vec<ProbeAccident>, Refusal> {
    let mut accidents = Vec::new();
    for text in breaks.iter().filter(|text| ProbeAccident::is_one(text)) {
        let accident = read::<ProbeAccident>("break", text)?;
        if !has_probe(settings) {
            return Err(Refusal::new("break", text, &NO_PROBE));
        }
        if accident.fault(settings) == ProbeFault::Alarm && settings.probe.kind != ProbeKind::BlTouch {
            return Err(Refusal::new("break", text, &NO_BLTOUCH));
        }
        accidents.push(accident);
    }
    accidents.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    Ok(accidents)
}

/// The bed under the nozzle, `KEY=VALUE,..`.
///
/// # Errors
/// No such bed, or no probe that could find it.
pub fn bed(text: &str, settings: &Settings) -> Result<Box<BedPlant>, Refusal> {
    if !has_probe(settings) {
        return Err(Refusal::new("bed", "", &NO_PROBE));
    }
    let setup = bed_plant::read(text, settings).map_err(|error| Refusal::new("bed", text, &error))?;
    Ok(Box::new(BedPlant::new(settings, &setup)))
}

/// Three numbers in the range of any machine, `X,Y,Z`; the firmware decides whether this machine can hold them.
///
/// # Errors
/// The reason why they are no place.
pub fn place(text: &str) -> Result<[Mm; 3], String> {
    let mut numbers = text.split(',').map(|part| match part.trim().parse::<f64>() {
        Ok(v) if v.abs() <= FARTHEST_MM => Ok(Mm::from_num(v)),
        _ => Err(format!("`{part}` is not a position of -{FARTHEST_MM} to {FARTHEST_MM} mm")),
    });
    let mut next = || numbers.next().unwrap_or_else(|| Err("expected three numbers: X,Y,Z".to_owned()));
    let place = [next()?, next()?, next()?];
    if numbers.next().is_some() { Err("expected three numbers: X,Y,Z".to_owned()) } else { Ok(place) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_three_numbers() {
        assert_eq!(place("1,-2.5, 0").unwrap(), [1.0, -2.5, 0.0].map(Mm::from_num));
        for bad in ["", "1,2", "1,2,3,4", "1,2,z", "1,2,nan", "1,2,1e9"] {
            assert!(place(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_refusal_names_the_option_and_its_text() {
        let belts = |hits: &str, brakes: &str, accidents: &str| {
            let [hits, brakes, accidents] =
                [hits, brakes, accidents].map(|text| if text.is_empty() { Vec::new() } else { vec![text.to_owned()] });
            let (name, settings) = (None, Settings::prototype());
            let machine = Machine { name, board: None, settings, twin: Description::default() };
            let belts = Belts { seed: Some(1), hits: &hits, brakes: &brakes, accidents: &accidents };
            belts.plant(&machine, None).map_or_else(|refusal| refusal.to_string(), |_| String::new())
        };
        assert_eq!(belts("1,2,3,4", "m1,5", "seized:7@20s"), "");
        assert!(belts("1,2", "", "").starts_with("--hit 1,2: "));
        assert!(belts("", "m2,5", "").starts_with("--brake m2,5: `m2` is not a belt motor"));
        assert!(belts("", "", "seized:99@1s").starts_with("--accident seized:99@1s: `99` is neither"));
        let (breaks, settings) = (["open:hotend@1s".to_owned(), "early:probe@1s".to_owned()], Settings::prototype());
        assert_eq!(heat_accidents(&breaks, &settings).unwrap_err().text, breaks[0]);
        assert_eq!(probe_accidents(&breaks, &settings).unwrap_err().text, breaks[1]);
        let mut probed = settings;
        probed.probe.kind = ProbeKind::Switch;
        let alarm = ["alarm:probe@1s".to_owned()];
        assert!(probe_accidents(&alarm, &probed).is_err_and(|refusal| refusal.to_string().contains("no BLTouch")));
        probed.probe.kind = ProbeKind::BlTouch;
        assert_eq!(probe_accidents(&alarm, &probed).unwrap().len(), 1);
        assert!(bed("bowl=1", &settings).is_err_and(|refusal| refusal.to_string().starts_with("--bed: the machine")));
    }
}
