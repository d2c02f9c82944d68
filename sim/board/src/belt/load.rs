//! Load: a TMC2209's measurement of its motor's load (StallGuard4).
//!
//! From the datasheet (rev 1.09, sections 5.3 and 11): SG_RESULT is measured in stealthChop, is updated with each full
//! step whatever TCOOLTHRS says, and is higher for less load; of its ten bits 9 and 0 are always 0. Without steps it
//! stays. Assumed, since the datasheet gives no slope: a straight line from [`FREE`] without load to 0 where the motor
//! has no torque left, the same at every speed, with [`NOISE`].

use crate::tmc2209::{SG_RESULT, TPWMTHRS, Tmc2209, gconf};
use corehbot_twin::random::Random;

/// SG_RESULT of a motor that bears nothing. Assumed.
const FREE: f64 = 400.0;

/// A measurement is off by so much at most, each value as likely. Assumed: 3 % of [`FREE`].
const NOISE: f64 = 12.0;

/// Bits that can be 1.
const BITS: u32 = 0x1FE;

/// Microsteps of a full step in TSTEP (section 5.2: time between two 1/256 microsteps).
const FINEST: f64 = 256.0;

/// Clocks of the chip in a tick of 0.1 us: 12 MHz (section 5.2).
const CLOCKS_A_TICK: f64 = 1.2;

/// The stream of a seed for the first motor's noise; the others follow.
const STREAM: u64 = 0x6c6f_6164; // "load"

/// A motor's load, as it is measured.
#[derive(Debug)]
pub(super) struct Load {
    random: Random,
    /// When it stepped last, in ticks.
    stepped: u64,
}

impl Load {
    /// Of the motor of this place among the motors, with the noise of a seed.
    pub(super) fn new(seed: u64, motor: usize) -> Self {
        Self { random: Random::new(seed, STREAM + motor as u64), stepped: 0 }
    }

    /// The motor has stepped to `count`. At a full step its driver measures the share of its torque that it bears, of
    /// 1.
    pub(super) fn step(&mut self, now: u64, count: i64, chip: &mut Tmc2209, share: impl FnOnce() -> f64) {
        let gap = (now - self.stepped) as f64;
        self.stepped = now;
        let microsteps = chip.microsteps();
        if count.rem_euclid(i64::from(microsteps)) != 0 {
            return;
        }
        let share = share();
        let noise = (2.0 * self.random.unit() - 1.0) * NOISE;
        let tstep = gap * CLOCKS_A_TICK * f64::from(microsteps) / FINEST;
        let is_stealth = chip.register(gconf::ADDRESS) & gconf::EN_SPREADCYCLE == 0;
        // Section 5.2: TPWMTHRS > TSTEP is fast enough for spreadCycle; 0 is never.
        if is_stealth && tstep >= f64::from(chip.register(TPWMTHRS)) {
            let measured = (FREE * (1.0 - share) + noise).clamp(0.0, f64::from(BITS));
            chip.set(SG_RESULT, measured as u32 & BITS);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SG_RESULT after each of 1,000 full steps of 16 microsteps, 250 us apart.
    fn measured(chip: &mut Tmc2209, share: f64) -> Vec<u32> {
        let mut load = Load::new(1, 0);
        let steps = (1..=16_000).map(|count| {
            load.step(count * 2500, count as i64, chip, || share);
            chip.register(SG_RESULT)
        });
        steps.skip(15).step_by(16).collect()
    }

    /// A chip of 16 microsteps (by its pins), in stealthChop or not.
    fn chip(is_stealth: bool) -> Tmc2209 {
        let mut chip = Tmc2209::new(3);
        chip.set(gconf::ADDRESS, if is_stealth { 0 } else { gconf::EN_SPREADCYCLE });
        chip
    }

    #[test]
    fn more_load_reads_lower_within_the_noise() {
        for (share, expected) in [(0.0, 400.0), (0.25, 300.0), (1.0, 0.0)] {
            let read = measured(&mut chip(true), share);
            let mean = f64::from(read.iter().sum::<u32>()) / read.len() as f64;
            // A bit of 2 is cut off, so 1 is missing on average; at no torque left noise is cut at 0.
            assert!((mean - expected).abs() < 4.0, "{share}: {mean}");
            assert!(read.iter().all(|v| v & !BITS == 0 && (f64::from(*v) - expected).abs() < NOISE + 2.0));
            assert!(read.iter().any(|v| *v != read[0]));
        }
    }

    #[test]
    fn spread_cycle_measures_nothing_and_a_threshold_decides_by_speed() {
        let mut spread = chip(false);
        assert!(measured(&mut spread, 0.5).iter().all(|v| *v == 0));
        // TSTEP is 2,500 * 1.2 / 16 = 187.5 here.
        let mut hybrid = chip(true);
        hybrid.set(TPWMTHRS, 188);
        assert!(measured(&mut hybrid, 0.5).iter().all(|v| *v == 0));
        hybrid.set(TPWMTHRS, 187);
        assert!(measured(&mut hybrid, 0.5).iter().skip(1).all(|v| *v > 150));
    }
}
