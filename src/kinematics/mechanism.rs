//! The mechanism as data: how far each motor turns for a step of x, y, z and e.
//!
//! Each motor has a row over (x, y, z, e), mostly of -1, 0 or 1. The axis's resolution says how far a step goes. A
//! machine of belts or screws is fully described by these rows: motor steps are rows times position, and everything
//! else follows from the rows ([`Groups`](super::Groups)). A row of zeros is a motor that is not fitted.
//!
//! Motors that share axes may have pulleys of different sizes: equation 8 of the paper divides each row by the motor's
//! own radius. The common denominator of these fractions lengthens the step of the axis, which leaves whole numbers.
//! Pulleys of 20 and 16 teeth have `[4, 4, 0]` and `[5, -5, 0]` at a quarter of the usual steps/mm. So only the count
//! is rounded.
//!
//! **A new mechanism changes nothing here**: it is a file in `examples/machines` (its `[mechanism]`). A board starts as
//! the stored machine, or else as the machine of its image. The tests of `sim/board/tests/machines` home, print and
//! stop every file; `tests/mechanisms/machines.rs` and docs/explanation/kinematics.md have tables of them.

use super::forward::{ForwardKinematics, is_held};
use super::row::{MOST_MULTIPLE, Row, multiple, row_number};
use crate::motors::{MOST_GROUPS, MOTORS, Motor, MotorSet, per_motor};
use serde::{Deserialize, Serialize};

/// The row of a motor that is not fitted.
const NOT_FITTED: Row = [0; 4];

/// Names of the axes.
const AXES: [&str; 4] = ["x", "y", "z", "e"];

/// One row per motor, in the order of [`Motor::ALL`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Mechanism {
    /// The rows; [`check`](Self::check) verifies them.
    pub rows: [Row; MOTORS],
}

/// Why rows are not a valid machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MechanismError {
    /// The entries of this motor are not -1, 0 or 1 times a whole number up to [`MOST_MULTIPLE`].
    Entry(Motor),
    /// Whole numbers above 1 for a motor of a single axis, where the resolution expresses them, or where more motors
    /// differ than there are axes.
    Multiples,
    /// This motor moves the tool and the filament.
    Mixed(Motor),
    /// No motor moves this axis.
    NotDriven(&'static str),
    /// The motors can stand still while the tool moves.
    Loose,
    /// More different coordinates than there are groups.
    TooManyGroups,
}

impl MechanismError {
    /// The motor with a wrong row, if it is the row of one.
    #[must_use]
    pub const fn motor(self) -> Option<Motor> {
        match self {
            Self::Entry(motor) | Self::Mixed(motor) => Some(motor),
            Self::Multiples | Self::NotDriven(_) | Self::Loose | Self::TooManyGroups => None,
        }
    }
}

