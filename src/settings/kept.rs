//! Kept: a value in RAM with a checksum that shows changes by itself. A bit that flips by itself must not raise a
//! limit, or stretch a millimetre.

use core::hash::{Hash, Hasher};
use core::ops::{Deref, DerefMut};

/// The sum of a value: FNV-1a, to which every flipped bit makes a difference.
#[must_use]
pub fn sum(value: &impl Hash) -> u32 {
    let mut sum = Sum(0x811C_9DC5);
    value.hash(&mut sum);
    sum.finish() as u32
}

/// FNV-1a with 32 bits (RFC 9923), over words where a value has words. Each step can be undone, like a step over a
/// byte, so no difference is lost, in a quarter of the time.
struct Sum(u32);

impl Sum {
    const fn take(&mut self, word: u32) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0193);
    }
}

impl Hasher for Sum {
    fn finish(&self) -> u64 {
        self.0.into()
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.take((*byte).into()));
    }

    fn write_u16(&mut self, word: u16) {
        self.take(word.into());
    }

    fn write_u32(&mut self, word: u32) {
        self.take(word);
    }

    fn write_u64(&mut self, words: u64) {
        self.take(words as u32);
        self.take((words >> 32) as u32);
    }

    /// Which variant of an enum it is.
    fn write_usize(&mut self, number: usize) {
        self.write_u64(number as u64);
    }
}

/// A value with its sum. All changes go through `DerefMut`: it checks the old value once more, and
/// [`settle`](Self::settle) computes the sum of the new one.
#[derive(Clone, Copy, Debug)]
pub struct Kept<T> {
    value: T,
    sum: u32,
    /// It was changed, and its sum is not computed yet.
    is_new: bool,
    /// It had changed by itself before an intended change.
    was_damaged: bool,
}

impl<T: Hash> Kept<T> {
    /// A value that is right.
    #[must_use]
    pub fn new(value: T) -> Self {
        let sum = sum(&value);
        Self { value, sum, is_new: false, was_damaged: false }
    }

    /// Accepts the changed value as it is now.
    pub fn settle(&mut self) {
        if self.is_new {
            self.is_new = false;
            self.sum = sum(&self.value);
        }
    }

    /// Whether it is unchanged. Inlined, the sum would be in each place that changes a setting.
    #[must_use]
    #[inline(never)]
    pub fn is_whole(&self) -> bool {
        !self.was_damaged && (self.is_new || sum(&self.value) == self.sum)
    }

    /// The value, for a change that leaves its sum as it is.
    #[cfg(test)]
    pub const fn damage(&mut self) -> &mut T {
        &mut self.value
    }
}

impl<T> Deref for Kept<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: Hash> DerefMut for Kept<T> {
    #[inline(never)]
    fn deref_mut(&mut self) -> &mut T {
        if !self.is_new {
            // So that the new sum does not hide earlier damage.
            self.was_damaged |= !self.is_whole();
            self.is_new = true;
        }
        &mut self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{Settings, ShaperKind, ThermalSettings};
    use crate::units::{Celsius, StepsPerMm};

    #[test]
    fn every_change_shows() {
        let settings = ThermalSettings::prototype();
        let whole = sum(&settings);
        assert_eq!(whole, sum(&ThermalSettings::prototype()));
        for bit in 0..32 {
            let mut damaged = settings;
            let most = &mut damaged.heaters.hotend.most;
            *most = Celsius::from_bits(most.to_bits() ^ 1 << bit);
            assert_ne!(sum(&damaged), whole);
        }
        assert_eq!(sum(&()), 0x811C_9DC5);
    }

    /// The number of these words, each a bit flipped in `whole`, that have another sum.
    fn noticed<T: Hash>(whole: &T, flipped: impl Iterator<Item = T>) -> usize {
        flipped.filter(|word| sum(word) != sum(whole)).count()
    }

    #[test]
    fn a_flipped_bit_shows_in_words_of_every_size() {
        assert_eq!(noticed(&0, (0..8).map(|bit| 1_u8 << bit)), 8);
        assert_eq!(noticed(&0, (0..16).map(|bit| 1_u16 << bit)), 16);
        assert_eq!(noticed(&0, (0..32).map(|bit| 1_u32 << bit)), 32);
        assert_eq!(noticed(&0, (0..64).map(|bit| 1_u64 << bit)), 64);
        assert_eq!(noticed(&0, (0..usize::BITS).map(|bit| 1_usize << bit)), usize::BITS as usize);
        assert_eq!(noticed(&0, (0..128).map(|bit| 1_i128 << bit)), 128);
        assert_eq!(noticed(&ShaperKind::None, ShaperKind::all()), ShaperKind::all().count() - 1);
    }

    fn flip(settings: &mut Settings, bit: u32) {
        let resolution = &mut settings.axes.z.steps_per_mm;
        *resolution = StepsPerMm::from_bits(resolution.to_bits() ^ 1 << bit);
    }

    #[test]
    fn f40_what_changes_by_itself_is_found_and_what_is_changed_is_not() {
        for bit in 0..32 {
            let mut kept = Kept::new(Settings::prototype());
            assert!(kept.is_whole());
            flip(&mut kept, bit);
            assert!(kept.is_whole(), "somebody changed it");
            kept.settle();
            assert!(kept.is_whole());
            flip(kept.damage(), bit);
            assert!(!kept.is_whole());
            // A legal change does not make it right.
            kept.keepalive_s = 7;
            kept.settle();
            assert!(!kept.is_whole());
        }
    }
}
