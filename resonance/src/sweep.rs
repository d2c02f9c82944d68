//! Sweep: the acceleration that a resonance test commands.
//!
//! Klipper, `resonance_tester.py`: a half period of the frequency f is a pulse of the acceleration `a f` and one
//! against it, each a quarter period long. Then f grows, and the next half period goes the other way. Since December
//! 2024 a slow swing is added, so that the tool does not rest in one place of its guides. The frequency of the response
//! does not depend on the amplitude, so the defaults serve for other amplitudes too.

use crate::recording::Recording;
use std::f64::consts::SQRT_2;

/// A sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// First frequency.
    pub from_hz: f64,
    /// Last frequency.
    pub to_hz: f64,
    /// Acceleration over frequency, in mm/s^2 per Hz.
    pub accel_per_hz: f64,
    /// Growth of the frequency, in Hz per s.
    pub hz_per_s: f64,
    /// Acceleration of the slow swing, in mm/s^2; 0 is none.
    pub swing_accel: f64,
    /// Period of the slow swing in s.
    pub swing_period_s: f64,
    /// Half periods are so many mm long, or a multiple of it, because the machine's steps are; 0 if they need not.
    pub resolution_mm: f64,
}

impl Default for Sweep {
    /// Klipper's defaults for x and y.
    fn default() -> Self {
        Self {
            from_hz: 5.0,
            to_hz: 135.0,
            accel_per_hz: 60.0,
            hz_per_s: 1.0,
            swing_accel: 400.0,
            swing_period_s: 1.2,
            resolution_mm: 0.0,
        }
    }
}

/// A time of constant acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Its end, from the begin of the sweep.
    pub end_s: f64,
    /// Its acceleration in mm/s^2.
    pub accel: f64,
}

/// A half period: a pulse and one against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Half {
    /// Frequency.
    pub hz: f64,
    /// 1 or -1.
    pub sign: f64,
    /// Acceleration of its first pulse without the sign, in mm/s^2.
    pub accel: f64,
}

impl Half {
    /// Its length: from rest to rest with its acceleration.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.accel / (16.0 * self.hz * self.hz)
    }
}

impl Sweep {
    /// All half periods.
    pub fn halves(&self) -> impl Iterator<Item = Half> {
        let sweep = *self;
        let next = move |half: &Half| {
            let hz = half.hz + sweep.hz_per_s / (2.0 * half.hz);
            (hz <= sweep.to_hz + 1e-6).then(|| Half { hz, sign: -half.sign, accel: sweep.accel(hz) })
        };
        std::iter::successors(Some(Half { hz: sweep.from_hz, sign: 1.0, accel: sweep.accel(sweep.from_hz) }), next)
    }

    /// Acceleration at a frequency: in proportion to it, or less for a length of whole steps.
    fn accel(&self, hz: f64) -> f64 {
        let wanted = self.accel_per_hz * hz;
        if self.resolution_mm <= 0.0 {
            return wanted;
        }
        let step = 16.0 * hz * hz * self.resolution_mm;
        step * (wanted / step + 1e-9).floor().max(1.0)
    }

    /// All segments.
    #[must_use]
    pub fn segments(&self) -> Vec<Segment> {
        let mut segments = Vec::new();
        let (mut now, mut swing) = (0.0, Swing::new(self));
        for Half { hz, sign, accel: pulse } in self.halves() {
            for direction in [sign, -sign] {
                let end = now + 0.25 / hz;
                let accel = direction * pulse;
                while swing.turn_s <= end {
                    segments.push(Segment { end_s: swing.turn_s, accel: accel + swing.accel });
                    swing.turn();
                }
                segments.push(Segment { end_s: end, accel: accel + swing.accel });
                now = end;
            }
        }
        segments
    }

    /// The commanded acceleration as a sensor of this rate would see it, if the machine were rigid: the mean over each
    /// sample.
    #[must_use]
    pub fn recording(&self, rate_hz: f64) -> Recording {
        let (mut samples, mut now, mut sum) = (Vec::new(), 0.0, 0.0);
        let mut next = 1.0 / rate_hz;
        for Segment { end_s, accel } in self.segments() {
            while next <= end_s {
                samples.push((sum + accel * (next - now)) * rate_hz);
                (now, sum) = (next, 0.0);
                next = (samples.len() + 1) as f64 / rate_hz;
            }
            sum += accel * (end_s - now);
            now = end_s;
        }
        let still = vec![0.0; samples.len()];
        Recording { rate_hz, axes: [samples, still.clone(), still], remarks: Vec::new() }
    }

    /// How long it lasts.
    #[must_use]
    pub fn lasts_s(&self) -> f64 {
        self.halves().map(|half| 0.5 / half.hz).sum()
    }
}

