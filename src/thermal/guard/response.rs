//! How far a reading moves when the power moves, against the model: 2 is half as far.
//!
//! A draught changes the power that holds a target, but not this. A wrong heat capacity changes this, but not the power
//! that holds a target. A sensor that reads low changes both.
//!
//! The power moves by its [`Dither`](super::Dither). Over each cycle two sums of heat ([`HeatSums`]) are correlated with
//! it, in two phases: the heat that should move the reading (given, and not lost), and the heat that has moved it. What
//! the control and the filament do is in both.
//!
//! ```text
//!   quarter     0  1  2  3
//!   re          +  +  -  -
//!   im          +  -  -  +
//! ```
//!
//! A reading that drifts adds to `re` only: four times what a quarter gains, which is a sixteenth of the gain of a
//! whole cycle. Phasors of many cycles are averaged, so what does not follow the dither fades.

use super::dither::Phase;
use super::heat_sums::HeatSums;
use crate::units::whole_root;

/// Fractional bits of a [`Ratio`].
pub(super) const BITS: u32 = 8;

/// Bits of a temperature that its sums leave out: a bed of 1 kW and 1 kJ/K adds up to less than 2^30.
pub(super) const FINER: u32 = 6;

/// A ratio with [`BITS`] fractional bits.
pub type Ratio8 = u16;

/// Cycles over which phasors are averaged, of a hotend and of a bed: for what is certain, and for what is quick.
const SLOW: [i32; 2] = [20, 10];
const QUICK: [i32; 2] = [8, 5];

/// Cycles before the averages count.
const FIRST: u8 = 7;
const FIRST_QUICK: u8 = 5;

/// Both sums of a cycle.
#[derive(Clone, Copy, Debug, Default)]
struct Correlated {
    re: i32,
    im: i32,
    sum: i32,
    /// The sum of the cycle before.
    before: i32,
    slow: [i32; 2],
    quick: [i32; 2],
}

impl Correlated {
    const fn new() -> Self {
        Self { re: 0, im: 0, sum: 0, before: 0, slow: [0; 2], quick: [0; 2] }
    }

    fn add(&mut self, value: i32, quarter: u8) {
        self.sum = self.sum.saturating_add(value);
        self.re = self.re.saturating_add(if quarter < 2 { value } else { -value });
        self.im = self.im.saturating_add(if quarter == 1 || quarter == 2 { -value } else { value });
    }

    /// The end of a cycle: its phasor counts among `cycles` if it is one that has a cycle before it.
    fn end(&mut self, counts: bool, cycles: i32, is_quick: bool) {
        if counts {
            let drift = self.sum.saturating_sub(self.before) / 4;
            let phasor = [self.re.saturating_add(drift), self.im];
            for (averages, most) in [(&mut self.slow, SLOW), (&mut self.quick, QUICK)] {
                let over = cycles.clamp(1, most[usize::from(!is_quick)]);
                for (average, part) in averages.iter_mut().zip(phasor) {
                    *average = average.saturating_add(part.saturating_sub(*average) / over);
                }
            }
        }
        (self.re, self.im, self.before, self.sum) = (0, 0, self.sum, 0);
    }
}

/// The response of a heater that holds a target.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    given: Correlated,
    moved: Correlated,
    /// Cycles that count; the first one of a hold is only the one before the next.
    cycles: u8,
    has_before: bool,
}

impl Default for Response {
    fn default() -> Self {
        Self::new()
    }
}

impl Response {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { given: Correlated::new(), moved: Correlated::new(), cycles: 0, has_before: false }
    }

    /// Follows a control period.
    pub fn follow(&mut self, sums: &HeatSums, phase: Phase) {
        let given = sums.given.saturating_sub(sums.lost);
        self.given.add(given.to_bits() >> FINER, phase.quarter);
        self.moved.add(sums.moved.to_bits() >> FINER, phase.quarter);
    }

    /// The end of a cycle, which counts if it was quiet and had its dither.
    pub fn end(&mut self, counts: bool, is_quick: bool) {
        let counts = counts && core::mem::replace(&mut self.has_before, true);
        self.cycles = self.cycles.saturating_add(u8::from(counts));
        let cycles = self.cycles.into();
        self.given.end(counts, cycles, is_quick);
        self.moved.end(counts, cycles, is_quick);
    }

    /// How many times less it moves than its model: the certain and the quick answer.
    #[must_use]
    pub fn less(&self) -> [Option<Ratio8>; 2] {
        let (given, moved) = (&self.given, &self.moved);
        [(given.slow, moved.slow, FIRST), (given.quick, moved.quick, FIRST_QUICK)].map(|(given, moved, first)| {
            if self.cycles < first {
                return None;
            }
            let less = (magnitude(given) << BITS) / magnitude(moved).max(1);
            Some(Ratio8::try_from(less).unwrap_or(Ratio8::MAX))
        })
    }
}

fn magnitude(phasor: [i32; 2]) -> u64 {
    let [re, im] = phasor.map(|part| u64::from(part.unsigned_abs()));
    whole_root(re * re + im * im)
}
