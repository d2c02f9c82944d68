//! Load curve: what drivers measure of their motors' load while one motor of the belt is trimmed, and where it is least.
//!
//! ```text
//!  SG_RESULT   ^        .                      one motor is turned against the others by a trim u;
//!  (less load) |      .   .                    the belt bears |residual|, which is 0 at the apex u0:
//!              |    .       .
//!              |  .           .                left  = o - c (arm + u0),  right = o - c (arm - u0)
//!              |.               .              middle = o - c |u0|, all counted from the trim in the middle
//!              +--l-----m-----r----> u
//! ```
//!
//! So `right - left = 2 c u0` and `2 middle - left - right + |right - left| = 2 c arm`. What a driver reads without load (o), the friction
//! that goes the same way on both arms, and how much a reading falls for a newton (c) drop out: only that it falls as much to one side as
//! to the other is assumed. The tip of the curve is rounded by friction, so u0 is taken from the arms alone.

use crate::motors::{Motor, MotorSet};

/// Parts of a reading and of a step in which means are counted.
pub(super) const PARTS: i64 = 256;

/// Readings of each motor without which a mean says nothing.
const LEAST_READINGS: u32 = 8;

/// A driver reads 0 of a motor that has no torque left. One of which so many of the readings are 0, as a part of them, is at its limit:
/// a quarter, for a motor that falls now and then is no more to be relied on than one that does always.
const AT_LIMIT: u32 = 4;

/// What has been read of each motor on one way with one trim.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Readings([Sum; Motor::ALL.len()]);

/// Readings of a motor.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    count: u32,
    sum: u32,
    /// Of their squares; 4,000 readings of 10 bits.
    squares: u32,
    /// How many were 0.
    without_torque: u32,
}

impl Readings {
    /// Takes in what the driver of a motor has measured (SG_RESULT, ten bits).
    pub fn note(&mut self, motor: Motor, reading: u32) {
        if let Some(sum) = self.0.get_mut(motor as usize) {
            sum.count += 1;
            sum.sum = sum.sum.saturating_add(reading);
            sum.squares = sum.squares.saturating_add(reading.saturating_mul(reading));
            sum.without_torque += u32::from(reading == 0);
        }
    }

    /// The motor that had no torque left, if one of these had none. Where all read 0, their drivers measure nothing.
    fn at_limit(&self, motors: MotorSet) -> Option<Motor> {
        let is_at_limit = |sum: Sum| sum.count >= LEAST_READINGS && sum.without_torque * AT_LIMIT >= sum.count;
        let each = || Motor::ALL.into_iter().zip(self.0).filter(|(motor, _)| motors.has(*motor));
        let first = each().find(|(_, sum)| is_at_limit(*sum)).map(|(motor, _)| motor);
        first.filter(|_| !each().all(|(_, sum)| is_at_limit(sum)))
    }

    /// The load of these motors; `None` if one of them was hardly read.
    fn load(&self, motors: MotorSet) -> Option<Load> {
        let mut each = [Mean::default(); Motor::ALL.len()];
        let (mut all, mut number) = (Mean::default(), 0);
        for ((motor, sum), own) in Motor::ALL.into_iter().zip(self.0).zip(&mut each) {
            if !motors.has(motor) {
                continue;
            }
            if sum.count < LEAST_READINGS {
                return None;
            }
            let (n, total) = (i64::from(sum.count), i64::from(sum.sum));
            // n times the sum of squared deviations; what numbers are cut to is 2 of a reading.
            let spread = (n * i64::from(sum.squares) - total * total).max(0) + n * n / 3;
            *own = Mean { mean: total * PARTS / n, variance: spread * PARTS * PARTS / (n * n * (n - 1)) };
            all.mean += own.mean;
            all.variance += own.variance;
            number += 1;
        }
        let all = || Mean { mean: all.mean / number, variance: all.variance / (number * number) };
        (number > 0).then(|| Load { all: all(), each, at_limit: self.at_limit(motors) })
    }
}

/// A mean of readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Mean {
    /// In parts of a reading: the higher, the less load.
    mean: i64,
    /// Of the mean, in parts of a reading squared.
    variance: i64,
}

impl Mean {
    /// Of two ways.
    const fn between(self, other: Self) -> Self {
        Self { mean: (self.mean + other.mean) / 2, variance: (self.variance + other.variance) / 4 }
    }
}