impl core::fmt::Display for MechanismError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Entry(_) => {
                put!(f, "entries are -1, 0 or 1, all times one whole number up to {MOST_MULTIPLE}")
            }
            Self::Multiples => {
                put!(f, "numbers above 1 are for motors that share axes, and not for more different motors than axes")
            }
            Self::Mixed(_) => put!(f, "a motor moves the tool or the filament, not both"),
            Self::NotDriven(axis) => put!(f, "no motor moves {axis}"),
            Self::Loose => put!(f, "the motors do not hold x, y and z, two of them must differ more"),
            Self::TooManyGroups => {
                put!(f, "at most {MOST_GROUPS} motors may differ, others must repeat or mirror them")
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
        Self::of(&[[-1, 1, 0, 0], [-1, -1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], Z, Z, [0, 0, 0, 1]])
    }

    /// The first motors with these rows; the others are not fitted.
    #[must_use]
    pub const fn of(listed: &[Row]) -> Self {
        Self { rows: per_motor(listed, NOT_FITTED) }
    }

    /// Every motor with its row.
    pub fn motors(&self) -> impl Iterator<Item = (Motor, Row)> {
        Motor::ALL.into_iter().zip(self.rows)
    }

    /// The motors that move one of these axes.
    #[inline(never)]
    fn motors_with(&self, axes: &[usize]) -> MotorSet {
        let mut motors = MotorSet::NONE;
        for (motor, row) in Motor::ALL.into_iter().zip(&self.rows) {
            if axes.iter().any(|axis| row.get(*axis).is_some_and(|times| *times != 0)) {
                motors = motors.with(MotorSet::of(motor));
            }
        }
        motors
    }

    /// The fitted motors.
    #[must_use]
    pub fn fitted(&self) -> MotorSet {
        self.motors_with(&[0, 1, 2, 3])
    }

    /// The motors that an axis needs to move, by its number.
    #[must_use]
    pub fn motors_of(&self, axis: usize) -> MotorSet {
        self.motors_with(&[axis])
    }

    /// The first motor of the filament.
    #[must_use]
    pub fn extruder(&self) -> Option<Motor> {
        self.motors_of(3).iter().next()
    }

    /// The motors that move x or y. They have belts.
    #[must_use]
    pub fn belt_motors(&self) -> MotorSet {
        self.motors_with(&[0, 1])
    }

    /// Whether all belt motors can turn alike with the tool at rest, so that a closed belt over all of them circulates.
    #[must_use]
    pub fn can_circulate(&self) -> bool {
        let belt = self.belt_motors();
        let rows = || self.motors().filter(|(motor, _)| belt.has(*motor)).map(|(_, row)| row);
        let sums_to_zero =
            |axis: usize| rows().filter_map(|row| row.get(axis).copied()).map(i32::from).sum::<i32>() == 0;
        !self.has_multiples() && [0, 1, 2].into_iter().all(sums_to_zero) && self.circulating().check().is_ok()
    }

    /// The same belt motors, moving the belt's circulation instead of z. On a CoreH-bot the rows are those of a CoreXYZ
    /// with circulation as its lift. Only the filament moves besides.
    #[must_use]
    pub fn circulating(&self) -> Self {
        let belt = self.belt_motors();
        let mut mechanism = *self;
        for (motor, row) in Motor::ALL.into_iter().zip(&mut mechanism.rows) {
            let [x, y, _, e] = *row;
            *row = [x, y, i8::from(belt.has(motor)), e];
        }
        mechanism
    }

    /// One motor alone in the place of z. The coupling says which one
    /// ([`Groups::trim_coupling`](super::Groups::trim_coupling)). X and y have a row each, because a position needs
    /// them, and do not move.
    #[must_use]
    pub const fn trimming() -> Self {
        const NONE: Row = NOT_FITTED;
        Self::of(&[[0, 0, 1, 0], NONE, NONE, NONE, [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    }

    /// The axis with the lowest number that a motor moves.
    #[must_use]
    pub fn axis_of(&self, motor: Motor) -> Option<usize> {
        self.rows.get(motor.index()).and_then(|row| row.iter().position(|times| *times != 0))
    }

    /// Whether two axes need a motor together.
    #[must_use]
    #[inline(never)]
    pub fn share(&self, a: usize, b: usize) -> bool {
        let Self { rows } = self;
        rows.iter().any(|row| [a, b].iter().all(|axis| row.get(*axis).is_some_and(|times| *times != 0)))
    }

    /// Whether motors that share axes have pulleys of different sizes.
    #[must_use]
    pub fn has_multiples(&self) -> bool {
        self.rows.iter().any(|row| multiple(*row) > 1)
    }

    /// The most steps that any motor makes for one step of an axis.
    #[must_use]
    pub fn most_times(&self, axis: usize) -> i8 {
        let times = self.rows.iter().filter_map(|row| row.get(axis)).map(|times| times.saturating_abs());
        times.max().unwrap_or_default()
    }

    /// The count of each motor at a position of x, y, z and e.
    #[must_use]
    pub fn inverse(&self, position: [i64; 4]) -> [i64; MOTORS] {
        self.rows.map(|row| row.into_iter().zip(position).map(|(times, steps)| i64::from(times) * steps).sum())
    }

    /// Forward kinematics from the motors' counts; `None` if they do not hold the tool.
    #[must_use]
    pub fn forward_kinematics(&self) -> Option<ForwardKinematics<{ MOTORS }>> {
        ForwardKinematics::new(self.rows)
    }

    /// Whether these rows are a valid machine.
    ///
    /// # Errors
    /// The first rule that they break.
    pub fn check(&self) -> Result<(), MechanismError> {
        for (motor, row) in self.motors() {
            if row_number(row).is_none() {
                return Err(MechanismError::Entry(motor));
            }
            if multiple(row) > 1 && row.iter().filter(|times| **times != 0).count() < 2 {
                return Err(MechanismError::Multiples);
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
            // Motors with the same or the opposite row step together, as one group.
            let place = |slot: &&mut Row| [NOT_FITTED, row, mirrored(row)].contains(*slot);
            *different.iter_mut().find(place).ok_or(MechanismError::TooManyGroups)? = row;
        }
        let [.., last] = different;
        if last != NOT_FITTED && self.has_multiples() {
            return Err(MechanismError::Multiples);
        }
        if is_held(&different) { Ok(()) } else { Err(MechanismError::Loose) }
    }

    /// Whether steps in one instant cause no strain: motors of one coordinate step together, and motors with opposite
    /// rows in opposite directions.
    #[must_use]
    pub fn is_unstrained(&self, steps: MotorSet, forward: MotorSet) -> bool {
        // Tests check every event in a build without inlined closures, so these loops have none.
        for (motor, row) in self.motors() {
            if !steps.has(motor) {
                continue;
            }
            if row == NOT_FITTED {
                return false;
            }
            let opposite = mirrored(row);
            for (other, its_row) in self.motors() {
                let (is_alike, is_opposite) = (its_row == row, its_row == opposite);
                let turns_alike = forward.has(other) == forward.has(motor);
                if (is_alike || is_opposite) && (!steps.has(other) || turns_alike != is_alike) {
                    return false;
                }
            }
        }
        true
    }
}
