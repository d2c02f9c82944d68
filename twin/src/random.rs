//! Random numbers that are the same on every platform and in every version: the key stream of ChaCha20.
//!
//! The drawing algorithms are written out here, because a library may change its shuffle from version to version.

use chacha20::ChaCha20Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// A stream of random numbers.
#[derive(Debug)]
pub struct Random(ChaCha20Rng);

impl Random {
    /// The stream of this number: its key is the seed (little-endian, then zeros), its nonce the number.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut key = [0; 32];
        for (byte, of_seed) in key.iter_mut().zip(seed.to_le_bytes()) {
            *byte = of_seed;
        }
        let mut generator = ChaCha20Rng::from_seed(key);
        generator.set_stream(stream);
        Self(generator)
    }

    /// From 0 to below 1, in steps of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From 0 to below `end`, all equally likely: numbers beyond the last whole multiple of `end` are drawn again.
    fn below(&mut self, end: u64) -> u64 {
        let beyond = u64::MAX - u64::MAX % end.max(1);
        loop {
            let drawn = self.0.next_u64();
            if drawn < beyond {
                return drawn % end.max(1);
            }
        }
    }

    /// The numbers from 0 to below `count`, in random order (Fisher and Yates).
    pub fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            let other = self.below(last as u64 + 1) as usize;
            order.swap(last, other);
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bernstein's ChaCha20 with a key and a nonce of zeros begins with 76 b8 e0 ad a0 f1 3d 90 (RFC 8439, appendix
    /// A.1, test vector 1).
    #[test]
    fn the_stream_is_chacha20() {
        assert_eq!(Random::new(0, 0).0.next_u64().to_le_bytes(), [0x76, 0xb8, 0xe0, 0xad, 0xa0, 0xf1, 0x3d, 0x90]);
    }

    #[test]
    fn every_order_of_three_is_as_likely_as_the_others() {
        let mut random = Random::new(1, 2);
        let mut times = [0_u32; 27];
        for _ in 0..6000 {
            let order = random.permutation(3);
            times[9 * order[0] + 3 * order[1] + order[2]] += 1;
        }
        let drawn: Vec<u32> = times.into_iter().filter(|times| *times > 0).collect();
        // 1,000 each, with a standard deviation of 29.
        assert!(drawn.len() == 6 && drawn.iter().all(|times| times.abs_diff(1000) < 4 * 29), "{drawn:?}");
    }
}
