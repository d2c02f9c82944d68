//! Counts: the steps of each motor since the start, and what an event adds to them.

use corehbot::motors::{MOTORS, MotorSet};

/// Steps of each motor since the start, in the order of [`Motor::ALL`](corehbot::motors::Motor::ALL).
pub type Counts = [i64; MOTORS];

/// Motors whose steps are looked up together.
pub(crate) const HALF: usize = MOTORS / 2;

/// Steps of four motors, by the motors that step (low four bits) and those that would go forward (high four bits).
pub(crate) const STEPS: [[i64; HALF]; 1 << MOTORS] = {
    let mut table = [[0; HALF]; 1 << MOTORS];
    let mut index = 0;
    while index < table.len() {
        let mut motor = 0;
        while motor < HALF {
            if index >> motor & 1 != 0 {
                table[index][motor] = if index >> (HALF + motor) & 1 != 0 { 1 } else { -1 };
            }
            motor += 1;
        }
        index += 1;
    }
    table
};

/// The places of an event's lower and upper motors in [`STEPS`].
#[inline]
pub(crate) fn places(steps: MotorSet, forward: MotorSet) -> [usize; 2] {
    let (s, f) = (usize::from(steps.0), usize::from(forward.0));
    [s & 0xF | (f & 0xF) << HALF, s >> HALF | f & 0xF0]
}

/// Adds an event to the counts: looked up, because this runs at every event.
#[inline]
pub(crate) fn count(counts: &mut Counts, steps: MotorSet, forward: MotorSet) {
    let (low, high) = counts.split_at_mut(HALF);
    for (counts, place) in [low, high].into_iter().zip(places(steps, forward)) {
        for (count, step) in counts.iter_mut().zip(&STEPS[place]) {
            *count += step;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_of_motors_is_counted() {
        for (steps, forward) in (0..=u8::MAX).flat_map(|steps| (0..=u8::MAX).map(move |forward| (steps, forward))) {
            let mut counts = [7; MOTORS];
            count(&mut counts, MotorSet(steps), MotorSet(forward));
            for (motor, count) in corehbot::motors::Motor::ALL.into_iter().zip(counts) {
                let way = if MotorSet(forward).has(motor) { 1 } else { -1 };
                assert_eq!(count, if MotorSet(steps).has(motor) { 7 + way } else { 7 });
            }
        }
    }
}
