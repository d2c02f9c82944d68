//! Residuals: combinations of motor steps that move no axis and strain the belt.
//!
//! Four motors on one belt are more than x and y need. The sums of motor counts that are 0 for every position form the
//! left null space of the mechanism's matrix. The CoreH-bot (m1 - m4 + m8 - m11, equation 11 of the paper) and a
//! CoreXYZ with four motors have one such sum. A CoreXY with two motors per belt has two, a CoreXY none. If all motors
//! of one closed belt turn the same way, the belt circulates freely: this is another column of the matrix, not a
//! residual.
//!
//! At rest the firmware's counts have a residual of 0. The rotors need not: at power-up each settles at its own nearest
//! rest position, up to two full steps away.

use super::mechanism::Mechanism;
use crate::motors::{MOTORS, Motor, MotorSet};

/// Motors of x and y beyond the two needed.
const MOST: usize = MOTORS - 2;

/// Factor of each motor's count in one sum.
pub type Residual = [i32; MOTORS];

/// The residuals of a mechanism.
#[derive(Clone, Debug)]
pub struct Residuals(heapless::Vec<Residual, MOST>);

impl Residuals {
    /// Residuals of the motors that move x or y. With `is_closed` they turn one closed belt, and turning all of them
    /// alike strains nothing.
    #[must_use]
    #[inline(never)]
    pub fn new(mechanism: &Mechanism, is_closed: bool) -> Self {
        let belt = mechanism.belt_motors();
        // Each motor alone, then for each column only the sums that it leaves at 0.
        let mut sums: heapless::Vec<Residual, MOTORS> = heapless::Vec::new();
        for motor in Motor::ALL.into_iter().filter(|motor| belt.has(*motor)) {
            let mut alone = [0; MOTORS];
            alone[motor.index()] = 1;
            // There is a place for every motor.
            let _ = sums.push(alone);
        }
        for column in 0..3 {
            eliminate(&mut sums, &mechanism.rows.map(|row| row.get(column).copied().map_or(0, i32::from)));
        }
        if is_closed {
            eliminate(&mut sums, &[1; MOTORS]);
        }
        Self(sums.into_iter().take(MOST).map(with_sign).collect())
    }

    /// Each of them.
    pub fn iter(&self) -> core::slice::Iter<'_, Residual> {
        self.0.iter()
    }

    /// Whether there are none, because no motor is redundant.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The residuals that are left while these motors turn freely.
    #[must_use]
    pub fn without(&self, free: MotorSet) -> Self {
        let mut sums: heapless::Vec<Residual, MOTORS> = self.iter().copied().collect();
        for motor in free.iter() {
            let mut alone = [0; MOTORS];
            alone[motor.index()] = 1;
            eliminate(&mut sums, &alone);
        }
        Self(sums.into_iter().take(MOST).collect())
    }

    /// Motors to turn freely so that `motor` can turn alone without strain; first those of `preferred`.
    #[must_use]
    pub fn to_free(&self, motor: Motor, preferred: MotorSet) -> MotorSet {
        let mut free = MotorSet::NONE;
        // Each motor that is freed takes a residual away.
        for _ in self.iter() {
            let left = self.without(free);
            let Some(residual) = left.iter().map(motors_in).find(|motors| motors.has(motor)) else { break };
            let others = residual.without(MotorSet::of(motor));
            let first = others.iter().find(|other| preferred.has(*other)).or_else(|| others.iter().next());
            free = first.map_or(free, |first| free.with(MotorSet::of(first)));
        }
        free
    }

    /// The motors that strain each other.
    #[must_use]
    pub fn motors(&self) -> MotorSet {
        self.iter().fold(MotorSet::NONE, |all, residual| all.with(motors_in(residual)))
    }

    /// `motors` and all that can pull against any of them.
    #[must_use]
    pub fn with_opponents(&self, motors: MotorSet) -> MotorSet {
        let mut all = motors;
        // Each round adds a residual, or none and then all are in.
        for _ in self.iter() {
            for residual in self.iter().map(motors_in) {
                if residual.intersects(all) {
                    all = all.with(residual);
                }
            }
        }
        all
    }

    /// The subset of `motors` that may get power now. Motors that can pull against each other get power one at a time.
    #[must_use]
    pub fn first_of(&self, motors: MotorSet) -> MotorSet {
        let mut first = MotorSet::NONE;
        for motor in Motor::ALL.into_iter().map(MotorSet::of).filter(|motor| motors.intersects(*motor)) {
            let opponents = self.with_opponents(motor);
            if !first.intersects(opponents) {
                first = first.with(motor);
            }
        }
        first
    }
}

/// The motors in a sum.
#[must_use]
pub fn motors_in(residual: &Residual) -> MotorSet {
    let both = Motor::ALL.into_iter().zip(residual);
    both.filter(|(_, times)| **times != 0).fold(MotorSet::NONE, |set, (motor, _)| set.with(MotorSet::of(motor)))
}

/// Keeps the combinations of sums with a zero product with `column`. This is one sum less, unless all products were
/// zero.
fn eliminate(sums: &mut heapless::Vec<Residual, MOTORS>, column: &Residual) {
    let product = |sum: &Residual| sum.iter().zip(column).map(|(a, b)| a * b).sum::<i32>();
    let Some(place) = sums.iter().position(|sum| product(sum) != 0) else { return };
    let pivot = sums.remove(place);
    let times = product(&pivot);
    for sum in sums.iter_mut() {
        let of_pivot = product(sum);
        for (entry, from) in sum.iter_mut().zip(pivot) {
            *entry = *entry * times - from * of_pivot;
        }
        let divisor = sum.iter().fold(0, |all, entry| super::forward::greatest_divisor(all, i64::from(*entry))).max(1);
        *sum = sum.map(|entry| entry / divisor as i32);
    }
}

/// The same sum with a positive first entry.
fn with_sign(residual: Residual) -> Residual {
    match residual.iter().find(|entry| **entry != 0) {
        Some(entry) if *entry < 0 => residual.map(|entry| -entry),
        _ => residual,
    }
}
