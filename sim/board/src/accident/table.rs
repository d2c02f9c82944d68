//! Table: every accident that there is. A new one is a row here, and its effect.

use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use corehbot_rig::bed::cut_wire;
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::plant::{HeaterFault, PlantFaults, SensorFault};

/// A part of the machine with a clock of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Heaters, their sensors and fans.
    Heat,
    /// The power supply.
    Supply,
    /// Belts, their pulleys and motors.
    Belts,
    /// The probe.
    Probe,
}

impl Family {
    /// Every family, in the order of the table.
    pub const ALL: [Self; 4] = [Self::Heat, Self::Supply, Self::Belts, Self::Probe];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Heat => "heat",
            Self::Supply => "supply",
            Self::Belts => "belts",
            Self::Probe => "probe",
        }
    }

    /// Whether only belts that stretch have such accidents.
    #[must_use]
    pub const fn needs_belts(self) -> bool {
        matches!(self, Self::Belts)
    }

    /// What TIME is. Motion time is that of the step trace.
    #[must_use]
    pub const fn clock(self) -> &'static str {
        match self {
            Self::Heat | Self::Supply | Self::Probe => "time after power-up",
            Self::Belts => "motion time",
        }
    }
}

/// Where something breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A heater or its sensor.
    Heater(Heater),
    /// The second sensor of a heater.
    SecondSensor,
    /// The part fan.
    PartFan,
    /// The hotend's fan.
    HotendFan,
    /// The machine as a whole.
    Machine,
    /// The probe.
    Probe,
    /// A part of the belts, which the machine's description names.
    PartOfBelts,
}

/// The places that an accident may have.
#[derive(Clone, Copy, Debug)]
pub enum Places {
    /// These names; the first is the usual one.
    Named(&'static [(&'static str, Place)]),
    /// Motors with a belt.
    Motors,
    /// The same, and pulleys.
    Pulleys,
}

/// The effect of an accident.
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
    /// To the probe of a machine.
    Probe(fn(&Settings) -> ProbeFault),
    /// To a part of the belts.
    Belts(Wear),
}

/// The effect on a part of the belts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wear {
    /// A pulley does not turn.
    Seize,
    /// A motor's pulley slips on its shaft.
    Loosen,
    /// A belt jumps over teeth of a motor's pulley.
    Jump,
    /// Cords of a motor's belt break.
    Weaken,
    /// A motor rubs.
    Rub,
}

/// How much of it.
#[derive(Clone, Copy, Debug)]
pub struct How {
    /// Its unit, which may be left out.
    pub unit: &'static str,
    /// What it is, with its bounds.
    pub says: &'static str,
    /// The bounds.
    pub bounds: [f64; 2],
    /// The number without one, if the plant does not compute it.
    pub usual: Option<f64>,
    /// Whether it is a whole number other than 0.
    pub is_count: bool,
}

/// An accident.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// WHAT.
    pub word: &'static str,
    /// Its family.
    pub family: Family,
    /// WHERE.
    pub places: Places,
    /// HOW, if it has one.
    pub how: Option<How>,
    /// Whether it may have a second TIME, after which the part is whole again.
    pub can_end: bool,
    /// Its effect.
    pub does: Does,
    /// Its meaning for people.
    pub says: &'static str,
}

const HEATERS: Places = Places::Named(&[
    ("hotend", Place::Heater(Heater::Hotend)),
    ("bed", Place::Heater(Heater::Bed)),
    ("chamber", Place::Heater(Heater::Chamber)),
]);

const SENSORS: Places = Places::Named(&[
    ("hotend", Place::Heater(Heater::Hotend)),
    ("bed", Place::Heater(Heater::Bed)),
    ("chamber", Place::Heater(Heater::Chamber)),
    ("second", Place::SecondSensor),
]);

const HOTEND: Places = Places::Named(&[("hotend", Place::Heater(Heater::Hotend))]);

const FANS: Places = Places::Named(&[("hotend", Place::HotendFan), ("part", Place::PartFan)]);

const MACHINE: Places = Places::Named(&[("machine", Place::Machine)]);

const PROBE: Places = Places::Named(&[("probe", Place::Probe)]);

/// Bounds of a friction, in N. A hundred times the holding force of a motor.
const FORCES: [f64; 2] = [0.0, 10_000.0];

const FORCE: How = How { unit: "N", says: "a force of 0 to 10,000 N", bounds: FORCES, usual: None, is_count: false };

const fn heat(word: &'static str, places: Places, does: Does, says: &'static str) -> Row {
    Row { word, family: Family::Heat, places, how: None, can_end: false, does, says }
}

const fn sensor(word: &'static str, fault: SensorFault, says: &'static str) -> Row {
    heat(word, HEATERS, Does::Sensor(fault), says)
}

const fn heater(word: &'static str, fault: HeaterFault, says: &'static str) -> Row {
    heat(word, HEATERS, Does::Heater(fault), says)
}

const fn machine(word: &'static str, does: fn(&mut PlantFaults), says: &'static str) -> Row {
    heat(word, MACHINE, Does::Machine(does), says)
}

const fn probe(word: &'static str, does: fn(&Settings) -> ProbeFault, says: &'static str) -> Row {
    Row { word, family: Family::Probe, places: PROBE, how: None, can_end: false, does: Does::Probe(does), says }
}

const fn belts(word: &'static str, places: Places, how: How, can_end: bool, wear: Wear, says: &'static str) -> Row {
    Row { word, family: Family::Belts, places, how: Some(how), can_end, does: Does::Belts(wear), says }
}

