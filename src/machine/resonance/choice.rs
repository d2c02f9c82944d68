//! Choice: Klipper's, among the shapers that M593 has.
//!
//! Klipper (`shaper_calibrate.py`) tries all frequencies of each shaper, built for a damping of 0.1. The vibration that
//! is left is the shaper's response times the measured one, less a twentieth of its peak, the worst of three dampings.
//! A score joins it with the rounding of corners. `corehbot resonance` has the same law
//! (`resonance/src/klipper.rs`), so both give one answer.

use super::response::Response;
use crate::motion::root;
use crate::settings::{Shaper, ShaperKind};
use crate::units::{Hertz, MmPerSec2, Ratio};
use core::ops::RangeInclusive;

/// The shaper for the modes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Suggested {
    pub shaper: Shaper,
    /// What it leaves of the vibration.
    pub percent: u8,
    /// The acceleration at which it rounds corners by 0.12 mm.
    pub most: MmPerSec2,
}

/// A shaper for [`DAMPING`], at 1 Hz.
struct Row {
    kind: ShaperKind,
    /// The lowest frequency that is tried, in fifths of a Hz.
    lowest: u32,
    /// Times in s and weights of its impulses.
    impulses: [(f32, f32); 4],
    /// Klipper's smoothing in mm at [`ACCELERATION`] and a corner speed of 5 mm/s, where a period lasts 1 s. A turn by
    /// 180 degrees grows with the square of the period. One by 90 has a part of the speed, which grows with the period.
    turn: f32,
    speed: f32,
    corner: f32,
}

/// The shapers, the shortest first: those of `motion::impulses`, as a test checks. Klipper does not choose ZVD.
static ROWS: [Row; 4] = [
    Row {
        kind: ShaperKind::Zv,
        lowest: 105,
        impulses: [(0.0, 0.578_286), (0.502_519, 0.421_714), (0.502_519, 0.0), (0.502_519, 0.0)],
        turn: 153.959,
        speed: 0.8666,
        corner: 125.911,
    },
    Row {
        kind: ShaperKind::Mzv,
        lowest: 115,
        impulses: [(0.0, 0.365_128), (0.376_889, 0.407_489), (0.753_778, 0.227_383), (0.753_778, 0.0)],
        turn: 203.671,
        speed: 0.8390,
        corner: 151.702,
    },
    Row {
        kind: ShaperKind::Ei,
        lowest: 145,
        impulses: [(0.0, 0.354_881), (0.507_240, 0.452_998), (1.005_038, 0.192_121), (1.005_038, 0.0)],
        turn: 329.494,
        speed: 1.0611,
        corner: 241.614,
    },
    Row {
        kind: ShaperKind::TwoHumpEi,
        lowest: 195,
        impulses: [(0.0, 0.258_535), (0.515_906, 0.359_936), (1.008_206, 0.272_764), (1.488_926, 0.108_765)],
        turn: 566.255,
        speed: 1.4099,
        corner: 431.947,
    },
];

/// The end of the frequencies, in fifths of a Hz.
const END: u32 = 750;

/// Damping that shapers are made for. Those that they are tried with, and the part of a frequency that they leave.
const DAMPING: Ratio = Ratio::lit("0.1");
static DAMPINGS: [(f32, f32); 3] = [(0.075, 0.997_184), (0.1, 0.994_987), (0.15, 0.988_686)];

/// Klipper's limit of smoothing in mm, and the acceleration that it reckons with.
const SMOOTHING: f32 = 0.12;
const ACCELERATION: f32 = 5000.0;

/// A shaper, and what it does.
#[derive(Clone, Copy)]
pub(super) struct Chosen {
    row: &'static Row,
    fifths: u32,
    /// Part of the vibration that it leaves.
    left: f32,
    smoothing: f32,
    score: f32,
}

impl Chosen {
    /// Worse than all.
    const NONE: Self =
        Self { row: &ROWS[0], fifths: 0, left: f32::INFINITY, smoothing: f32::INFINITY, score: f32::INFINITY };

    /// The answer about it; what the shaper has besides is as in `base`.
    #[inline(never)]
    pub fn suggested(&self, base: Shaper) -> Suggested {
        let percent = (self.left * 100.0 + 0.5) as u8;
        Suggested { shaper: self.shaper(base), percent, most: self.most_acceleration() }
    }

