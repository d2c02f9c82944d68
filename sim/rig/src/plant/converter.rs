//! The converter: 16 noisy conversions of 12 bits, added up to a reading in 1/65,536 of the reference.

use super::constants::ConverterConstants;

/// Conversions in a reading: 16 of 12 bits fill 16 bits.
const CONVERSIONS: u16 = 16;
/// Steps of 12 bits.
const STEPS: f64 = 4096.0;

/// One channel of it, with its own noise: a channel's readings do not depend on how often another is read.
pub(super) struct Channel {
    noise_lsb: f64,
    state: u64,
}

impl Channel {
    pub(super) const fn new(constants: &ConverterConstants, number: u64) -> Self {
        // The generator's own mixing makes unlike streams of neighbouring seeds.
        Self { noise_lsb: constants.noise_lsb, state: constants.seed.wrapping_add(number << 32) }
    }

    /// A reading of `share`, 0..=1 of the reference. Steps change halfway between two codes (AN2834: the ideal first
    /// transition is at half a step), so rounding is right; full scale is 16 x 4095.
    pub(super) fn read(&mut self, share: f64) -> u16 {
        (0..CONVERSIONS).map(|_| self.convert(share)).sum()
    }

    /// A single conversion, 0 to 4095.
    pub(super) fn convert(&mut self, share: f64) -> u16 {
        let steps = libm::floor(share * STEPS + self.noise() + 0.5);
        steps.clamp(0.0, STEPS - 1.0) as u16
    }

    /// Nearly Gaussian: the sum of four uniform numbers of 16 bits has standard deviation 65,536 / sqrt(3).
    fn noise(&mut self) -> f64 {
        let bits = self.random();
        let sum: u32 = [0, 16, 32, 48].into_iter().map(|at| (bits >> at) as u32 & 0xffff).sum();
        // 1.732... is sqrt(3).
        self.noise_lsb * 1.732_050_807_568_877_2 * ((f64::from(sum) + 2.0) / 65_536.0 - 2.0)
    }

    /// SplitMix64 (Steele, Lea and Flood, Fast splittable pseudorandom number generators, 2014).
    const fn random(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}