/// What was read with one trim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Load {
    /// Over all motors.
    all: Mean,
    /// Of each of them.
    each: [Mean; Motor::ALL.len()],
    /// The motor that had no torque left, if one of them had none.
    at_limit: Option<Motor>,
}

/// The load of these motors on the way there and back. Friction adds to the strain of some on one way and takes from it on the other, so
/// each way has a mean of its own.
pub(super) fn load_of_stroke(there: &Readings, back: &Readings, motors: MotorSet) -> Option<Load> {
    let (there, back) = (there.load(motors)?, back.load(motors)?);
    let mut each = there.each;
    each.iter_mut().zip(back.each).for_each(|(there, back)| *there = there.between(back));
    Some(Load { all: there.all.between(back.all), each, at_limit: there.at_limit.or(back.at_limit) })
}

/// By how much the middle of a curve is above its arms, twice, where the arms meet; and the variance of that.
fn rise([left, middle, right]: [Mean; 3]) -> Mean {
    Mean {
        mean: 2 * middle.mean - left.mean - right.mean + (right.mean - left.mean).abs(),
        variance: 4 * middle.variance + 2 * left.variance + 2 * right.variance,
    }
}

/// The motor that had no torque left on one of these strokes. The mean of all hides it: three others tell where the belt bears least, and
/// this one is elsewhere after the next move.
pub(super) fn without_torque(loads: &[Load]) -> Option<Motor> {
    loads.iter().find_map(|load| load.at_limit)
}

/// The motor with a curve of its own that is upside down. One that rubs with more than it holds lets the belt drag it, and falls by a turn
/// each time that the tool turns back: it bears less where the others strain the belt for it. (One that rubs with less bears the same
/// everywhere, or less in the middle.) Its curve then falls as much as those of the others rise; a quarter of that is enough.
pub(super) fn dragged(loads: [Load; 3]) -> Option<Motor> {
    let own = |index: usize| rise(loads.map(|load| load.each.get(index).copied().unwrap_or_default()));
    let most = (0..Motor::ALL.len()).map(|index| own(index).mean).max().unwrap_or_default();
    let is_dragged = |Mean { mean, variance }: Mean| mean < 0 && -4 * mean > most && mean * mean > 36 * variance;
    Motor::ALL.into_iter().enumerate().find(|(index, _)| is_dragged(own(*index))).map(|(_, motor)| motor)
}

/// Where the apex lies, in parts of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Apex {
    /// From the trim in the middle.
    pub at: i64,
    pub variance: i64,
}

impl Apex {
    /// Whether it is so many steps from the trim in the middle, or farther.
    pub const fn is_beyond(self, steps: i32) -> bool {
        self.at.abs() >= steps as i64 * PARTS
    }
}

/// How much a reading falls for a step of trim, in parts of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slope(i64);

impl Slope {
    /// How many steps of trim are a mm of belt, given: how much a reading falls for a mm.
    pub fn readings_per_mm(self, steps_per_mm: i64) -> u16 {
        u16::try_from(self.0 * steps_per_mm / PARTS).unwrap_or(u16::MAX)
    }
}

/// Whether `a` is less loaded than `b` by more than chance explains: three times the standard error.
pub(super) fn is_less_loaded(a: Load, b: Load) -> bool {
    let difference = a.all.mean - b.all.mean;
    difference > 0 && difference * difference > 9 * (a.all.variance + b.all.variance)
}

/// The slope of the arms, `arm` steps to either side; `None` if readings do not tell it from 0: twice as surely as an apex needs.
pub(super) fn slope(loads: [Load; 3], arm: i64) -> Option<Slope> {
    let Mean { mean: rise, variance } = rise(loads.map(|load| load.all));
    let slope = rise / (2 * arm.max(1));
    (rise > 0 && slope > 0 && rise * rise > 36 * variance).then_some(Slope(slope))
}

/// Where arms of this slope meet.
pub(super) fn apex(left: Load, right: Load, Slope(slope): Slope) -> Apex {
    let (left, right) = (left.all, right.all);
    let at = (right.mean - left.mean) * PARTS / (2 * slope);
    Apex { at, variance: (left.variance + right.variance) * PARTS * PARTS / (4 * slope * slope) }
}

/// Several findings of one apex, in parts of a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Findings {
    sum: i64,
    variance: i64,
    count: i64,
    least: i64,
    greatest: i64,
}