    fn shaper(&self, base: Shaper) -> Shaper {
        let frequency = Hertz::from_bits(((self.fifths << 16) + 2) / 5);
        Shaper { kind: self.row.kind, frequency, damping: DAMPING, ..base }
    }

    /// The acceleration at which it rounds corners by [`SMOOTHING`].
    fn most_acceleration(&self) -> MmPerSec2 {
        let (row, period) = (self.row, self.period());
        let back = SMOOTHING / (row.turn * period);
        let aside = (SMOOTHING - row.speed * period) / (row.corner * period);
        MmPerSec2::saturating_from_num(if back < aside { back } else { aside } * (ACCELERATION / period))
    }

    fn period(&self) -> f32 {
        5.0 / self.fifths as f32
    }

    const fn is_zv(&self) -> bool {
        matches!(self.row.kind, ShaperKind::Zv)
    }
}

/// A search under way: each step tries one frequency, so that other work goes on.
pub(super) struct Search<'r> {
    response: &'r Response,
    step_hz: f32,
    /// The numbers of its frequencies that count.
    ends: [usize; 2],
    /// What does not count, and the sum of all that does.
    floor: f32,
    whole: f32,
    /// The row, its pass, and the frequencies of it that were tried.
    row: usize,
    pass: u32,
    done: u32,
    /// What the row may leave, and its best.
    may_leave: f32,
    own: Chosen,
    best: Chosen,
    /// The first that leaves less than ZV, if ZV is the best.
    calmer: Chosen,
}

impl<'r> Search<'r> {
    #[inline(never)]
    pub fn new(response: &'r Response, step_hz: f32, ends: &RangeInclusive<usize>) -> Self {
        let ends = [*ends.start(), *ends.end() + 1];
        let mut most = 0.0;
        for number in ends[0]..ends[1] {
            let at = density(response, number);
            most = if at > most { at } else { most };
        }
        let mut new = Self {
            response,
            step_hz,
            ends,
            floor: most / 20.0,
            whole: 1.0,
            row: 0,
            pass: 0,
            done: 0,
            may_leave: 0.0,
            own: Chosen::NONE,
            best: Chosen::NONE,
            calmer: Chosen::NONE,
        };
        // Impulses at the same time change nothing.
        new.whole = new.left(&ROWS[0], 0.0, &DAMPINGS[0]);
        new
    }

    /// Klipper's choice. ZV is taken only if no other leaves less.
    pub const fn found(&self) -> Chosen {
        if self.best.is_zv() && self.calmer.fifths > 0 { self.calmer } else { self.best }
    }

    /// Tries the next frequency: for the least vibration of a kind, then for the least score near it, then for less
    /// vibration and less smoothing than the best of all. Returns whether there was one.
    #[inline(never)]
    pub fn step(&mut self) -> bool {
        let Some(row) = ROWS.get(self.row) else { return false };
        let tried = self.chosen(row, row.lowest + self.done);
        let (is_own, is_best) = match self.pass {
            0 => (tried.left < self.own.left, false),
            1 => (tried.left < self.may_leave && tried.score < self.own.score, false),
            _ => (false, tried.left < self.best.left && tried.smoothing < self.best.smoothing),
        };
        if is_own {
            self.own = tried;
        }
        if is_best {
            self.best = tried;
        }
        self.done += 1;
        if row.lowest + self.done == END {
            self.end_pass();
        }
        true
    }

    fn end_pass(&mut self) {
        let (own, best) = (&self.own, &self.best);
        // By a fifth, or by a twentieth with a tenth less smoothing.
        let is_better = own.score * 1.05 < best.score && own.smoothing * 1.1 < best.smoothing;
        if self.pass == 1 && (is_better || own.score * 1.2 < best.score) {
            self.best = self.own;
        }
        self.may_leave = self.own.left * 1.1 + 0.0005;
        self.done = 0;
        self.pass += 1;
        if self.pass == 3 {
            if self.best.is_zv() && self.calmer.fifths == 0 && self.own.left * 1.1 < self.best.left {
                self.calmer = self.own;
            }
            (self.pass, self.own) = (0, Chosen::NONE);
            self.row += 1;
        }
    }

