//! Shaping of the trajectory so that the tool does not ring and the nozzle does not lag: input shapers, and pressure
//! advance ([`Advance`]: its time, and the window over which the speed is averaged).

use super::field::Number;
use super::ranges;
use super::rows::{Choice, Spec, numbers, rows};
use crate::units::{Hertz, Mm, Ratio, Seconds};
use serde::{Deserialize, Serialize};

/// Input shapers, by their usual names. The head of `settings` says where each is known. Records hold the number of a
/// variant, so a new one comes last.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum ShaperKind {
    /// None.
    None,
    /// Zero vibration.
    Zv,
    /// Zero vibration and derivative.
    Zvd,
    /// Modified zero vibration.
    Mzv,
    /// Extra insensitive, for 5 % of vibration.
    Ei,
    /// Extra insensitive with two humps, for 5 % of vibration.
    TwoHumpEi,
}

impl ShaperKind {
    /// Every kind.
    pub fn all() -> impl Iterator<Item = Self> {
        <Self as Choice>::ALL.iter().map(|(kind, _)| *kind)
    }
}

/// The input shaper of an axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Shaper {
    /// Which.
    pub kind: ShaperKind,
    /// The frequency at which the axis rings.
    pub frequency: Hertz,
    /// The axis' damping as a part of the critical one.
    pub damping: Ratio,
    /// Length of the belts that pull along the axis, both sides together. The frequency is then the one in the middle
    /// of the axis, and rises away from it. 0 if it is the same everywhere.
    pub span: Mm,
    /// The part of the frequency that comes from compliant motors. It is the frequency at which the axis would ring if
    /// its belts were stiff and pulled evenly, best fitted (docs/explanation/shaping.md). It is 0 if only its belts are
    /// soft.
    pub motor_frequency: Hertz,
}

/// The input shapers of the bed plane.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Shapers {
    /// Along x.
    pub x: Shaper,
    /// Along y.
    pub y: Shaper,
}

/// Pressure advance: the filament in the nozzle is pushed ahead by its speed times this.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Advance {
    /// K of M900.
    pub time: Seconds,
    /// The speed is averaged over so long, half of it ahead; `None` is as long as suits the shapers (`advance_window`
    /// in `motion::trajectory`).
    pub window: Option<Seconds>,
}

impl Shaper {
    /// A shaper for an axis that rings alike everywhere.
    #[must_use]
    pub const fn new(kind: ShaperKind, frequency: Hertz, damping: Ratio) -> Self {
        Self { kind, frequency, damping, span: Mm::ZERO, motor_frequency: Hertz::ZERO }
    }
}

impl Shapers {
    /// The shaper of an axis, by its number.
    const fn get_mut(&mut self, axis: usize) -> Option<&mut Shaper> {
        match axis {
            0 => Some(&mut self.x),
            1 => Some(&mut self.y),
            _ => None,
        }
    }

    /// Off. The frequencies are 1.06 times those of the paper's machine at the centre of its bed
    /// (docs/explanation/kinematics.md): so a fixed shaper is best over the whole bed.
    #[must_use]
    pub const fn prototype() -> Self {
        let damping = const { Ratio::lit("0.1") };
        let kind = ShaperKind::None;
        Self {
            x: Shaper::new(kind, const { Hertz::lit("107.5") }, damping),
            y: Shaper::new(kind, const { Hertz::lit("61.1") }, damping),
        }
    }
}

impl Advance {
    /// Off; a window that suits the shapers.
    #[must_use]
    pub const fn prototype() -> Self {
        Self { time: Seconds::ZERO, window: None }
    }
}

impl Choice for ShaperKind {
    const ALL: &'static [(Self, &'static str)] = &[
        (Self::None, "none"),
        (Self::Zv, "zv"),
        (Self::Zvd, "zvd"),
        (Self::Mzv, "mzv"),
        (Self::Ei, "ei"),
        (Self::TwoHumpEi, "2hump_ei"),
    ];

    numbers!(None Zv Zvd Mzv Ei TwoHumpEi);
}

rows! {
    for shaper in |s, part| s.shapers.get_mut(part), named &["shaper.x", "shaper.y"];

    /// Kind of the input shaper (M593).
    58 "kind" = &mut shaper.kind, "", [Spec::choice::<ShaperKind>()];
    /// Frequency at which the axis rings; of an axis with a span, in its middle.
    59 "frequency" = &mut shaper.frequency, "Hz", [ranges::FREQUENCY.spec()];
    /// Damping of the axis as a ratio to critical damping.
    60 "damping" = &mut shaper.damping, "", [ranges::DAMPING.spec()];
    /// Length of the belts that pull along the axis, both sides together, if the axis rings faster away from its
    /// middle; 0 if it rings alike everywhere.
    61 "span" = &mut shaper.span, "mm", [ranges::BELT_SPAN.spec().or_zero()];
    /// Frequency at which the axis would ring if its belts were stiff and only its motors gave way; 0 is stiff motors.
    62 "motor_frequency" = &mut shaper.motor_frequency, "Hz", [ranges::MOTOR_FREQUENCY.spec()];
}

/// The window of pressure advance: 0 is `None`.
impl Number for Option<Seconds> {
    fn value(&self) -> Option<i64> {
        self.unwrap_or(Seconds::ZERO).value()
    }

    fn put(&mut self, number: i64) -> bool {
        let mut seconds = Seconds::ZERO;
        let is_one = seconds.put(number);
        if is_one {
            *self = (seconds != Seconds::ZERO).then_some(seconds);
        }
        is_one
    }
}

/// Rows of [`Advance`].
pub(super) mod advance {
    use super::*;

    rows! {
        for advance in |s, _| Some(&mut s.advance), named &["advance"];

        /// Pressure advance (M900 K, M572 S); 0 is none.
        63 "time" = &mut advance.time, "s", [ranges::ADVANCE.spec()];
        /// Time over which the extruder's speed is averaged (M572 W), or "auto": as long as suits the shapers.
        64 "window" = &mut advance.window, "s", [ranges::ADVANCE_WINDOW.spec().or_auto()];
    }
}
