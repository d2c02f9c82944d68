//! The scrub: settings in RAM are summed up when they come, and looked at every second. A bit that flips by itself must not raise
//! a limit.

use core::hash::{Hash, Hasher};

/// The sum of a value: FNV-1a, to which every flipped bit makes a difference.
#[must_use]
pub fn sum(value: &impl Hash) -> u32 {
    let mut sum = Sum(0x811C_9DC5);
    value.hash(&mut sum);
    sum.0
}

/// FNV-1a with 32 bits (RFC 9923).
struct Sum(u32);

impl Hasher for Sum {
    fn finish(&self) -> u64 {
        self.0.into()
    }

    fn write(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |sum, byte| (sum ^ u32::from(*byte)).wrapping_mul(0x0100_0193));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ThermalSettings;

    #[test]
    fn every_change_shows() {
        let settings = ThermalSettings::prototype();
        let whole = sum(&settings);
        assert_eq!(whole, sum(&ThermalSettings::prototype()));
        for bit in 0..32 {
            let mut damaged = settings;
            let most = &mut damaged.heaters.hotend.most;
            *most = crate::units::Celsius::from_bits(most.to_bits() ^ 1 << bit);
            assert_ne!(sum(&damaged), whole);
        }
        assert_eq!(sum(&()), 0x811C_9DC5);
    }
}
