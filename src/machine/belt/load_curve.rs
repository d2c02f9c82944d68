//! Load curve: the measured load of the motors as one motor of the belt is trimmed, and the trim with the least load.
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
//! So `right - left = 2 c u0` and `2 middle - left - right + |right - left| = 2 c arm`. These unknowns drop out: a
//! driver's reading without load (o), friction in the same direction on both arms, and the reading's fall per newton
//! (c). The only assumption is that the reading falls equally on both sides. Friction rounds the tip of the curve, so
//! u0 comes from the arms alone.

use crate::motors::{MOTORS, Motor, MotorSet};
use crate::units::whole_root;

/// Fractions of a reading and of a step in which means are counted.
pub(in crate::machine) const PARTS: i64 = 256;

/// Minimum number of readings per motor for a mean.
const LEAST_READINGS: u32 = 8;

/// A driver reads 0 of a motor without torque left. A motor with this share of zero readings, a quarter, is at its
/// limit. One that fails now and then is no more reliable than one that always does.
const AT_LIMIT: u32 = 4;

/// Readings of each motor in one direction with one trim.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Readings([Sum; MOTORS]);

/// Readings of a motor.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    count: u32,
    sum: u32,
    /// Sum of their squares; 4,000 readings of 10 bits.
    squares: u32,
    /// Number of zero readings.
    without_torque: u32,
}

impl Readings {
    /// Adds a motor's load reading (SG_RESULT, ten bits).
    pub fn note(&mut self, motor: Motor, reading: u32) {
        if let Some(sum) = self.0.get_mut(motor.index()) {
            sum.count += 1;
            sum.sum = sum.sum.saturating_add(reading);
            sum.squares = sum.squares.saturating_add(reading.saturating_mul(reading));
            sum.without_torque += u32::from(reading == 0);
        }
    }

    /// The motor without torque left, if there is one. If all read 0, their drivers measure nothing.
    fn at_limit(&self, motors: MotorSet) -> Option<Motor> {
        let (mut first, mut are_all) = (None, true);
        for motor in motors.iter() {
            let is_at_limit = self.0.get(motor.index()).is_some_and(Sum::is_at_limit);
            are_all &= is_at_limit;
            first = first.or(is_at_limit.then_some(motor));
        }
        first.filter(|_| !are_all)
    }
}

impl Sum {
    const fn is_at_limit(&self) -> bool {
        self.count >= LEAST_READINGS && self.without_torque * AT_LIMIT >= self.count
    }

    /// Their mean; `None` if there are too few.
    fn mean(&self) -> Option<Mean> {
        if self.count < LEAST_READINGS {
            return None;
        }
        let (n, total) = (i64::from(self.count), i64::from(self.sum));
        // n times the sum of squared deviations. SG_RESULT is rounded to steps of 2.
        let spread = (n * i64::from(self.squares) - total * total).max(0) + n * n / 3;
        Some(Mean { mean: total * PARTS / n, variance: spread * PARTS * PARTS / (n * n * (n - 1)) })
    }
}

/// A mean of readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Mean {
    /// In fractions of a reading. More means less load.
    mean: i64,
    /// Variance of the mean, in fractions of a reading squared.
    variance: i64,
}

impl Mean {
    fn add(&mut self, other: Self) {
        self.mean += other.mean;
        self.variance += other.variance;
    }

    /// A sum of so many means becomes their mean.
    const fn divide(&mut self, number: i64) {
        self.mean /= number;
        self.variance /= number * number;
    }
}

/// Readings with one trim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Load {
    /// Over all motors.
    all: Mean,
    /// The same in each direction of motion.
    ways: [Mean; 2],
    /// Of each of them.
    each: [Mean; MOTORS],
    /// The motor without torque left, if there is one.
    at_limit: Option<Motor>,
}

/// Load of these motors over a stroke and back; `None` if one of them has too few readings. Friction adds to the strain
/// of some in one direction and reduces it in the other, so each direction has its own mean.
pub(super) fn load_of_stroke(there_and_back: &[Readings; 2], motors: MotorSet) -> Option<Load> {
    let mut load = Load::default();
    for (readings, way) in there_and_back.iter().zip(&mut load.ways) {
        let mut number = 0;
        for motor in motors.iter() {
            let (sum, own) = (readings.0.get(motor.index())?, load.each.get_mut(motor.index())?);
            let mean = sum.mean()?;
            own.add(mean);
            way.add(mean);
            number += 1;
        }
        way.divide(number.max(1));
        load.all.add(*way);
        load.at_limit = load.at_limit.or(readings.at_limit(motors));
    }
    load.each.iter_mut().for_each(|own| own.divide(2));
    load.all.divide(2);
    (!motors.is_empty()).then_some(load)
}

