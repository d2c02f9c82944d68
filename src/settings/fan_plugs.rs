//! Fans as a board drives them: the frequency of their modulation, and the inputs of their tachometers. A board takes
//! them when it starts, as the places of all plugs. What a fan does is in [`FanSettings`](super::FanSettings).

use super::Range;
use super::rows::{Choice, Spec, numbers, rows};
use crate::connectors::ConnectorName;
use serde::{Deserialize, Serialize};

/// How a fan is connected.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct FanPlug {
    /// The frequency of its modulation in Hz; 0 is the board's own.
    pub frequency: u16,
    /// Its tachometer, if it has one.
    pub tachometer: Tachometer,
}

/// The input of a tachometer, by its place in a list: a record has no room for six names.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum Tachometer {
    /// No tachometer.
    None,
    /// At X-STOP.
    XStop,
    /// At Y-STOP.
    YStop,
    /// At Z-STOP.
    ZStop,
    /// At Z2-STOP.
    Z2Stop,
    /// At E0DET.
    E0Det,
    /// At E1DET.
    E1Det,
    /// At E2DET.
    E2Det,
    /// At E3DET.
    E3Det,
    /// At BLTOUCH.
    BlTouch,
    /// At PROBE.
    Probe,
    /// At X-MIN.
    XMin,
    /// At Y-MIN.
    YMin,
    /// At Z-MIN.
    ZMin,
    /// At X-MAX.
    XMax,
    /// At Y-MAX.
    YMax,
    /// At Z-MAX.
    ZMax,
}

impl Choice for Tachometer {
    /// None, and the inputs of all boards with fans. Records have their places, so those of another board come last.
    const ALL: &'static [(Self, &'static str)] = &[
        (Self::None, "none"),
        (Self::XStop, "X-STOP"),
        (Self::YStop, "Y-STOP"),
        (Self::ZStop, "Z-STOP"),
        (Self::Z2Stop, "Z2-STOP"),
        (Self::E0Det, "E0DET"),
        (Self::E1Det, "E1DET"),
        (Self::E2Det, "E2DET"),
        (Self::E3Det, "E3DET"),
        (Self::BlTouch, "BLTOUCH"),
        (Self::Probe, "PROBE"),
        (Self::XMin, "X-MIN"),
        (Self::YMin, "Y-MIN"),
        (Self::ZMin, "Z-MIN"),
        (Self::XMax, "X-MAX"),
        (Self::YMax, "Y-MAX"),
        (Self::ZMax, "Z-MAX"),
    ];

    numbers!(
        None XStop YStop ZStop Z2Stop E0Det E1Det E2Det E3Det BlTouch Probe XMin YMin ZMin XMax YMax ZMax
    );
}

impl Tachometer {
    /// A tachometer at that input of a board; `None` if the list does not have it.
    #[must_use]
    pub fn at(input: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == input).map(|(tachometer, _)| *tachometer)
    }

    /// The name of its input; the empty name if there is none.
    #[must_use]
    pub fn input(self) -> ConnectorName {
        let known = Self::ALL.iter().find(|(other, _)| *other == self && self != Self::None);
        known.and_then(|(_, name)| ConnectorName::new(name)).unwrap_or(ConnectorName::NONE)
    }
}

impl FanPlug {
    /// A fan of two wires.
    pub const PLAIN: Self = Self { frequency: 0, tachometer: Tachometer::None };
}

/// The slowest is 10 Hz, at which a fan of two wires starts and stops. Fans of four wires take 21 to 28 kHz (Intel,
/// "4-Wire Pulse Width Modulation Controlled Fans", rev 1.3, section 3.2), and some machines have 50 kHz.
const FREQUENCY: Range<u16> = Range { least: 10, most: 50_000 };

/// Pulses of any tachometer in a turn: two for nearly all fans (the same, section 3.1).
pub(super) const USUAL_PULSES: u8 = 2;
const PULSES: Range<u8> = Range { least: 1, most: 12 };

rows! {
    for fan in |s, part| s.fans.get_mut(part),
        named &["fans.fan0", "fans.fan1", "fans.fan2", "fans.fan3", "fans.fan4", "fans.fan5"];

    /// Frequency of the modulation, where the board can change it; 0 is the board's own. Fans on one timer share it.
    127 "frequency" = &mut fan.frequency, "Hz", [FREQUENCY.spec().or_zero()];
    /// Input of the fan's tachometer. M123 reports it. A hotend fan that stands still is a fault.
    128 "tachometer" = &mut fan.tachometer, "", [Spec::choice::<Tachometer>()];
}

/// The row of all tachometers.
pub(super) mod pulses {
    use super::*;

    rows! {
        for pulses in |s, _| Some(&mut s.fan_pulses), named &["fans"];

        /// Pulses of a tachometer in a turn.
        129 "pulses" = pulses, "", [PULSES.spec()];
    }
}