    fn chosen(&self, row: &'static Row, fifths: u32) -> Chosen {
        let mut chosen = Chosen { row, fifths, left: 0.0, ..Chosen::NONE };
        let period = chosen.period();
        for damping in &DAMPINGS {
            let left = self.left(row, period, damping) / self.whole;
            chosen.left = if left > chosen.left { left } else { chosen.left };
        }
        let (turn, corner) = (row.turn * period, row.speed + row.corner * period);
        chosen.smoothing = period * if turn > corner { turn } else { corner };
        chosen.score = chosen.smoothing * (chosen.left * (root(chosen.left) + 0.2) + 0.01);
        chosen
    }

    /// Vibration that a shaper leaves on a machine of this damping.
    #[inline(never)]
    fn left(&self, row: &Row, period: f32, (damping, part): &(f32, f32)) -> f32 {
        let [.., (last, _)] = row.impulses;
        // Of each impulse: its part at this frequency, and the factor from one frequency to the next.
        let turn = core::f32::consts::TAU * self.step_hz * period;
        let mut all = row.impulses.map(|(time, weight)| {
            let angle = turn * part * time;
            // The last impulse is not damped, the others until then.
            let decay = damping * turn * (last - time);
            let damped = 1.0 - decay * (1.0 - decay / 2.0);
            [weight, 0.0, damped * cosine(angle), damped * sine(angle)]
        });
        let mut after = 0.0;
        for number in 0..self.ends[1] {
            let (mut re, mut im) = (0.0, 0.0);
            for [a, b, c, s] in &mut all {
                re += *a;
                im += *b;
                (*a, *b) = (*a * *c - *b * *s, *a * *s + *b * *c);
            }
            let above = density(self.response, number) * root(re * re + im * im) - self.floor;
            if number >= self.ends[0] && above > 0.0 {
                after += above;
            }
        }
        after
    }
}

/// Klipper's density: a sweep has an acceleration in proportion to the frequency, and it divides the power by it once.
fn density(response: &Response, number: usize) -> f32 {
    number as f32 * response.at(number)
}

/// Cosine and sine of a small angle.
fn cosine(x: f32) -> f32 {
    1.0 - x * x / 2.0 * (1.0 - x * x / 12.0)
}

fn sine(x: f32) -> f32 {
    x * (1.0 - x * x / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::impulses;
    use crate::settings::Settings;

    /// Klipper's own numbers for its choices.
    #[test]
    fn the_acceleration_is_klippers() {
        for (row, hz, most) in [(0, 48.8, 9281.0), (1, 50.2, 7424.0), (1, 81.2, 19_424.0), (1, 44.4, 5807.0)] {
            let chosen = Chosen { row: &ROWS[row], fifths: (5.0 * hz) as u32, ..Chosen::NONE };
            let found: f64 = chosen.most_acceleration().to_num();
            assert!((found / most - 1.0).abs() < 0.005, "{row}: {found}");
        }
    }

    /// The firmware's impulses, and Klipper's smoothing of them.
    #[test]
    fn rows_are_the_firmwares_shapers() {
        for row in &ROWS {
            let hz = 50.0;
            let chosen = Chosen { row, fifths: 250, ..Chosen::NONE };
            let impulses = impulses(&chosen.shaper(Settings::prototype().shapers.x));
            for (i, (time, weight)) in impulses.iter().enumerate() {
                let (known, known_weight) = row.impulses[i];
                assert!((time * hz - known).abs() < 2e-4 && (weight - known_weight).abs() < 2e-4, "{:?}", row.kind);
            }
            assert!(row.impulses.iter().skip(impulses.len()).all(|(_, weight)| *weight == 0.0));
            let mean: f32 = impulses.iter().map(|(time, weight)| time * weight).sum();
            let sum = |of: fn(f32) -> f32| impulses.iter().map(|(t, weight)| weight * of(hz * (t - mean))).sum::<f32>();
            let turn = 2500.0 * sum(|off| off * off);
            let speed = 5.0 * core::f32::consts::SQRT_2 * sum(|off| off.max(0.0));
            let corner = 2500.0 * core::f32::consts::SQRT_2 * sum(|off| off.max(0.0) * off.max(0.0));
            for (found, known) in [(turn, row.turn), (speed, row.speed), (corner, row.corner)] {
                assert!((found / known - 1.0).abs() < 2e-3, "{:?}: {found} {known}", row.kind);
            }
        }
    }
}