/// Left, middle and right of the curve of a motor, or of all motors.
fn curve([left, middle, right]: &[Load; 3], motor: Option<usize>) -> [&Mean; 3] {
    [of_motor(left, motor), of_motor(middle, motor), of_motor(right, motor)]
}

fn of_motor(load: &Load, motor: Option<usize>) -> &Mean {
    motor.and_then(|motor| load.each.get(motor)).unwrap_or(&load.all)
}

/// Twice the height of the curve's middle above its arms, where the arms meet, and its variance.
fn rise([left, middle, right]: [&Mean; 3]) -> Mean {
    Mean {
        mean: 2 * middle.mean - left.mean - right.mean + (right.mean - left.mean).abs(),
        variance: 4 * middle.variance + 2 * left.variance + 2 * right.variance,
    }
}

/// The greatest rise of a motor.
fn greatest_rise(loads: &[Load; 3]) -> i64 {
    (0..MOTORS).fold(i64::MIN, |most, motor| most.max(rise(curve(loads, Some(motor))).mean))
}

/// The motor without torque left on one of these strokes. The mean hides it: the three others show where the load is
/// least, and this motor moves with the next stroke.
pub(super) fn without_torque<'a>(loads: impl IntoIterator<Item = &'a Load>) -> Option<Motor> {
    loads.into_iter().find_map(|load| load.at_limit)
}

/// The motor with an inverted curve. If friction exceeds its holding torque, the belt drags it, and it skips a turn at
/// each reversal. Strain by the others then relieves it. With less friction its load is equal everywhere, or less in
/// the middle. An inverted curve falls as much as the other curves rise; a quarter of that is enough.
pub(super) fn dragged(loads: &[Load; 3]) -> Option<Motor> {
    let most = greatest_rise(loads);
    Motor::ALL.into_iter().find(|motor| {
        let Mean { mean, variance } = rise(curve(loads, Some(motor.index())));
        mean < 0 && -4 * mean > most && mean * mean > 36 * variance
    })
}

/// Place of the apex, in fractions of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Apex {
    /// From the trim in the middle.
    pub at: i64,
    pub variance: i64,
}

/// Fall of a reading per step of trim, in fractions of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slope(i64);

impl Slope {
    /// Fall of a reading per mm of trim, given the trim steps in a mm of belt.
    pub fn readings_per_mm(self, steps_per_mm: i64) -> u16 {
        u16::try_from(self.0 * steps_per_mm / PARTS).unwrap_or(u16::MAX)
    }
}

/// Whether `a` has less load than `b` beyond chance: three times the standard error.
pub(super) const fn is_less_loaded(a: &Load, b: &Load) -> bool {
    let difference = a.all.mean - b.all.mean;
    difference > 0 && difference * difference > 9 * (a.all.variance + b.all.variance)
}

/// Slope of the arms, `arm` steps to either side; `None` if it does not differ from 0 twice as surely as an apex needs.
pub(super) fn slope(loads: &[Load; 3], arm: i64) -> Option<Slope> {
    let Mean { mean: rise, variance } = rise(curve(loads, None));
    let slope = rise / (2 * arm.max(1));
    (rise > 0 && slope > 0 && rise * rise > 36 * variance).then_some(Slope(slope))
}

