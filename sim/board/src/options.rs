//! Options: plants and their accidents in a user's words. Options of the command and fields of the page are read here,
//! so both take the same words and refuse the same ones.

use crate::accident::{Accident, Family, NO_PROBE, ROWS};
use crate::bed_plant;
use crate::belt::accident::Accidents;
use crate::belt::layout::LayoutError;
use crate::belt::{BeltPlant, BeltSetup};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::Machine;
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

/// What breaks, by family. Those of heat and of the probe are in the order of their times.
#[derive(Clone, Debug, Default)]
pub struct Breaks {
    /// Of heaters, sensors, fans and the supply.
    pub heat: Vec<Accident>,
    /// Of the probe.
    pub probe: Vec<Accident>,
    /// Of belts: option and text, and what they say.
    belts: Vec<(&'static str, String, Accident)>,
}

impl Breaks {
    /// The accidents of these options and texts, on a machine with these settings, which may have belts that stretch.
    ///
    /// # Errors
    /// No such accident, or none that this machine can have.
    pub fn read<'t>(
        texts: impl IntoIterator<Item = (&'static str, &'t str)>,
        settings: &Settings,
        has_belts: bool,
    ) -> Result<Self, Refusal> {
        let mut breaks = Self::default();
        for (option, text) in texts {
            let accident: Accident = read(option, text)?;
            if let Some(missing) = accident.missing(settings) {
                return Err(Refusal::new(option, text, &missing));
            }
            match accident.row.family {
                Family::Belts if !has_belts => return Err(Refusal::new(option, text, &rigid(&accident))),
                Family::Belts => breaks.belts.push((option, text.to_owned(), accident)),
                Family::Heat | Family::Supply => breaks.heat.push(accident),
                Family::Probe => breaks.probe.push(accident),
            }
        }
        breaks.heat.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        breaks.probe.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        Ok(breaks)
    }

    /// Those of belts.
    fn parts(&self) -> Vec<Accident> {
        self.belts.iter().map(|(.., accident)| accident.clone()).collect()
    }

    /// The refusal of a part that the machine does not have, by the accident's text of today.
    fn refused(&self, today: &str, why: &LayoutError) -> Option<Refusal> {
        let (option, text, _) = self.belts.iter().find(|(.., accident)| accident.text == today)?;
        Some(Refusal::new(option, text, why))
    }
}

/// Why belts that do not stretch have no such accident. Another family may have one of that name.
fn rigid(accident: &Accident) -> String {
    let Accident { row, name, .. } = accident;
    let others = ROWS.iter().filter(|other| other.word == row.word && other.family != row.family);
    let others = others.map(|other| format!(" (of {}: {})", other.family.name(), other.places.says()));
    format!("{} of {name}{} needs belts that stretch: add --plant belt", row.word, others.collect::<String>())
}

/// Belts that stretch.
#[derive(Clone, Copy, Default, Debug)]
pub struct Belts<'a> {
    /// Draws phases and noise.
    pub seed: Option<u64>,
    /// `X,Y,N,MS`.
    pub hits: &'a [String],
}