impl Findings {
    /// Takes in an apex that was looked for about a trim in steps.
    pub fn note(&mut self, trim: i32, apex: Apex) {
        let at = i64::from(trim) * PARTS + apex.at;
        let is_first = self.count == 0;
        self.least = if is_first { at } else { self.least.min(at) };
        self.greatest = if is_first { at } else { self.greatest.max(at) };
        self.sum += at;
        self.variance += apex.variance;
        self.count += 1;
    }

    pub const fn count(&self) -> i64 {
        self.count
    }

    /// How far they lie apart.
    pub const fn spread(&self) -> i64 {
        self.greatest - self.least
    }

    /// The step that is nearest to their mean.
    pub fn step(&self) -> i32 {
        ((2 * self.sum + PARTS * self.count).div_euclid((2 * PARTS * self.count).max(1))) as i32
    }

    /// How far their mean is from that step at most, in parts of a step: three times the standard error farther than it is.
    pub fn bound(&self) -> i64 {
        let count = self.count.max(1);
        let beside = (self.sum / count - i64::from(self.step()) * PARTS).abs();
        beside + 3 * (self.variance / (count * count)).isqrt() + 1
    }
}

/// A number of parts as thousandths of a step.
pub(super) const fn thousandths(parts: i64) -> i64 {
    parts * 1000 / PARTS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(mean: i64) -> Load {
        let all = Mean { mean: mean * PARTS, variance: PARTS };
        Load { all, each: [Mean::default(); Motor::ALL.len()], at_limit: None }
    }

    /// 400 without load, 2 less a step.
    fn at(trim: i64, apex: i64) -> Load {
        load(400 - 2 * (trim - apex).abs())
    }

    #[test]
    fn the_apex_is_where_both_arms_say() {
        for apex_at in -20..=20 {
            let arms = [at(-32, apex_at), at(0, apex_at), at(32, apex_at)];
            let slope = slope(arms, 32).unwrap();
            assert_eq!((slope, slope.readings_per_mm(80)), (Slope(2 * PARTS), 160));
            let found = apex(arms[0], arms[2], slope);
            assert_eq!(found.at, apex_at * PARTS);
            assert!(found.is_beyond(apex_at.abs() as i32) && !found.is_beyond(apex_at.abs() as i32 + 1));
            // Two readings with a standard error of 1/16 each, over twice a slope of 2.
            assert_eq!(found.variance, 2 * PARTS * PARTS * PARTS / (4 * 4 * PARTS * PARTS));
        }
    }

    #[test]
    fn an_apex_beside_the_arms_is_as_far_as_they_reach() {
        for apex_at in [-64, -40, 40, 64] {
            let arms = [at(-32, apex_at), at(0, apex_at), at(32, apex_at)];
            let found = apex(arms[0], arms[2], slope(arms, 32).unwrap());
            assert_eq!(found.at, 32 * PARTS * apex_at.signum());
        }
    }

    #[test]
    fn flat_and_inverted_curves_have_no_slope() {
        assert_eq!(slope([load(300); 3], 32), None);
        assert_eq!(slope([load(300), load(200), load(300)], 32), None);
        // A reading more than the others, when each is sure to a sixteenth.
        assert!(slope([load(300), load(320), load(300)], 32).is_some());
    }

    #[test]
    fn a_mean_needs_readings_of_every_motor() {
        let both = MotorSet::of(Motor::M1).with(MotorSet::of(Motor::M4));
        let mut readings = Readings::default();
        for n in 0..100 {
            readings.note(Motor::M1, 300 + n % 2 * 2);
        }
        assert_eq!(readings.load(both), None);
        let one = readings.load(MotorSet::of(Motor::M1)).unwrap();
        assert_eq!(one.all.mean, 301 * PARTS);
        for _ in 0..100 {
            readings.note(Motor::M4, 200);
        }
        let two = readings.load(both).unwrap();
        assert_eq!(two.all.mean, (301 + 200) * PARTS / 2);
        // Of a square of 1 and the rounding's third, over 99 readings: of two motors, one of which does not change.
        let expected = (PARTS * PARTS * 4 / 3 / 99 + PARTS * PARTS / 3 / 99) / 4;
        assert!((two.all.variance - expected).abs() <= 2, "{} {expected}", two.all.variance);
        assert!(!is_less_loaded(two, two) && is_less_loaded(one, two) && !is_less_loaded(two, one));
    }

    #[test]
    fn a_motor_without_torque_is_named_although_the_mean_is_as_that_of_others() {
        let motors = MotorSet::of(Motor::M1).with(MotorSet::of(Motor::M4));
        let read = |zeros: u32| {
            let mut readings = Readings::default();
            (0..40).for_each(|n| readings.note(Motor::M4, if n < zeros { 0 } else { 300 }));
            (0..40).for_each(|_| readings.note(Motor::M1, 300));
            readings
        };
        assert_eq!((read(9).at_limit(motors), read(10).at_limit(motors)), (None, Some(Motor::M4)));
        assert_eq!(read(40).at_limit(MotorSet::of(Motor::M1)), None);
        // Of a motor alone, or all of them, it is the driver that measures nothing.
        assert_eq!(read(40).at_limit(MotorSet::of(Motor::M4)), None);
        let stroke = load_of_stroke(&read(0), &read(40), motors);
        assert_eq!(stroke.and_then(|load| load.at_limit), Some(Motor::M4));
        // A few readings say nothing.
        let mut readings = Readings::default();
        (1..LEAST_READINGS).for_each(|_| readings.note(Motor::M1, 0));
        (0..40).for_each(|_| readings.note(Motor::M4, 300));
        assert_eq!(readings.at_limit(motors), None);
    }

    /// What drivers read at the apex and two full steps beside it while motor 1 rubs with so many N and holds 63, by the belt's twin.
    #[test]
    fn a_motor_that_is_dragged_is_named_and_one_that_rubs_is_not() {
        let motors =
            [Motor::M1, Motor::M4, Motor::M8].map(MotorSet::of).into_iter().fold(MotorSet::NONE, MotorSet::with);
        let stroke = |own: u32, others: u32| {
            let mut readings = Readings::default();
            for n in 0..25_u32 {
                readings.note(Motor::M1, own + n % 5);
                readings.note(Motor::M4, others + n % 7);
                readings.note(Motor::M8, others + n % 3);
            }
            load_of_stroke(&readings, &readings, motors).unwrap()
        };
        for (newtons, arms, middle, expected) in [
            (0, (330, 330), (390, 390), None),
            (20, (278, 330), (278, 388), None),
            (50, (101, 331), (100, 378), None),
            (60, (110, 306), (43, 372), Some(Motor::M1)),
            (70, (118, 232), (51, 300), Some(Motor::M1)),
            (95, (101, 90), (39, 154), Some(Motor::M1)),
        ] {
            let [arm, middle] = [arms, middle].map(|(own, others)| stroke(own, others));
            assert_eq!(dragged([arm, middle, arm]), expected, "{newtons}");
            // Of the mean nothing is seen.
            assert!(slope([arm, middle, arm], 32).is_some(), "{newtons}");
        }
    }

    #[test]
    fn what_differs_between_there_and_back_is_no_spread() {
        let motor = MotorSet::of(Motor::M1);
        let of = |reading: u32| {
            let mut readings = Readings::default();
            (0..50_u32).for_each(|n| readings.note(Motor::M1, reading + n % 2 * 2));
            readings
        };
        let same = load_of_stroke(&of(300), &of(300), motor).unwrap();
        let unlike = load_of_stroke(&of(290), &of(310), motor).unwrap();
        assert_eq!(same, unlike);
        assert_eq!(load_of_stroke(&of(300), &Readings::default(), motor), None);
    }

    #[test]
    fn findings_are_averaged_and_rounded_to_a_step() {
        let mut findings = Findings::default();
        for (trim, at) in [(-3, -PARTS / 4), (-3, -PARTS / 2), (-4, PARTS / 4)] {
            findings.note(trim, Apex { at, variance: 300 });
        }
        assert_eq!((findings.step(), findings.count(), findings.spread()), (-3, 3, PARTS / 2));
        // Half a step beside, and three times 10 parts.
        assert_eq!(findings.bound(), PARTS / 2 + 3 * 10 + 1);
        let mut findings = Findings::default();
        findings.note(5, Apex { at: 130, variance: 0 });
        assert_eq!((findings.step(), findings.bound(), findings.spread()), (6, PARTS - 130 + 1, 0));
        assert_eq!(thousandths(PARTS / 2), 500);
    }
}