/// By how much the loads contradict each other, in fractions of a step. Where nothing drags, both directions of motion
/// and all motors have their least load at one trim, and the load of each motor changes with the strain. A roller that
/// does not turn holds strain back on one side of it, and a motor that rubs hides a part of it. The mean of all has an
/// apex all the same. What chance may explain (four standard errors) counts as nothing. With a motor to leave out, only
/// the other motors are compared: it may be the one that rubs.
pub(super) fn contradiction(loads: &[Load; 3], arm: i64, Slope(slope): Slope, without: Option<Motor>) -> i64 {
    let [left, _, right] = loads;
    let mut by_way = Mean::default();
    for (sign, (left, right)) in [1, -1].into_iter().zip(left.ways.iter().zip(&right.ways)) {
        by_way.add(Mean { mean: sign * (right.mean - left.mean), variance: left.variance + right.variance });
    }
    let is_by_way = by_way.mean * by_way.mean > 16 * by_way.variance;
    let mut found = if is_by_way && without.is_none() { by_way.mean.abs() * PARTS / (4 * slope) } else { 0 };
    let most = greatest_rise(loads);
    let common = (right.all.mean - left.all.mean) * PARTS / (2 * slope);
    for motor in Motor::ALL {
        let own = curve(loads, Some(motor.index()));
        let [left, middle, right] = own;
        if Some(motor) == without || middle.mean == 0 && left.mean == 0 && right.mean == 0 {
            continue;
        }
        let height = rise(own).mean;
        // Its load hardly changes. Friction is what it follows then: by half a full step its rotor may lag at rest.
        let of_motor = if 4 * height < most {
            arm * PARTS / 4
        } else {
            let (arm, height) = (arm * PARTS, height.max(1));
            let apart = ((right.mean - left.mean) * arm / height - common).abs();
            let chance = error(16 * (left.variance + right.variance)) * arm / height;
            // Friction rounds the tip, which moves an apex between the middle and an arm by up to a third of a full
            // step.
            if apart > chance + arm / 6 { apart } else { 0 }
        };
        found = found.max(of_motor);
    }
    found
}

/// Where arms of this slope meet.
pub(super) const fn apex([left, _, right]: &[Load; 3], Slope(slope): Slope) -> Apex {
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
    /// Adds an apex that was measured about a trim in steps.
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

    /// Their spread.
    pub const fn spread(&self) -> i64 {
        self.greatest - self.least
    }

    /// The step nearest to their mean.
    pub fn step(&self) -> i32 {
        ((2 * self.sum + PARTS * self.count).div_euclid((2 * PARTS * self.count).max(1))) as i32
    }

    /// Their mean's distance from that step, in fractions of a step.
    pub fn beside(&self) -> i64 {
        self.sum / self.count.max(1) - i64::from(self.step()) * PARTS
    }

    /// Bound of their mean's distance from that step, in fractions of a step: the distance plus three standard errors.
    pub fn bound(&self) -> i64 {
        let count = self.count.max(1);
        self.beside().abs() + 3 * error(self.variance / (count * count)) + 1
    }
}

/// The standard error of a mean with this variance.
#[inline(never)]
pub(super) const fn error(variance: i64) -> i64 {
    whole_root(variance.unsigned_abs()) as i64
}

