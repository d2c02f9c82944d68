//! Shaping of the trajectory so that the tool does not ring and the nozzle does not lag: input shapers, and pressure
//! advance ([`Advance`]: its time, and the window over which the speed is averaged).

use super::rows::{Choice, Chosen, Field, Spec, Value, rows};
use super::{Settings, ranges};
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
}

fn parts(s: &mut Settings) -> [&mut Shaper; 2] {
    [&mut s.shapers.x, &mut s.shapers.y]
}

rows! {
    for shaper in parts, named &["shaper.x", "shaper.y"];

    /// Kind of the input shaper (M593).
    58 "kind" = Chosen(&mut shaper.kind), "", [Spec::choice::<ShaperKind>()];
    /// Frequency at which the axis rings; of an axis with a span, in its middle.
    59 "frequency" = shaper.frequency, "Hz", [ranges::FREQUENCY.spec()];
    /// Damping of the axis as a ratio to critical damping.
    60 "damping" = shaper.damping, "", [ranges::DAMPING.spec()];
    /// Length of the belts that pull along the axis, both sides together, if the axis rings faster away from its
    /// middle; 0 if it rings alike everywhere.
    61 "span" = shaper.span, "mm", [ranges::BELT_SPAN.spec().or_zero()];
    /// Frequency at which the axis would ring if its belts were stiff and only its motors gave way; 0 is stiff motors.
    62 "motor_frequency" = shaper.motor_frequency, "Hz", [ranges::MOTOR_FREQUENCY.spec()];
}

/// The window of pressure advance as a field: 0 is `None`.
struct Window<'a>(&'a mut Option<Seconds>);

impl Field for Window<'_> {
    fn get(&self) -> Value {
        self.0.unwrap_or(Seconds::ZERO).get()
    }

    fn set(&mut self, value: &Value) -> bool {
        let mut seconds = Seconds::ZERO;
        let is_one = seconds.set(value);
        if is_one {
            *self.0 = (seconds != Seconds::ZERO).then_some(seconds);
        }
        is_one
    }
}

/// Rows of [`Advance`].
pub(super) mod advance {
    use super::*;

    fn parts(s: &mut Settings) -> [&mut Advance; 1] {
        [&mut s.advance]
    }

    rows! {
        for advance in parts, named &["advance"];

        /// Pressure advance (M900 K, M572 S); 0 is none.
        63 "time" = advance.time, "s", [ranges::ADVANCE.spec()];
        /// Time over which the extruder's speed is averaged (M572 W), or "auto": as long as suits the shapers.
        64 "window" = Window(&mut advance.window), "s", [ranges::ADVANCE_WINDOW.spec().or_auto()];
    }
}
