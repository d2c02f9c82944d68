//! A heater: where it hangs, what watches it (and the kinds of sensor, [`Thermistor`]), how it behaves, and what is not normal
//! any more.

use crate::connectors::{Output, Sensor};
use crate::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use serde::{Deserialize, Serialize};

/// A kind of temperature sensor, by the name under which it is sold. `thermal::sensor` has its numbers.
///
/// A new one comes behind the others, since records hold its number; the compiler and tests then ask for its curve and its data
/// sheet (`thermal::sensor::curve`), its law in the simulated plant (`rig/src/heat.rs`) and its name in machine files
/// (`machine-file/src/form/heat.rs` and `heat.rs`). By hand: `examples/machines/prototype.toml`,
/// docs/explanation/heat.md.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum Thermistor {
    /// ATC Semitec 104GT-2: most hotends up to 300 C.
    Semitec104Gt2,
    /// ATC Semitec 104NT-4-R025H42G.
    Semitec104Nt4,
    /// 100 kOhm and B 3950: most beds.
    Generic3950,
    /// Slice Engineering's of 500 kOhm, for up to 450 C.
    Slice450,
    /// A platinum resistor of 1 kOhm at 0 C, as Slice Engineering's for 500 C.
    Pt1000,
    /// Any other NTC: its resistance at 25 C in Ohm, and its B in K.
    Beta {
        /// Resistance at 25 C, in Ohm.
        ohms: u32,
        /// B, in K.
        beta: u16,
    },
}

impl Thermistor {
    /// Every kind, of [`Self::Beta`] one that is usual.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::successors(Some(Self::Semitec104Gt2), |kind| kind.next())
    }

    /// The kind after this one. Without a wildcard: a new kind is linked in here, and tests go through all of them.
    const fn next(self) -> Option<Self> {
        match self {
            Self::Semitec104Gt2 => Some(Self::Semitec104Nt4),
            Self::Semitec104Nt4 => Some(Self::Generic3950),
            Self::Generic3950 => Some(Self::Slice450),
            Self::Slice450 => Some(Self::Pt1000),
            Self::Pt1000 => Some(Self::Beta { ohms: 100_000, beta: 3950 }),
            Self::Beta { .. } => None,
        }
    }
}

/// How a heater behaves: what M303 finds out and M306 sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct HeaterModel {
    /// Heat that it takes to warm it.
    pub capacity: JoulesPerKelvin,
    /// Heat that it loses to the room.
    pub loss: WattsPerKelvin,
    /// Heat that it loses in addition with the part fan at full speed.
    pub fan_loss: WattsPerKelvin,
    /// Time constant from the heating element to the thing heated.
    pub heater_lag: Seconds,
    /// Time constant from the thing heated to the sensor's reading.
    pub sensor_lag: Seconds,
}

impl HeaterModel {
    /// From the heating element to the sensor's reading.
    #[must_use]
    pub const fn lag(&self) -> Seconds {
        self.heater_lag.saturating_add(self.sensor_lag)
    }
}

/// A PID controller in Marlin's terms: its output is a duty of 0 to 255.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Pid {
    /// Duty a K.
    pub p: Ratio,
    /// Duty a K and second.
    pub i: Ratio,
    /// Duty for each K/s.
    pub d: Ratio,
}

/// How the power is found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum Control {
    /// From the model, which looks ahead.
    Model,
    /// By PID.
    Pid,
}

/// When a heater's behaviour is a fault. No value switches a guard off.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Guards {
    /// It has to warm up by at least this part of what its model says.
    pub heating: Ratio,
    /// So far from its target, once reached, ...
    pub lost: Celsius,
    /// ... for so long, in s.
    pub lost_s: u8,
    /// Rise while it is off.
    pub off_rise: Celsius,
    /// So far above its target without power.
    pub overshoot: Celsius,
}

/// A heater.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct HeaterSettings {
    /// Whether there is one.
    pub is_fitted: bool,
    /// Where it hangs.
    pub output: Output,
    /// What watches it.
    pub sensor: Sensor,
    /// The sensor's kind.
    pub thermistor: Thermistor,
    /// The highest target.
    pub most: Celsius,
    /// Power at full duty and nominal voltage.
    pub power: Watts,
    /// The highest duty.
    pub max_duty: Ratio,
    /// Period of its switching in ms, for relays; 0 is the fast pulse-width modulation of the board.
    pub period_ms: u16,
    /// How the power is found.
    pub control: Control,
    /// How it behaves.
    pub model: HeaterModel,
    /// For those who want PID.
    pub pid: Pid,
    /// What is not normal.
    pub guards: Guards,
}