impl Belts<'_> {
    /// The setup of a machine that is described so.
    ///
    /// # Errors
    /// No such hit.
    pub fn setup(&self, twin: &Description, breaks: &Breaks) -> Result<BeltSetup, Refusal> {
        let hits: Result<_, Refusal> = self.hits.iter().map(|text| read("hit", text)).collect();
        let accidents = Accidents { hits: hits?, parts: breaks.parts() };
        Ok(BeltSetup { twin: twin.clone(), seed: self.seed, accidents })
    }

    /// The plant of a machine, which may begin as if homed.
    ///
    /// # Errors
    /// No such hit, no such part, or no belts do what the machine's motors do.
    pub fn plant(&self, machine: &Machine, homed: Option<[Mm; 3]>, breaks: &Breaks) -> Result<Box<BeltPlant>, Refusal> {
        let setup = self.setup(&machine.twin, breaks)?;
        let plant = BeltPlant::new(&machine.settings, homed, homed.is_some(), setup, 0);
        plant.map(Box::new).map_err(|error| {
            let part = if let LayoutError::NoPart(text, ..) = &error { breaks.refused(text, &error) } else { None };
            part.unwrap_or_else(|| Refusal::new("plant", "belt", &error))
        })
    }
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
    use corehbot::settings::ProbeKind;

    #[test]
    fn a_place_is_three_numbers() {
        assert_eq!(place("1,-2.5, 0").unwrap(), [1.0, -2.5, 0.0].map(Mm::from_num));
        for bad in ["", "1,2", "1,2,3,4", "1,2,z", "1,2,nan", "1,2,1e9"] {
            assert!(place(bad).is_err(), "{bad}");
        }
    }

    fn refused(texts: &[(&'static str, &str)], settings: &Settings, has_belts: bool) -> String {
        let breaks = Breaks::read(texts.iter().copied(), settings, has_belts);
        breaks.map_or_else(|refusal| refusal.to_string(), |_| String::new())
    }

    #[test]
    fn a_refusal_names_the_option_and_its_text() {
        let belts = |hits: &str, option: &'static str, text: &str| {
            let hits: Vec<String> = Some(hits.to_owned()).filter(|hits| !hits.is_empty()).into_iter().collect();
            let (name, settings) = (None, Settings::prototype());
            let texts = Some((option, text)).filter(|_| !text.is_empty());
            let breaks = Breaks::read(texts, &settings, true);
            let machine = Machine { name, board: None, settings, twin: Description::default(), texts: Vec::new() };
            let plant = breaks.and_then(|breaks| Belts { seed: Some(1), hits: &hits }.plant(&machine, None, &breaks));
            plant.map_or_else(|refusal| refusal.to_string(), |_| String::new())
        };
        assert_eq!(belts("1,2,3,4", "brake", "m1,5"), "");
        assert_eq!(belts("1,2,3,4", "accident", "seized:7@20s"), "");
        assert!(belts("1,2", "break", "").starts_with("--hit 1,2: "));
        let motors = "is not a belt motor: m1, m4, m8, m11";
        assert_eq!(belts("", "brake", "m2,5"), format!("--brake m2,5: `m2` {motors}"));
        assert_eq!(belts("", "break", "loose:hotnd@1s"), format!("--break loose:hotnd@1s: `hotnd` {motors}"));
        assert!(belts("", "accident", "seized:99@1s").starts_with("--accident seized:99@1s: `99` is neither"));
        assert!(belts("", "break", "seized:99@1s").starts_with("--break seized:99@1s: `99` is neither"));
    }

    #[test]
    fn what_a_machine_does_not_have_cannot_break() {
        let mut settings = Settings::prototype();
        let refuses = |text: &str, settings: &Settings| refused(&[("break", text)], settings, false);
        assert_eq!(refuses("converter@1s", &settings), "--break converter@1s: the machine has no heater");
        assert!(refuses("early:probe@1s", &settings).contains("the machine has no probe; its file plugs one in"));
        settings.thermal.heaters.hotend.is_fitted = true;
        assert_eq!(refuses("open@1s", &settings), "");
        let told = "the machine has no bed; its file fits one (heaters.bed.is_fitted = true)";
        assert!(refuses("open:bed@1s", &settings).ends_with(told));
        settings.probe.kind = ProbeKind::Switch;
        assert!(refuses("alarm:probe@1s", &settings).contains("no BLTouch"));
        assert_eq!(refuses("early:probe@1s", &settings), "");
        settings.probe.kind = ProbeKind::BlTouch;
        assert_eq!(refuses("alarm:probe@1s", &settings), "");
        // Each family at its place, by time.
        let texts = ["short@2s", "stuck@3s", "rub:m1@1s", "low-supply@1s", "dead@1s"].map(|text| ("break", text));
        let breaks = Breaks::read(texts, &settings, true).unwrap();
        let words = |accidents: &[Accident]| accidents.iter().map(|accident| accident.row.word).collect::<Vec<_>>();
        assert_eq!((words(&breaks.heat), words(&breaks.probe)), (vec!["low-supply", "short"], vec!["dead", "stuck"]));
        assert_eq!(words(&breaks.parts()), ["rub"]);
    }

    #[test]
    fn belts_that_do_not_stretch_are_told_what_to_do() {
        let settings = Settings::prototype();
        let refuses = |option: &'static str, text: &str| refused(&[(option, text)], &settings, false);
        let does = "needs belts that stretch: add --plant belt";
        for (option, text, of) in [
            ("break", "seized:7@1s", "seized of 7"),
            ("accident", "jump:m1@1s", "jump of m1"),
            ("brake", "m1,5", "rub of m1"),
            ("break", "loose:m1@1s", "loose of m1 (of heat: hotend, bed, chamber)"),
        ] {
            assert_eq!(refuses(option, text), format!("--{option} {text}: {of} {does}"));
        }
    }

    #[test]
    fn a_bed_needs_a_probe() {
        let settings = Settings::prototype();
        assert!(bed("bowl=1", &settings).is_err_and(|refusal| refusal.to_string().starts_with("--bed: the machine")));
    }
}
