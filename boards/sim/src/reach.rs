//! Reach: no step of a homed axis leads beyond the ends of the axis, in the coordinates of the program.
//!
//! The rule has a law of its own. The firmware says which axes it takes to be homed, and what it calls a place (its
//! position less the steps it has made). The steps that were really made, the mechanism and the ends of the axes give
//! the place of the tool. It may be beyond an end, where a switch sits or where it was when the axis was homed; from
//! there it may only come in.
//!
//! - x and y hold to a step.
//! - z may go below its axis in a touch: [`TOUCH`].
//! - A mesh lowers z by its deepest point, and offsets by their sum. Both are inputs.
//! - With soft endstops off (M211 S0) or other ends or steps than the machine was made with (M92, settings in storage)
//!   the rule ends ([`Status::is_free`](corehbot::status::Status::is_free)). Nothing is known while motors are grouped
//!   otherwise: z is no height then.
//!
//! It looks at the end of each turn of the world, a millisecond or 128 events apart. No axis goes out and comes back
//! within that.

use crate::axis_sums::AxisSums;
use crate::counts::Counts;
use corehbot::settings::{HomedAxis, Settings};
use corehbot::status::Known;

/// A touch is given up 2 mm below the place where the probe should have triggered (docs/explanation/probing.md), which
/// is no lower than z = 0 unless its offset says so.
const TOUCH: f64 = 2.0;

/// Rounding, and the way on after an endstop, in mm.
const SLACK: f64 = 0.05;

/// Offsets of the first layer that are kept move the upper end of z by at most 2 mm each (M290).
const TOP: f64 = 2.0;

/// An axis beyond its end.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Beyond {
    /// Its letter.
    pub axis: char,
    /// Where it is, in mm.
    pub at: f64,
    /// Its end.
    pub end: f64,
    /// When, in ticks of motion time.
    pub tick: u64,
}

impl std::fmt::Display for Beyond {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { axis, at, end, tick } = self;
        write!(f, "at tick {tick}: {axis} is homed and goes to {at:.3}, beyond its end at {end:.3}")
    }
}

/// The rule, for one life of a machine.
pub struct Reach {
    axes: AxisSums,
    /// mm of a unit of the sums.
    units: [f64; 3],
    ends: [[f64; 2]; 3],
    /// How far each axis was beyond each end at the last look, while it was homed.
    outside: [Option<[f64; 2]>; 3],
    is_over: bool,
    found: Option<Beyond>,
    /// Whether an axis beyond its end ends the program when the world ends.
    pub is_strict: bool,
}

impl Reach {
    /// The rule for a machine with these settings.
    #[must_use]
    pub fn new(s: &Settings, is_strict: bool) -> Self {
        let axes = AxisSums::new(&s.mechanism);
        let over = axes.over();
        let steps = [s.axes.x, s.axes.y, s.axes.z].map(|axis| axis.steps_per_mm.to_num::<f64>());
        let units = std::array::from_fn(|axis| 1.0 / (over[axis] as f64 * steps[axis]));
        let ends =
            HomedAxis::ALL.map(|axis| s.reach(axis)).map(|reach| [reach.least, reach.most].map(|end| end.to_num()));
        Self { axes, units, ends, outside: [None; 3], is_over: over.contains(&0), found: None, is_strict }
    }

    /// The motors, grouped as in a print, are at these counts by the firmware's names. `offset` is by how much z may be
    /// lower or higher for a mesh that it follows, and for its shifts, in mm; it is asked beyond an end alone.
    pub fn look(&mut self, tick: u64, known: Known, counts: &Counts, offset: impl Fn() -> f64) {
        if self.is_over {
            return;
        }
        let sums = self.axes.at(counts);
        for (axis, outside) in self.outside.iter_mut().enumerate() {
            if !known.homed[axis] {
                *outside = None;
                continue;
            }
            let at = sums[axis] as f64 * self.units[axis];
            let [mut least, mut most] = self.ends[axis];
            if axis == 2 && !(least..=most).contains(&at) {
                let touch = if known.touches { TOUCH } else { 0.0 };
                let offset = offset() + f64::from(known.below_um) / 1000.0;
                (least, most) = (least - touch - offset, most + TOP + offset);
            }
            let now = [least - at, at - most].map(|beyond| beyond.max(0.0));
            let before = outside.replace(now).unwrap_or(now);
            for (side, end) in [least, most].into_iter().enumerate() {
                if now[side] > before[side] + SLACK && self.found.is_none() {
                    self.found = Some(Beyond { axis: char::from(b"XYZ"[axis]), at, end, tick });
                }
                // Slow ways out add up.
                if now[side] > 0.0 && now[side] > before[side] {
                    outside.get_or_insert(now)[side] = before[side];
                }
            }
        }
    }