/// The slow swing: its acceleration turns, so that the tool comes back to the middle of the swing.
struct Swing {
    period_s: f64,
    /// The part of a period until the turn after the next.
    part: f64,
    turn_s: f64,
    accel: f64,
}

impl Swing {
    fn new(sweep: &Sweep) -> Self {
        let is_on = sweep.swing_accel > 0.0 && sweep.swing_period_s > 0.0;
        let first = SQRT_2 / 8.0;
        Self {
            period_s: sweep.swing_period_s,
            part: first + 0.25,
            turn_s: if is_on { first * sweep.swing_period_s } else { f64::INFINITY },
            accel: if is_on { sweep.swing_accel } else { 0.0 },
        }
    }

    fn turn(&mut self) {
        self.turn_s += self.part * self.period_s;
        self.part = 0.5;
        self.accel = -self.accel;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peak of speed and of acceleration, and the ends of the way.
    fn extremes(sweep: &Sweep) -> ([f64; 2], [f64; 2]) {
        let (mut now, mut v, mut x) = (0.0, 0.0, 0.0);
        let (mut peaks, mut way) = ([0.0_f64; 2], [0.0_f64; 2]);
        for Segment { end_s, accel } in sweep.segments() {
            let t = end_s - now;
            x += v * t + accel * t * t / 2.0;
            v += accel * t;
            now = end_s;
            peaks = [peaks[0].max(f64::abs(v)), peaks[1].max(accel.abs())];
            way = [way[0].min(x), way[1].max(x)];
        }
        (peaks, way)
    }

    /// Simulated with Klipper's own code.
    #[test]
    fn the_default_sweep_is_klippers() {
        let sweep = Sweep::default();
        let segments = sweep.segments();
        assert_eq!(segments.len(), 36_615);
        assert!((segments.last().unwrap().end_s - 130.002).abs() < 0.001 && (sweep.lasts_s() - 130.002).abs() < 0.001);
        let ([v, a], [left, right]) = extremes(&sweep);
        assert!((v / 134.99 - 1.0).abs() < 1e-3 && (a / 8500.0 - 1.0).abs() < 1e-3, "{v} {a}");
        assert!((left / -17.78 - 1.0).abs() < 1e-3 && (right / 18.58 - 1.0).abs() < 1e-3, "{left} {right}");
    }

    #[test]
    fn a_weaker_sweep_moves_as_far_as_was_simulated_elsewhere() {
        let weak = Sweep { accel_per_hz: 34.0, ..Sweep::default() };
        for (sweep, v, a, [left, right]) in [
            (weak, 128.5, 4990.0, [-17.9, 18.3]),
            (Sweep { swing_accel: 200.0, ..weak }, 68.5, 4790.0, [-8.9, 9.3]),
            (Sweep { swing_accel: 0.0, ..weak }, 8.5, 4590.0, [0.0, 0.43]),
        ] {
            let (peaks, way) = extremes(&sweep);
            assert!((peaks[0] / v - 1.0).abs() < 2e-3 && (peaks[1] / a - 1.0).abs() < 1e-3, "{peaks:?}");
            assert!((way[0] - left).abs() < 0.06 && (way[1] - right).abs() < 0.06, "{way:?}");
        }
    }

    #[test]
    fn lengths_of_whole_steps_have_the_frequencies_of_the_sweep() {
        let sweep = Sweep { accel_per_hz: 34.0, resolution_mm: 0.0125, ..Sweep::default() };
        for (half, free) in sweep.halves().zip(Sweep { resolution_mm: 0.0, ..sweep }.halves()) {
            let steps = half.length_mm() / 0.0125;
            assert!((steps - steps.round()).abs() < 1e-6 && steps > 0.5 && half.hz == free.hz, "{half:?}");
            assert!(half.accel <= free.accel * 1.000_001 && half.accel > 0.5 * free.accel, "{half:?}");
        }
    }

    #[test]
    fn samples_are_means_of_the_commanded_acceleration() {
        let sweep = Sweep { to_hz: 20.0, ..Sweep::default() };
        let samples = sweep.recording(3200.0);
        assert!((samples.axes[0].len() as f64 / 3200.0 - sweep.lasts_s()).abs() < 0.001);
        let (mut now, mut integral) = (0.0, 0.0);
        for segment in sweep.segments() {
            integral += segment.accel.abs() * (segment.end_s - now);
            now = segment.end_s;
        }
        let sampled: f64 = samples.axes[0].iter().map(|a| a.abs() / 3200.0).sum();
        assert!((sampled / integral - 1.0).abs() < 0.01, "{sampled} {integral}");
    }
}
