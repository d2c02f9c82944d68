//! StepScale: between millimetres and steps of one axis.
//!
//! Positions are exact to a bit, because they are compared and written to traces. A distance has 32 bits, independent
//! of its length.

use crate::units::{Mm, Steps, StepsPerMm};

/// Between millimetres and steps of one axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::motion) struct StepScale {
    steps_per_mm: StepsPerMm,
    /// Raw `Mm` bits a raw `Steps` bit, times 2^48.
    mm_per_step: u64,
    /// The same with 32 bits alone, times 2^(32 + `shift`).
    mantissa: u32,
    shift: u8,
}

impl StepScale {
    pub fn new(steps_per_mm: StepsPerMm) -> Self {
        // No axis has less than one step a millimetre.
        let steps_per_mm = steps_per_mm.max(StepsPerMm::ONE);
        let mm_per_step = u64::MAX / u64::from(steps_per_mm.to_bits());
        let shift = mm_per_step.leading_zeros().saturating_sub(16);
        let mantissa = u32::try_from((mm_per_step << shift) >> 16).unwrap_or(u32::MAX);
        Self { steps_per_mm, mm_per_step, mantissa, shift: shift as u8 }
    }

    /// The length of a step in mm.
    #[inline(always)]
    pub fn step(&self) -> f32 {
        // 2^(-32 - shift), with a shift of at most 31.
        self.mantissa as f32 * f32::from_bits((127 - 32 - u32::from(self.shift & 31)) << 23)
    }

    /// The end position in steps of a move that begins at `from`, with `asked` as the commanded position there, and its
    /// distance. An axis with the same target again stays where it is.
    #[inline(always)]
    pub fn end_and_distance(&self, to: Mm, asked: Mm, from: Steps) -> (Steps, Mm) {
        if to == asked {
            return (from, Mm::ZERO);
        }
        let end = self.steps(to);
        (end, self.distance(end.wrapping_sub(from)))
    }

    /// The end position in steps of a move that begins at `from`, with `asked` as the commanded position there.
    #[inline(always)]
    pub fn end(&self, to: Mm, asked: Mm, from: Steps) -> Steps {
        if to == asked { from } else { self.steps(to) }
    }

    /// The position in steps; wraps with the step counters.
    #[inline(always)]
    pub fn steps(&self, mm: Mm) -> Steps {
        mm * self.steps_per_mm
    }

    /// The position in mm of a count of steps that has wrapped with the counters, as often as makes it the nearest to
    /// `near`.
    pub fn mm_near(&self, steps: Steps, near: Mm) -> Mm {
        near.wrapping_add(self.mm(steps.wrapping_sub(self.steps(near))))
    }

    /// A position or distance of `steps`, to the nearest bit.
    #[inline(never)]
    pub fn mm(&self, steps: Steps) -> Mm {
        let wide = i128::from(steps.to_bits()) * i128::from(self.mm_per_step);
        Mm::from_bits(((wide + (1 << 47)) >> 48) as i64)
    }

    /// A distance of `steps`, with 32 right bits.
    #[inline(always)]
    pub fn distance(&self, steps: Steps) -> Mm {
        let bits = steps.to_bits();
        let (high, low) = (i64::from((bits >> 32) as i32), u64::from(bits as u32));
        let mantissa = u64::from(self.mantissa);
        let wide = high * mantissa.cast_signed() + ((low * mantissa) >> 32).cast_signed();
        Mm::from_bits(wide >> (self.shift & 31))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_millimetres_agree() {
        let scale = StepScale::new(StepsPerMm::from_num(80));
        for v in [-417.6, -1.0, 0.0125, 0.3, 390.0] {
            let steps = scale.steps(Mm::from_num(v));
            assert!((steps.to_num::<f64>() - 80.0 * v).abs() < 1e-6);
            assert!((scale.mm(steps) - Mm::from_num(v)).saturating_abs() <= Mm::DELTA);
        }
    }

    #[test]
    fn a_step_has_its_length() {
        for resolution in [1.0, 1.5, 80.0, 93.0, 400.0, 25_600.0] {
            let step = f64::from(StepScale::new(StepsPerMm::from_num(resolution)).step());
            assert!((step * resolution - 1.0).abs() < 1e-6, "{resolution}: {step}");
        }
    }

    #[test]
    fn counts_that_have_wrapped_are_read_beside_what_is_known() {
        for (resolution, known) in [(400.0, 5_368_709.0), (25_600.0, 83_886.07), (25_600.0, 1e9), (1.0, -2e9)] {
            let (scale, near) = (StepScale::new(StepsPerMm::from_num(resolution)), Mm::from_num(known));
            assert_eq!(scale.mm_near(scale.steps(near), near), near);
            for distance in [-150.0, -0.3, 0.01, 0.02, 70.0] {
                let steps = scale.steps(near + Mm::from_num(distance));
                let error = (scale.mm_near(steps, near) - near).to_num::<f64>() - distance;
                assert!(error.abs() < 1e-7, "{known} mm of {resolution} steps and {distance}: off by {error}");
            }
        }
    }

    #[test]
    fn ways_are_right_to_32_bits_at_every_resolution() {
        for resolution in [1.0, 1.5, 80.0, 93.0, 400.0, 25_600.0] {
            let scale = StepScale::new(StepsPerMm::from_num(resolution));
            for v in [-417.6, -1.0, -0.001, 0.0125, 0.3, 390.0] {
                let exact = (v * 2f64.powi(32)).abs();
                let distance = scale.distance(Steps::from_num(v * resolution)).to_bits();
                let error = (distance as f64 - v * 2f64.powi(32)).abs();
                assert!(error <= 1.5 + exact * 5e-10, "{v} mm of {resolution} steps: {distance}, off by {error}");
            }
        }
    }
}