    /// The ends do not hold any more.
    pub const fn end(&mut self) {
        self.is_over = true;
    }

    /// The first axis that went beyond its end.
    #[must_use]
    pub const fn found(&self) -> Option<Beyond> {
        self.found
    }
}

impl Drop for Reach {
    fn drop(&mut self) {
        let beyond = self.found.filter(|_| self.is_strict && !std::thread::panicking());
        assert!(beyond.is_none(), "{}", beyond.map(|beyond| beyond.to_string()).unwrap_or_default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::MOTORS;

    const HOMED: Known = Known { homed: [true; 3], touches: false, below_um: 0 };

    /// A Cartesian machine's counts at a place: m1 moves x, m4 y, z1 and z2 z.
    fn rule() -> (Reach, impl Fn([f64; 3]) -> Counts) {
        let s = Settings::prototype();
        let steps = [s.axes.x, s.axes.y, s.axes.z].map(|axis| axis.steps_per_mm.to_num::<f64>());
        let rows = s.mechanism.rows;
        let counts = move |at: [f64; 3]| {
            let mut counts = [0; MOTORS];
            for (count, row) in counts.iter_mut().zip(rows) {
                let sum: f64 = (0..3).map(|axis| f64::from(row[axis]) * at[axis] * steps[axis]).sum();
                *count = sum.round() as i64;
            }
            counts
        };
        (Reach::new(&s, false), counts)
    }

    /// The axis that is found on a way through these places.
    fn found(known: Known, way: &[[f64; 3]]) -> Option<char> {
        let (mut rule, counts) = rule();
        for (tick, at) in way.iter().enumerate() {
            rule.look(tick as u64, known, &counts(*at), || 0.0);
        }
        rule.found().map(|beyond| beyond.axis)
    }

    #[test]
    fn a_step_beyond_an_end_is_found_on_each_side_of_each_axis() {
        assert_eq!(found(HOMED, &[[0.0, 0.0, 0.0], [390.0, 417.6, 335.0], [0.0, 0.0, 0.0]]), None);
        let inside = [100.0, 100.0, 100.0];
        for (axis, letter, ends) in [(0, 'X', [-0.1, 390.1]), (1, 'Y', [-20.0, 417.8]), (2, 'Z', [-0.1, 338.0])] {
            for end in ends {
                let mut beyond = inside;
                beyond[axis] = end;
                assert_eq!(found(HOMED, &[inside, beyond]), Some(letter), "{end}");
                let mut unhomed = HOMED;
                unhomed.homed[axis] = false;
                assert_eq!(found(unhomed, &[inside, beyond]), None);
            }
        }
        // In small parts, too.
        let slowly: Vec<_> = (0..100).map(|part| [f64::from(-part) * 0.01, 5.0, 5.0]).collect();
        assert_eq!(found(HOMED, &slowly), Some('X'));
    }

    #[test]
    fn an_axis_that_is_homed_beyond_its_end_may_come_in() {
        assert_eq!(found(HOMED, &[[-5.0, 5.0, 5.0], [-3.0, 5.0, 5.0], [10.0, 5.0, 5.0], [0.0, 5.0, 5.0]]), None);
        assert_eq!(found(HOMED, &[[-5.0, 5.0, 5.0], [-5.2, 5.0, 5.0]]), Some('X'));
        assert_eq!(found(HOMED, &[[-5.0, 5.0, 5.0], [1.0, 5.0, 5.0], [-4.0, 5.0, 5.0]]), Some('X'));
    }

    #[test]
    fn a_touch_goes_down_to_its_floor() {
        let touch = Known { touches: true, ..HOMED };
        let down = |z: f64| [[100.0, 100.0, 5.0], [100.0, 100.0, z]];
        assert_eq!([found(touch, &down(-2.0)), found(touch, &down(-2.2))], [None, Some('Z')]);
        assert_eq!(found(HOMED, &down(-2.0)), Some('Z'));
        assert_eq!(found(Known { below_um: 500, ..HOMED }, &down(-0.5)), None);
    }
}