impl HeaterSettings {
    /// A hotend with a block of aluminium and a cartridge of 40 W.
    #[must_use]
    pub const fn hotend(output: Output, sensor: Sensor) -> Self {
        Self {
            is_fitted: false,
            output,
            sensor,
            thermistor: Thermistor::Semitec104Gt2,
            most: Celsius::const_from_int(285),
            power: Watts::const_from_int(40),
            max_duty: Ratio::ONE,
            period_ms: 0,
            control: Control::Model,
            model: HeaterModel {
                capacity: const { JoulesPerKelvin::lit("10.8") },
                loss: const { WattsPerKelvin::lit("0.075") },
                fan_loss: const { WattsPerKelvin::lit("0.05") },
                heater_lag: const { Seconds::lit("1.2") },
                sensor_lag: const { Seconds::lit("1.2") },
            },
            pid: Pid {
                p: const { Ratio::lit("22.2") },
                i: const { Ratio::lit("1.08") },
                d: Ratio::const_from_int(114),
            },
            guards: Guards::hotend(),
        }
    }

    /// A plate of aluminium of 430 x 400 x 4 mm with a mat of 500 W.
    #[must_use]
    pub const fn bed(output: Output, sensor: Sensor) -> Self {
        Self {
            is_fitted: false,
            output,
            sensor,
            thermistor: Thermistor::Generic3950,
            most: Celsius::const_from_int(120),
            power: Watts::const_from_int(500),
            max_duty: Ratio::ONE,
            period_ms: 1000,
            control: Control::Model,
            model: HeaterModel {
                capacity: JoulesPerKelvin::const_from_int(1700),
                loss: const { WattsPerKelvin::lit("3.5") },
                fan_loss: WattsPerKelvin::ZERO,
                heater_lag: Seconds::const_from_int(10),
                sensor_lag: Seconds::const_from_int(5),
            },
            pid: Pid { p: Ratio::const_from_int(120), i: Ratio::const_from_int(1), d: Ratio::const_from_int(600) },
            guards: Guards::bed(),
        }
    }

    /// A chamber with a heater of 300 W that blows.
    #[must_use]
    pub const fn chamber(output: Output, sensor: Sensor) -> Self {
        Self {
            most: Celsius::const_from_int(70),
            power: Watts::const_from_int(300),
            model: HeaterModel {
                capacity: JoulesPerKelvin::const_from_int(6000),
                loss: WattsPerKelvin::const_from_int(5),
                fan_loss: WattsPerKelvin::ZERO,
                heater_lag: Seconds::const_from_int(20),
                sensor_lag: Seconds::const_from_int(20),
            },
            ..Self::bed(output, sensor)
        }
    }

    /// The highest legal reading: so far above the highest target that a heater which overshoots a little is no fault
    /// (Marlin's HOTEND_OVERSHOOT is 15 C).
    #[must_use]
    pub const fn too_hot(&self) -> Celsius {
        self.most.saturating_add(Celsius::const_from_int(15))
    }
}

impl Guards {
    /// For a hotend: lost by 10 C for 5 s, where RepRapFirmware has 15 C for 5 s.
    #[must_use]
    pub const fn hotend() -> Self {
        Self {
            // 18 V instead of 24 give 0.56 of the power, and a model may be off by 0.7.
            heating: const { Ratio::lit("0.35") },
            lost: Celsius::const_from_int(10),
            lost_s: 5,
            off_rise: Celsius::const_from_int(8),
            overshoot: Celsius::const_from_int(20),
        }
    }

    /// For a bed, which is slower and whose door is opened: lost by 10 C for 20 s as with Prusa.
    #[must_use]
    pub const fn bed() -> Self {
        Self {
            lost_s: 20,
            off_rise: Celsius::const_from_int(5),
            overshoot: Celsius::const_from_int(15),
            ..Self::hotend()
        }
    }
}
