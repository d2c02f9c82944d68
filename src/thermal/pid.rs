//! PID in Marlin's terms (M301): output of 0 to 255 from an error in K. The integral stops while the output is at a
//! limit and would go beyond. The derivative is the measurement's, so that a new target causes no jump.

use super::fixed_point::{RATE, kelvin, saturated};
use crate::settings;
use crate::units::{Celsius, Ratio};
use fixed::types::I12F20;

/// Further than this below the target, the heater is at full power and nothing is integrated (Marlin's
/// PID_FUNCTIONAL_RANGE).
const RANGE: Celsius = Celsius::const_from_int(10);

/// The derivative is smoothed over 1/2^5 of its history: 0.6 s.
const SMOOTHING: u32 = 5;

/// The output's full scale.
const FULL: I12F20 = I12F20::const_from_int(255);

/// A PID controller.
#[derive(Clone, Copy, Debug)]
pub struct Pid {
    gains: settings::Pid,
    /// Part of the output, 0 to 255.
    integral: I12F20,
    last: Option<Celsius>,
    /// K a second.
    rate: I12F20,
}

impl Pid {
    /// At rest.
    #[must_use]
    pub const fn new(gains: settings::Pid) -> Self {
        Self { gains, integral: I12F20::ZERO, last: None, rate: I12F20::ZERO }
    }

    /// The duty of 0 to 65,535 for the next control period, at most `most`.
    pub fn duty(&mut self, target: Celsius, measured: Celsius, most: u16) -> u16 {
        // The first reading has none before it, and so no rise.
        let rise = kelvin(measured.saturating_sub(self.last.unwrap_or(measured))).saturating_mul_int(RATE);
        self.rate = self.rate.saturating_add(rise.saturating_sub(self.rate) >> SMOOTHING);
        self.last = Some(measured);
        let error = target.saturating_sub(measured);
        if error > RANGE {
            self.integral = I12F20::ZERO;
            return most;
        }
        if error < -RANGE {
            self.integral = I12F20::ZERO;
            return 0;
        }
        let error = kelvin(error);
        let now = by(error, self.gains.p).saturating_add(self.integral).saturating_sub(by(self.rate, self.gains.d));
        let step = by(error, self.gains.i) / RATE;
        // A duty of 65,536 parts has 16 fractional bits, and the number 20.
        let limit = FULL.saturating_mul(I12F20::from_bits(i32::from(most) << 4));
        // The integral still moves away from a limit. Stopped altogether, it would stay where the limit found it.
        let is_beyond = (now >= limit && step > I12F20::ZERO) || (now <= I12F20::ZERO && step < I12F20::ZERO);
        if !is_beyond {
            self.integral = self.integral.saturating_add(step).clamp(I12F20::ZERO, FULL);
        }
        let duty = i64::from(now.clamp(I12F20::ZERO, FULL).to_bits()) * 65_535 / i64::from(FULL.to_bits());
        (duty as u16).min(most)
    }

    /// Resets it.
    pub const fn rest(&mut self) {
        *self = Self::new(self.gains);
    }
}

fn by(value: I12F20, gain: Ratio) -> I12F20 {
    I12F20::from_bits(saturated((i64::from(value.to_bits()) * i64::from(gain.to_bits())) >> Ratio::FRAC_NBITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAINS: settings::Pid = settings::Pid { p: Ratio::lit("22"), i: Ratio::lit("1.08"), d: Ratio::lit("114") };

    fn c(degrees: i32) -> Celsius {
        Celsius::from_num(degrees)
    }

    #[test]
    fn far_below_it_heats_and_far_above_it_does_not() {
        let mut pid = Pid::new(GAINS);
        assert_eq!(pid.duty(c(200), c(20), 65_535), 65_535);
        assert_eq!(pid.duty(c(200), c(20), 30_000), 30_000, "at most what the heater may");
        assert_eq!(Pid::new(GAINS).duty(c(200), c(230), 65_535), 0);
    }

    #[test]
    fn it_does_not_wind_up() {
        let mut pid = Pid::new(GAINS);
        for _ in 0..50_000 {
            pid.duty(c(200), c(191), 65_535);
        }
        // P gives 198 of 255, and I no more than the rest.
        assert!(pid.integral <= I12F20::const_from_int(58), "{}", pid.integral);
        let mut pid = Pid::new(GAINS);
        for _ in 0..50_000 {
            pid.duty(c(200), c(195), 65_535);
        }
        assert!(pid.integral <= FULL);
    }

    #[test]
    fn absurd_gains_give_a_duty_all_the_same() {
        for gain in [Ratio::ZERO, Ratio::MAX] {
            let mut pid = Pid::new(settings::Pid { p: gain, i: gain, d: gain });
            for measured in [-50, 500, 199, 201, 200].map(c) {
                assert!(pid.duty(c(200), measured, 40_000) <= 40_000);
            }
        }
    }
}
