//! Accidents of heat: the broken part, its place, and the time. One row of [`KINDS`] is one kind; the grammar, its
//! errors, the list in docs/explanation/heat.md and the soak follow that table.

use corehbot::connectors::Heater;
use corehbot::settings::ThermalSettings;
use corehbot_rig::plant::{HeaterFault, PlantFaults, SensorFault};
use std::fmt;
use std::str::FromStr;

/// The effect of a kind of accident.
#[derive(Clone, Copy, Debug)]
pub enum Does {
    /// To a heater's sensor.
    Sensor(SensorFault),
    /// To a heater and its switch.
    Heater(HeaterFault),
    /// A fan stops.
    FanDead,
    /// To the machine as a whole.
    Machine(fn(&mut PlantFaults)),
}

/// A kind of accident.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Its effect.
    pub does: Does,
    /// Its description for people.
    pub says: &'static str,
}

const fn kind(name: &'static str, does: Does, says: &'static str) -> Kind {
    Kind { name, does, says }
}

/// Every kind. The first is the one that errors show.
pub const KINDS: [Kind; 15] = [
    kind("open", Does::Sensor(SensorFault::Open), "a wire of the sensor is off"),
    kind("short", Does::Sensor(SensorFault::ShortToGround), "the sensor is shorted to ground"),
    kind("frozen", Does::Sensor(SensorFault::Frozen), "the reading does not change any more"),
    kind(
        "loose",
        Does::Sensor(SensorFault::Intermittent { period_seconds: 2.0, open_seconds: 0.3 }),
        "the sensor's contact opens for 0.3 s in every 2 s",
    ),
    kind(
        "slipped",
        Does::Sensor(SensorFault::Slipped { lag_seconds: 10.0 }),
        "the sensor is out of its hole and reads the room, 10 s late",
    ),
    kind("late", Does::Sensor(SensorFault::ExtraLag { lag_seconds: 20.0 }), "the sensor sits loosely: 20 s later"),
    kind("no-heat", Does::Heater(HeaterFault::OPEN), "the heater is open"),
    kind("weak", Does::Heater(HeaterFault { power: 0.25, stuck_on: false }), "the heater has a quarter of its power"),
    kind("stuck-on", Does::Heater(HeaterFault::STUCK_ON), "the heater's switch does not switch off"),
    kind("fan-dead", Does::FanDead, "the fan stands still"),
    kind("converter", Does::Machine(|faults| faults.converter_stopped = true), "no more readings come"),
    kind("channels", Does::Machine(|faults| faults.channels_slipped = true), "readings are off by one place"),
    kind(
        "swapped-sensors",
        Does::Machine(|faults| faults.swapped_sensors = true),
        "hotend's and bed's sensors are swapped",
    ),
    kind(
        "swapped-heaters",
        Does::Machine(|faults| faults.swapped_heaters = true),
        "hotend's and bed's heaters are swapped",
    ),
    kind("low-supply", Does::Machine(|faults| faults.supply_volts = 12.0), "the heaters' supply gives 12 V"),
];

/// Where something breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Where {
    /// A heater or its sensor.
    Heater(Heater),
    /// The part fan.
    PartFan,
    /// The hotend's fan.
    HotendFan,
    /// The machine.
    Machine,
}

/// Latest time, in s: a year.
const LATEST_S: f64 = 31_536_000.0;

/// Something that breaks.
#[derive(Clone, Copy, Debug)]
pub struct Accident {
    /// Its kind.
    pub kind: &'static Kind,
    /// Where.
    pub place: Where,
    /// When, in s after power-up.
    pub at_s: f64,
}

/// Why a text does not describe an accident.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AccidentError {
    /// It has not the parts that it needs.
    Form,
    /// The kind is unknown.
    Kind(String),
    /// This kind has no such place: the kind, the places that it has, the text.
    Where(&'static str, &'static str, String),
    /// The time is not valid.
    Time(String),
}

impl fmt::Display for AccidentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Form => f.write_str("expected WHAT[:WHERE]@TIME, such as open:hotend@60s"),
            Self::Kind(text) => {
                write!(f, "`{text}` is not an accident; expected ")?;
                for (place, kind) in KINDS.iter().enumerate() {
                    write!(f, "{}{}", if place > 0 { ", " } else { "" }, kind.name)?;
                }
                Ok(())
            }
            Self::Where(kind, places, text) => write!(f, "`{text}` is not a place for {kind}: {places}"),
            Self::Time(text) => write!(f, "`{text}` is not a time after power-up: 60s, 2.5m, 1h; a year at most"),
        }
    }
}

impl std::error::Error for AccidentError {}

impl Does {
    /// The places that it may have, by name; the first is the default.
    const fn places(&self) -> &'static [(&'static str, Where)] {
        match self {
            Self::Sensor(_) | Self::Heater(_) => &[
                ("hotend", Where::Heater(Heater::Hotend)),
                ("bed", Where::Heater(Heater::Bed)),
                ("chamber", Where::Heater(Heater::Chamber)),
            ],
            Self::FanDead => &[("hotend", Where::HotendFan), ("part", Where::PartFan)],
            Self::Machine(_) => &[("machine", Where::Machine)],
        }
    }

    /// The same in words.
    const fn place_names(&self) -> &'static str {
        match self {
            Self::Sensor(_) | Self::Heater(_) => "hotend, bed, chamber",
            Self::FanDead => "hotend, part",
            Self::Machine(_) => "machine",
        }
    }
}

impl Kind {
    /// An accident of this kind, at its default place.
    #[must_use]
    pub fn at(&'static self, at_s: f64) -> Accident {
        let place = self.does.places().first().map_or(Where::Machine, |(_, place)| *place);
        Accident { kind: self, place, at_s }
    }
}

