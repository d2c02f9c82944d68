//! The rule for speeds in corners, and the jump of z in them.

use super::field::Number;
use super::ranges;
use super::rows::rows;
use crate::units::{Mm, MmPerSec};
use serde::{Deserialize, Serialize};

/// The rule that limits the speed in a corner; a rule has one value so far. `motion::planner::junction` has the law. A
/// machine file chooses a rule by its key (`corner.…`, `machine-file/src/keys.rs`), a line by its letter in M205
/// (`machine/setup/rules.rs`). A new one comes last, as records hold its number.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum CornerRule {
    /// Junction deviation: the largest distance between the corner and an arc that rounds it.
    JunctionDeviation(Mm),
    /// Square-corner velocity: the speed through a corner of 90 degrees.
    SquareCorner(MmPerSec),
}

impl CornerRule {
    /// Every rule, with a usual value.
    pub fn all() -> impl Iterator<Item = Self> {
        let usual = Self::JunctionDeviation(const { Mm::lit("0.013") });
        core::iter::successors(Some(usual), |rule| rule.next())
    }

    /// The rule after this one. Without a wildcard: a new rule is linked in here, and tests go through all of them.
    const fn next(self) -> Option<Self> {
        match self {
            Self::JunctionDeviation(_) => Some(Self::SquareCorner(MmPerSec::const_from_int(5))),
            Self::SquareCorner(_) => None,
        }
    }
}

/// Junction deviation as a field.
#[derive(Debug)]
pub struct Deviation<'a>(pub &'a mut CornerRule);

impl Number for Deviation<'_> {
    fn value(&self) -> Option<i64> {
        if let CornerRule::JunctionDeviation(deviation) = &*self.0 { deviation.value() } else { None }
    }

    fn put(&mut self, number: i64) -> bool {
        let mut deviation = Mm::ZERO;
        let is_one = deviation.put(number);
        if is_one {
            *self.0 = CornerRule::JunctionDeviation(deviation);
        }
        is_one
    }
}

/// Square-corner velocity as a field.
#[derive(Debug)]
pub struct SquareCorner<'a>(pub &'a mut CornerRule);

impl Number for SquareCorner<'_> {
    fn value(&self) -> Option<i64> {
        if let CornerRule::SquareCorner(speed) = &*self.0 { speed.value() } else { None }
    }

    fn put(&mut self, number: i64) -> bool {
        let mut speed = MmPerSec::ZERO;
        let is_one = speed.put(number);
        if is_one {
            *self.0 = CornerRule::SquareCorner(speed);
        }
        is_one
    }
}

rows! {
    for machine in |s, _| Some(s), named &[""];

    /// The jump in the speed of z that a corner may ask for; 3000, the greatest speed of all, limits nothing.
    151 "z_jerk" = &mut machine.z_jerk, "mm/s", [ranges::SPEED.spec().from_zero()], "M205" "Z";
}