/// Fractions as thousandths of a step.
pub(in crate::machine) const fn thousandths(parts: i64) -> i64 {
    parts * 1000 / PARTS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motors::prototype;

    fn load(mean: i64) -> Load {
        let all = Mean { mean: mean * PARTS, variance: PARTS };
        Load { all, ways: [all; 2], each: [Mean::default(); MOTORS], at_limit: None }
    }

    /// 400 without load, 2 less a step.
    fn at(trim: i64, apex: i64) -> Load {
        load(400 - 2 * (trim - apex).abs())
    }

    #[test]
    fn the_apex_is_where_both_arms_say() {
        for apex_at in -20..=20 {
            let arms = [at(-32, apex_at), at(0, apex_at), at(32, apex_at)];
            let slope = slope(&arms, 32).unwrap();
            assert_eq!((slope, slope.readings_per_mm(80)), (Slope(2 * PARTS), 160));
            let found = apex(&arms, slope);
            assert_eq!(found.at, apex_at * PARTS);
            // Two readings with a standard error of 1/16 each, over twice a slope of 2.
            assert_eq!(found.variance, 2 * PARTS * PARTS * PARTS / (4 * 4 * PARTS * PARTS));
        }
    }

    #[test]
    fn an_apex_beside_the_arms_is_as_far_as_they_reach() {
        for apex_at in [-64, -40, 40, 64] {
            let arms = [at(-32, apex_at), at(0, apex_at), at(32, apex_at)];
            let found = apex(&arms, slope(&arms, 32).unwrap());
            assert_eq!(found.at, 32 * PARTS * apex_at.signum());
        }
    }

    #[test]
    fn flat_and_inverted_curves_have_no_slope() {
        assert_eq!(slope(&[load(300); 3], 32), None);
        assert_eq!(slope(&[load(300), load(200), load(300)], 32), None);
        // One reading more than the others, when each is accurate to a sixteenth.
        assert!(slope(&[load(300), load(320), load(300)], 32).is_some());
    }

    #[test]
    fn a_mean_needs_readings_of_every_motor() {
        let both = MotorSet::of(prototype::M1).with(MotorSet::of(prototype::M4));
        let mut readings = Readings::default();
        for n in 0..100 {
            readings.note(prototype::M1, 300 + n % 2 * 2);
        }
        assert_eq!(load_of_stroke(&[readings; 2], both), None);
        let one = load_of_stroke(&[readings; 2], MotorSet::of(prototype::M1)).unwrap();
        assert_eq!(one.all.mean, 301 * PARTS);
        for _ in 0..100 {
            readings.note(prototype::M4, 200);
        }
        let two = load_of_stroke(&[readings; 2], both).unwrap();
        assert_eq!(two.all.mean, (301 + 200) * PARTS / 2);
        // Variance of a square of 1 plus the third from rounding, over 99 readings, for two motors if only one changes.
        let expected = (PARTS * PARTS * 4 / 3 / 99 + PARTS * PARTS / 3 / 99) / 4;
        let [variance, _] = two.ways.map(|way| way.variance);
        assert!((variance - expected).abs() <= 2, "{variance} {expected}");
        assert!(!is_less_loaded(&two, &two) && is_less_loaded(&one, &two) && !is_less_loaded(&two, &one));
    }

    #[test]
    fn a_motor_without_torque_is_named_although_the_mean_is_as_that_of_others() {
        let motors = MotorSet::of(prototype::M1).with(MotorSet::of(prototype::M4));
        let read = |zeros: u32| {
            let mut readings = Readings::default();
            (0..40).for_each(|n| readings.note(prototype::M4, if n < zeros { 0 } else { 300 }));
            (0..40).for_each(|_| readings.note(prototype::M1, 300));
            readings
        };
        assert_eq!((read(9).at_limit(motors), read(10).at_limit(motors)), (None, Some(prototype::M4)));
        assert_eq!(read(40).at_limit(MotorSet::of(prototype::M1)), None);
        // With one motor alone, or with all of them, the driver measures nothing.
        assert_eq!(read(40).at_limit(MotorSet::of(prototype::M4)), None);
        let stroke = load_of_stroke(&[read(0), read(40)], motors);
        assert_eq!(stroke.and_then(|load| load.at_limit), Some(prototype::M4));
        // A few readings are not enough.
        let mut readings = Readings::default();
        (1..LEAST_READINGS).for_each(|_| readings.note(prototype::M1, 0));
        (0..40).for_each(|_| readings.note(prototype::M4, 300));
        assert_eq!(readings.at_limit(motors), None);
    }

    /// Readings at the apex and two full steps away while motor 1 rubs with this many N and holds 63, from the belt's
    /// twin.
    #[test]
    fn a_motor_that_is_dragged_is_named_and_one_that_rubs_is_not() {
        let motors = [prototype::M1, prototype::M4, prototype::M8]
            .map(MotorSet::of)
            .into_iter()
            .fold(MotorSet::NONE, MotorSet::with);
        let stroke = |own: u32, others: u32| {
            let mut readings = Readings::default();
            for n in 0..25_u32 {
                readings.note(prototype::M1, own + n % 5);
                readings.note(prototype::M4, others + n % 7);
                readings.note(prototype::M8, others + n % 3);
            }
            load_of_stroke(&[readings, readings], motors).unwrap()
        };
        for (newtons, arms, middle, expected) in [
            (0, (330, 330), (390, 390), None),
            (20, (278, 330), (278, 388), None),
            (50, (101, 331), (100, 378), None),
            (60, (110, 306), (43, 372), Some(prototype::M1)),
            (70, (118, 232), (51, 300), Some(prototype::M1)),
            (95, (101, 90), (39, 154), Some(prototype::M1)),
        ] {
            let [arm, middle] = [arms, middle].map(|(own, others)| stroke(own, others));
            assert_eq!(dragged(&[arm, middle, arm]), expected, "{newtons}");
            // The mean shows nothing.
            assert!(slope(&[arm, middle, arm], 32).is_some(), "{newtons}");
        }
    }

    #[test]
    fn what_differs_between_there_and_back_is_no_spread() {
        let motor = MotorSet::of(prototype::M1);
        let of = |reading: u32| {
            let mut readings = Readings::default();
            (0..50_u32).for_each(|n| readings.note(prototype::M1, reading + n % 2 * 2));
            readings
        };
        let same = load_of_stroke(&[of(300); 2], motor).unwrap();
        let unlike = load_of_stroke(&[of(290), of(310)], motor).unwrap();
        assert_eq!((same.all, same.each), (unlike.all, unlike.each));
        assert_eq!(load_of_stroke(&[of(300), Readings::default()], motor), None);
    }

    /// Readings of four motors left, in the middle and right, as the belt's twin makes them; the same both ways, or
    /// with so much more there than back.
    fn stroke_of_four(own: [u32; 4], tilt: u32) -> Load {
        let motors = [prototype::M1, prototype::M4, prototype::M8, prototype::M11];
        let all = motors.into_iter().fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(motor)));
        let [there, back] = [tilt, 0].map(|tilt| {
            let mut readings = Readings::default();
            for (motor, own) in motors.into_iter().zip(own) {
                (0..25_u32).for_each(|n| readings.note(motor, own + tilt + n % 5));
            }
            readings
        });
        load_of_stroke(&[there, back], all).unwrap()
    }

    #[test]
    fn loads_contradict_each_other_where_something_drags() {
        const ARM: i64 = 32;
        let of = |rows: [[u32; 4]; 3], tilts: [u32; 3]| {
            let loads = [0, 1, 2].map(|place| stroke_of_four(rows[place], tilts[place]));
            contradiction(&loads, ARM, slope(&loads, ARM).unwrap(), None)
        };
        let sound = [[329, 328, 329, 328], [388; 4], [327, 329, 329, 329]];
        assert_eq!(of(sound, [0; 3]), 0);
        // Motors that measure unlike loads agree about the apex.
        assert_eq!(of([[329, 228, 259, 358], [388, 308, 299, 428], [329, 228, 259, 358]], [0; 3]), 0);
        // A roller drags: there the apex is 8 steps to one side, back 8 to the other.
        let tilted = of(sound, [0, 0, 60]);
        assert!((tilted - 8 * PARTS).abs() < PARTS, "{tilted}");
        // Rollers 6 and 13 hold strain back: the motors next to them have their apex 14 to 28 steps to the sides.
        let six = of([[276, 170, 301, 385], [382, 315, 279, 346], [310, 338, 251, 280]], [0; 3]);
        assert!((20 * PARTS..32 * PARTS).contains(&six), "{six}");
        let thirteen = of([[179, 277, 373, 325], [304, 336, 369, 388], [110, 209, 312, 385]], [0; 3]);
        assert!(thirteen > 12 * PARTS, "{thirteen}");
        // Without motor 11 the others contradict each other all the same.
        let rows = [[179, 277, 373, 0], [304, 336, 369, 0], [110, 209, 312, 0]];
        let loads = rows.map(|row| stroke_of_four(row, 0));
        assert!(contradiction(&loads, ARM, slope(&loads, ARM).unwrap(), Some(prototype::M11)) > 8 * PARTS);
        // A motor that rubs with 50 N: its own load hardly changes.
        let rubs = of([[99, 330, 332, 329], [101, 377, 377, 381], [101, 330, 331, 331]], [0; 3]);
        assert_eq!(rubs, 8 * PARTS);
    }

    #[test]
    fn findings_are_averaged_and_rounded_to_a_step() {
        let mut findings = Findings::default();
        for (trim, at) in [(-3, -PARTS / 4), (-3, -PARTS / 2), (-4, PARTS / 4)] {
            findings.note(trim, Apex { at, variance: 300 });
        }
        assert_eq!((findings.step(), findings.count(), findings.spread()), (-3, 3, PARTS / 2));
        // Half a step of distance, and three times 10 parts.
        assert_eq!(findings.bound(), PARTS / 2 + 3 * 10 + 1);
        let mut findings = Findings::default();
        findings.note(5, Apex { at: 130, variance: 0 });
        assert_eq!((findings.step(), findings.bound(), findings.spread()), (6, PARTS - 130 + 1, 0));
        assert_eq!(thousandths(PARTS / 2), 500);
    }
}