/// A time such as `60s`, `2.5m`, `1h`, in s.
pub(crate) fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = [("s", 1.0), ("m", 60.0), ("h", 3600.0)]
        .into_iter()
        .find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)))?;
    let number = number.parse::<f64>().ok()?;
    Some(number * unit).filter(|seconds| (0.0..=LATEST_S).contains(seconds))
}

impl FromStr for Accident {
    type Err = AccidentError;

    fn from_str(text: &str) -> Result<Self, AccidentError> {
        let (what, time) = text.rsplit_once('@').ok_or(AccidentError::Form)?;
        let (name, place) = what.split_once(':').map_or((what, None), |(name, place)| (name, Some(place)));
        let kind = KINDS.iter().find(|kind| kind.name == name);
        let kind = kind.ok_or_else(|| AccidentError::Kind(name.to_owned()))?;
        let at_s = seconds(time).ok_or_else(|| AccidentError::Time(time.to_owned()))?;
        let usual = kind.at(at_s);
        let Some(place) = place else { return Ok(usual) };
        let found = kind.does.places().iter().find(|(name, _)| *name == place);
        let wrong = || AccidentError::Where(kind.name, kind.does.place_names(), place.to_owned());
        found.map(|(_, place)| Self { place: *place, ..usual }).ok_or_else(wrong)
    }
}

impl Accident {
    /// It happens.
    pub fn happen(&self, faults: &mut PlantFaults) {
        match (self.kind.does, self.place) {
            (Does::Sensor(fault), Where::Heater(heater)) => *faults.sensor_of(heater) = fault,
            (Does::Heater(fault), Where::Heater(heater)) => *faults.heater_of(heater) = fault,
            (Does::FanDead, Where::PartFan) => faults.part_fan_broken = true,
            (Does::FanDead, _) => faults.hotend_fan_broken = true,
            (Does::Machine(happens), _) => happens(faults),
            (Does::Sensor(_) | Does::Heater(_), _) => {}
        }
    }

    /// A part that the machine lacks, so that this cannot happen.
    #[must_use]
    pub fn missing(&self, thermal: &ThermalSettings) -> Option<String> {
        let needed = match self.place {
            Where::Heater(heater) => heater,
            Where::PartFan | Where::HotendFan => Heater::Hotend,
            Where::Machine => return (!thermal.has_heater()).then(|| "the machine has no heater".to_owned()),
        };
        let name = needed.name();
        let is_fitted = thermal.heater(needed).is_fitted;
        (!is_fitted).then(|| format!("the machine has no {name}; its file fits one (heaters.{name}.is_fitted = true)"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(&'static str, Where, f64), String> {
        let accident: Accident = text.parse().map_err(|error: AccidentError| error.to_string())?;
        Ok((accident.kind.name, accident.place, accident.at_s))
    }

    #[test]
    fn accidents_are_read_or_named() {
        assert_eq!(read("open@60s"), Ok(("open", Where::Heater(Heater::Hotend), 60.0)));
        assert_eq!(read("stuck-on:bed@10m"), Ok(("stuck-on", Where::Heater(Heater::Bed), 600.0)));
        assert_eq!(read("no-heat:chamber@1.5h"), Ok(("no-heat", Where::Heater(Heater::Chamber), 5400.0)));
        assert_eq!(read("fan-dead:part@0s"), Ok(("fan-dead", Where::PartFan, 0.0)));
        assert_eq!(read("converter@2m"), Ok(("converter", Where::Machine, 120.0)));
        let wrong = |text: &str| read(text).unwrap_err();
        assert_eq!(wrong("open"), "expected WHAT[:WHERE]@TIME, such as open:hotend@60s");
        assert!(
            wrong("opne@60s").starts_with("`opne` is not an accident; expected open, short, frozen, loose, slipped, ")
        );
        assert_eq!(wrong("open:part@60s"), "`part` is not a place for open: hotend, bed, chamber");
        assert_eq!(wrong("fan-dead:bed@60s"), "`bed` is not a place for fan-dead: hotend, part");
        for time in ["60", "-1s", "nans", "infh", "s", "9000h"] {
            let told = format!("`{time}` is not a time after power-up: 60s, 2.5m, 1h; a year at most");
            assert_eq!(wrong(&format!("open@{time}")), told);
        }
    }

    /// Two kinds with one name, or one that does nothing, would be found here.
    #[test]
    fn every_kind_has_a_name_of_its_own_and_changes_the_plant() {
        let healthy = PlantFaults::none(&corehbot_rig::plant::PlantConstants::prototype());
        for kind in &KINDS {
            assert_eq!(KINDS.iter().filter(|other| other.name == kind.name).count(), 1, "{}", kind.name);
            for (name, place) in kind.does.places() {
                let mut faults = healthy.clone();
                Accident { kind, place: *place, at_s: 0.0 }.happen(&mut faults);
                assert_ne!(format!("{faults:?}"), format!("{healthy:?}"), "{}:{name}", kind.name);
                assert!(kind.does.place_names().split(", ").any(|known| known == *name), "{}:{name}", kind.name);
            }
        }
    }

    #[test]
    fn what_is_not_fitted_cannot_break() {
        let mut thermal = ThermalSettings::prototype();
        thermal.heaters.hotend.is_fitted = true;
        let missing = |text: &str, thermal: &ThermalSettings| text.parse::<Accident>().unwrap().missing(thermal);
        assert_eq!(missing("open@1s", &thermal), None);
        let told = "the machine has no bed; its file fits one (heaters.bed.is_fitted = true)";
        assert_eq!(missing("open:bed@1s", &thermal).as_deref(), Some(told));
        assert_eq!(
            missing("converter@1s", &ThermalSettings::prototype()).as_deref(),
            Some("the machine has no heater")
        );
    }
}
