//! The mechanism as data: how far each motor turns for a step of x, y, z and e.
//!
//! One row of -1, 0 and 1 a motor, over (x, y, z, e); how far a step goes is the axis's resolution. A machine of belts or screws is nothing but such rows: what
//! its motors must do is rows times position, and everything else follows from the rows ([`Groups`](super::Groups)).
//! A row of zeros is a motor that is not fitted.
//!
//! **A new mechanism changes nothing here**: it is a file in `examples/machines` (its `[mechanism]`). A board starts as the machine
//! that is stored, or else as that of its image. The tests of `boards/sim/tests/machines` home,
//! print and stop every file; `tests/mechanisms/machines.rs` and docs/kinematics.md have tables of them.

use super::forward::{ForwardKinematics, is_held};
use super::row::Row;
use crate::motors::{MOST_GROUPS, Motor, MotorSet};
use serde::{Deserialize, Serialize};

/// The row of a motor that is not fitted.
const NOT_FITTED: Row = [0; 4];

/// Names of the axes.
const AXES: [&str; 4] = ["x", "y", "z", "e"];

/// One row a motor, in the order of [`Motor::ALL`]. Stored as one number, two bits an entry.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
#[serde(from = "i64", into = "i64")]
pub struct Mechanism {
    /// The rows; [`check`](Self::check) says what is legal.
    pub rows: [Row; Motor::ALL.len()],
}

/// Bits of an entry: -2, which is no legal one, to 1.
const ENTRY: u32 = 2;

impl From<i64> for Mechanism {
    // Not inlined in every encoder and decoder.
    #[inline(never)]
    fn from(mut packed: i64) -> Self {
        let mut mechanism = Self { rows: [NOT_FITTED; Motor::ALL.len()] };
        for entry in mechanism.rows.as_flattened_mut() {
            *entry = (packed as i8) << (i8::BITS - ENTRY) >> (i8::BITS - ENTRY);
            packed >>= ENTRY;
        }
        mechanism
    }
}

impl From<Mechanism> for i64 {
    #[inline(never)]
    fn from(mechanism: Mechanism) -> Self {
        let entries = mechanism.rows.as_flattened().iter();
        entries.rfold(0, |packed, entry| packed << ENTRY | (Self::from(*entry) & 3))
    }
}

/// Why rows are no machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MechanismError {
    /// An entry of this motor is not -1, 0 or 1.
    Entry(Motor),
    /// This motor moves the tool and the filament.
    Mixed(Motor),
    /// No motor moves this axis.
    NotDriven(&'static str),
    /// The motors can stand still while the tool moves.
    Loose,
    /// More different coordinates than there are groups.
    TooManyGroups,
}

impl core::fmt::Display for MechanismError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Entry(motor) => write!(f, "mechanism.{}: entries are -1, 0 or 1", motor.name()),
            Self::Mixed(motor) => {
                write!(f, "mechanism.{}: a motor moves the tool or the filament, not both", motor.name())
            }
            Self::NotDriven(axis) => write!(f, "mechanism: no motor moves {axis}"),
            Self::Loose => f.write_str("mechanism: the motors do not hold x, y and z, two of them must differ more"),
            Self::TooManyGroups => {
                write!(f, "mechanism: at most {MOST_GROUPS} motors may differ, others must repeat or mirror them")
            }
        }
    }
}

impl core::error::Error for MechanismError {}

/// The same row backward.
pub(super) fn mirrored(row: Row) -> Row {
    row.map(i8::wrapping_neg)
}

impl Mechanism {
    /// The CoreH-bot: four motors on one belt, two ball screws, one extruder.
    #[must_use]
    pub const fn corehbot() -> Self {
        const Z: Row = [0, 0, 1, 0];
        Self { rows: [[-1, 1, 0, 0], [-1, -1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], Z, Z, [0, 0, 0, 1]] }
    }

    /// Every motor with its row.
    pub fn motors(&self) -> impl Iterator<Item = (Motor, Row)> {
        Motor::ALL.into_iter().zip(self.rows)
    }

    /// The motors whose row has what `wanted` asks for.
    fn motors_with(&self, wanted: impl Fn(Row) -> bool) -> MotorSet {
        self.motors()
            .fold(MotorSet::NONE, |set, (motor, row)| if wanted(row) { set.with(MotorSet::of(motor)) } else { set })
    }

    /// The motors that there are.
    #[must_use]
    pub fn fitted(&self) -> MotorSet {
        self.motors_with(|row| row != NOT_FITTED)
    }

    /// The motors that an axis needs to move, by its number.
    #[must_use]
    #[inline(never)]
    pub fn motors_of(&self, axis: usize) -> MotorSet {
        self.motors_with(|row| row.get(axis).is_some_and(|times| *times != 0))
    }

    /// The axis with the lowest number that a motor moves.
    #[must_use]
    pub fn axis_of(&self, motor: Motor) -> Option<usize> {
        self.rows.get(motor as usize).and_then(|row| row.iter().position(|times| *times != 0))
    }

    /// Whether two axes need a motor together.
    #[must_use]
    #[inline(never)]
    pub fn share(&self, a: usize, b: usize) -> bool {
        let Self { rows } = self;
        rows.iter().any(|row| [a, b].iter().all(|axis| row.get(*axis).is_some_and(|times| *times != 0)))
    }

    /// What each motor must have turned for x, y, z and e to be there.
    #[must_use]
    pub fn inverse(&self, position: [i64; 4]) -> [i64; Motor::ALL.len()] {
        self.rows.map(|row| row.into_iter().zip(position).map(|(times, steps)| i64::from(times) * steps).sum())
    }

    /// The way back from what the motors have turned; `None` if they do not hold the tool.
    #[must_use]
    pub fn forward_kinematics(&self) -> Option<ForwardKinematics<{ Motor::ALL.len() }>> {
        ForwardKinematics::new(self.rows)
    }

    /// Whether these are the rows of a machine.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn check(&self) -> Result<(), MechanismError> {
        for (motor, row) in self.motors() {
            if row.iter().any(|times| !(-1..=1).contains(times)) {
                return Err(MechanismError::Entry(motor));
            }
            let [x, y, z, e] = row;
            if e != 0 && [x, y, z] != [0; 3] {
                return Err(MechanismError::Mixed(motor));
            }
        }
        if let Some((_, axis)) = (0..).zip(AXES).find(|(axis, _)| self.motors_of(*axis).is_empty()) {
            return Err(MechanismError::NotDriven(axis));
        }
        let mut different: [Row; MOST_GROUPS] = [NOT_FITTED; MOST_GROUPS];
        for row in self.rows.into_iter().filter(|row| *row != NOT_FITTED) {
            let place = |slot: &&mut Row| [NOT_FITTED, row, mirrored(row)].contains(*slot);
            *different.iter_mut().find(place).ok_or(MechanismError::TooManyGroups)? = row;
        }
        if is_held(&different) { Ok(()) } else { Err(MechanismError::Loose) }
    }

    /// Whether steps taken in one instant strain nothing: motors that one coordinate drives step together, those whose
    /// rows are opposite in opposite directions.
    #[must_use]
    pub fn is_unstrained(&self, steps: MotorSet, forward: MotorSet) -> bool {
        let way = |motor: Motor| match (steps.has(motor), forward.has(motor)) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => -1,
        };
        self.motors().all(|(motor, row)| {
            self.motors().all(|(other, its_row)| {
                (row != its_row || way(motor) == way(other)) && (row != mirrored(its_row) || way(motor) == -way(other))
            })
        })
    }
}