/// Every accident. Without a HOW, forces, cords and teeth are assumed: 10 N at a screw, half of the cords, one tooth,
/// and friction of 15 N, a quarter of what a motor holds.
pub const ROWS: [Row; 30] = [
    heat("open", SENSORS, Does::Sensor(SensorFault::Open), "a wire of the sensor is off"),
    heat("short", SENSORS, Does::Sensor(SensorFault::ShortToGround), "the sensor is shorted to ground"),
    sensor("frozen", SensorFault::Frozen, "the reading does not change any more"),
    sensor(
        "loose",
        SensorFault::Intermittent { period_seconds: 2.0, open_seconds: 0.3 },
        "the sensor's contact opens for 0.3 s in every 2 s",
    ),
    sensor(
        "slipped",
        SensorFault::Slipped { lag_seconds: 10.0 },
        "the sensor is out of its hole and reads the room, 10 s late",
    ),
    heat(
        "leaves",
        HOTEND,
        Does::Sensor(SensorFault::Leaves { share: 0.0, seconds: 60.0 }),
        "the sensor leaves its hole within a minute",
    ),
    sensor("late", SensorFault::ExtraLag { lag_seconds: 20.0 }, "the sensor sits loosely: 20 s later"),
    heater("no-heat", HeaterFault::OPEN, "the heater is open"),
    heater("weak", HeaterFault { power: 0.25, ..HeaterFault::NONE }, "the heater has a quarter of its power"),
    heater("stuck-on", HeaterFault::STUCK_ON, "the heater's switch does not switch off"),
    heater("leaky", HeaterFault::LEAKY, "the heater's switch leaks three tenths of its power"),
    heat("fan-dead", FANS, Does::FanDead, "the fan stands still"),
    machine("converter", |faults| faults.converter_stopped = true, "no more readings come"),
    machine("channels", |faults| faults.channels_slipped = true, "readings are off by one place"),
    machine("swapped-sensors", |faults| faults.swapped_sensors = true, "hotend's and bed's sensors are swapped"),
    machine("swapped-heaters", |faults| faults.swapped_heaters = true, "hotend's and bed's heaters are swapped"),
    Row {
        family: Family::Supply,
        ..machine("low-supply", |faults| faults.supply_volts = 12.0, "the heaters' supply gives 12 V")
    },
    belts(
        "seized",
        Places::Pulleys,
        FORCE,
        true,
        Wear::Seize,
        "the pulley does not turn: a motor's stalls its motor, over any other the belt slides",
    ),
    belts(
        "loose",
        Places::Motors,
        How {
            says: "a force of 0 to 10,000 N; a sign before it is one direction",
            bounds: [-FORCES[1], FORCES[1]],
            usual: Some(10.0),
            ..FORCE
        },
        true,
        Wear::Loosen,
        "the motor's pulley slips on its shaft when the belt pulls more than HOW: both ways, +HOW only as the motor \
         drives forward, -HOW only backward",
    ),
    belts(
        "jump",
        Places::Motors,
        How { unit: "", says: "a number of teeth, -50 to 50", bounds: [-50.0, 50.0], usual: Some(1.0), is_count: true },
        false,
        Wear::Jump,
        "the belt jumps HOW teeth of 2 mm over the motor's pulley: it is so far ahead then",
    ),
    belts(
        "cord",
        Places::Motors,
        How { unit: "%", says: "1 to 100 %", bounds: [1.0, 100.0], usual: Some(50.0), is_count: false },
        false,
        Wear::Weaken,
        "cords of the motor's belt break: HOW of its stiffness and tension is left",
    ),
    belts(
        "rub",
        Places::Motors,
        How { usual: Some(15.0), ..FORCE },
        true,
        Wear::Rub,
        "friction of HOW at the belt, on the motors of this name",
    ),
    probe("stuck", |_| ProbeFault::Stuck, "it always reads as triggered"),
    probe("dead", |_| ProbeFault::Dead, "it never reads as triggered"),
    probe("early", |_| ProbeFault::Early, "it triggers 3.5 mm too high"),
    probe("noisy", |_| ProbeFault::Noisy, "it triggers at heights that differ by 0.2 mm (sigma)"),
    probe("alarm", |_| ProbeFault::Alarm, "a BLTouch is in alarm until it is reset"),
    probe("cut", cut_wire, "its wire is off: what an open input reads, by the machine's file"),
    probe("fallen", cut_wire, "it falls off its holder, with its contacts open"),
    probe("mended", |_| ProbeFault::None, "whatever was broken is whole again"),
];

impl Row {
    /// The rows of a family.
    pub fn of(family: Family) -> impl Iterator<Item = &'static Self> {
        ROWS.iter().filter(move |row| row.family == family)
    }

    /// The names of its places, if it has a list of them.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        let named: &[_] = if let Places::Named(named) = self.places { named } else { &[] };
        named.iter().map(|(name, _)| *name)
    }

    /// The place of a name; any name may be that of a part of belts.
    pub(super) fn place_of(&self, name: &str) -> Option<Place> {
        match self.places {
            Places::Named(named) => named.iter().find(|(known, _)| *known == name).map(|(_, place)| *place),
            Places::Motors | Places::Pulleys => (!name.is_empty()).then_some(Place::PartOfBelts),
        }
    }
}

impl Places {
    /// What WHERE may be.
    #[must_use]
    pub fn says(self) -> String {
        match self {
            Self::Named(named) => named.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
            Self::Motors => "a belt motor".to_owned(),
            Self::Pulleys => "a belt motor or a pulley".to_owned(),
        }
    }
}
