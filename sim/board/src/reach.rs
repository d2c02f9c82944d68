//! Reach: no step of a homed axis leads beyond the ends of the axis, in the coordinates of the program.
//!
//! The rule has a law of its own. The firmware says which axes it takes to be homed, and what it calls a place (its
//! position less the steps it has made). The steps that were really made, the mechanism and the ends of the axes give
//! the place of the tool. It may be beyond an end, where a switch sits or where it was when the axis was homed; from
//! there it may only come in.
//!
//! - x and y hold to a step.
//! - An axis may go on to its switch, in a move that the switch ends: M915 meets it to see how far motors have skipped.
//! - z may go below its axis in a touch: `TOUCH`. The touch that homes it is held to a bed that is known, too.
//! - A mesh lowers z by its deepest point, and offsets by their sum. Both are inputs.
//! - With soft endstops off (M211 S0) or other ends or steps than the machine was made with (M92, settings in storage)
//!   the rule ends ([`Status::is_free`](corehbot::status::Status::is_free)). Nothing is known while motors are grouped
//!   otherwise: z is no height then.
//!
//! It looks at the end of each turn of the world, a millisecond or 128 events apart. No axis goes out and comes back
//! within that.

use crate::axis_sums::AxisSums;
use crate::counts::Counts;
use corehbot::motors::EndstopSet;
use corehbot::settings::{AxisEnd, HomedAxis, Settings};
use corehbot::status::Known;

/// A touch is given up 2 mm below the place where the probe should have triggered (docs/explanation/probing.md).
const TOUCH: f64 = 2.0;

/// Rounding, and the way on after an endstop, in mm.
const SLACK: f64 = 0.05;

/// Offsets of the first layer that are kept move the upper end of z by at most 2 mm each (M290).
const TOP: f64 = 2.0;

/// The switch of each axis.
const SWITCHES: [EndstopSet; 3] = [EndstopSet::X, EndstopSet::Y, EndstopSet::Z];

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
    /// The end at which the switch of each axis sits.
    switches: [AxisEnd; 3],
    /// Where each axis may go on to at either end, at the last look: to its place then, if that was beyond the end.
    within: [Option<[f64; 2]>; 3],
    /// The offset of z at the last look, if z was beyond an end.
    offset: Option<f64>,
    is_over: bool,
    found: Option<Beyond>,
}

impl Reach {
    /// The rule for a machine with these settings.
    #[must_use]
    pub fn new(s: &Settings) -> Self {
        let axes = AxisSums::new(&s.mechanism);
        let over = axes.over();
        let steps = [s.axes.x, s.axes.y, s.axes.z].map(|axis| axis.steps_per_mm.to_num::<f64>());
        let units = std::array::from_fn(|axis| 1.0 / (over[axis] as f64 * steps[axis]));
        let ends =
            HomedAxis::ALL.map(|axis| s.reach(axis)).map(|reach| [reach.least, reach.most].map(|end| end.to_num()));
        let switches = HomedAxis::ALL.map(|axis| s.endstops.of(axis).end);
        Self { axes, units, ends, switches, within: [None; 3], offset: None, is_over: over.contains(&0), found: None }
    }

    /// The motors, grouped as in a print, are at these counts by the firmware's names, in a move that `watched` ends.
    /// `offset` is by how much z may be lower or higher for a mesh that it follows, and for its shifts, in mm; it is
    /// asked beyond an end alone. Returns the first axis that went beyond its end.
    pub fn look(
        &mut self,
        tick: u64,
        known: Known,
        watched: EndstopSet,
        counts: &Counts,
        offset: impl Fn() -> f64,
    ) -> Option<Beyond> {
        if self.is_over {
            return self.found;
        }
        let sums = self.axes.at(counts);
        for axis in 0..3 {
            let at = sums[axis] as f64 * self.units[axis];
            let Some([mut least, mut most]) = self.ends_of(axis, known) else {
                self.within[axis] = None;
                continue;
            };
            // A shift goes on from where z was: after a touch it comes before the first move by the new name.
            let (mut shift, mut shifted) = (0.0, 0.0);
            if axis == 2 {
                let offset = (!(least..=most).contains(&at)).then(&offset);
                if let Some(offset) = offset {
                    (least, most) = (least - offset, most + TOP + offset);
                    (shift, shifted) = (offset, offset - self.offset.unwrap_or(0.0));
                }
                self.offset = offset;
            }
            if watched.has(SWITCHES[axis]) {
                match self.switches[axis] {
                    AxisEnd::Min => least = f64::NEG_INFINITY,
                    AxisEnd::Max => most = f64::INFINITY,
                }
            }
            let [low, high] = self.within[axis].unwrap_or([at; 2]);
            let (low, high) = ((low - shifted).min(least), (high + shifted).max(most));
            let end = if at < low - SLACK { Some(least) } else { (at > high + SLACK).then_some(most) };
            if let Some(end) = end.filter(|_| self.found.is_none()) {
                self.found = Some(Beyond { axis: char::from(b"XYZ"[axis]), at, end, tick });
            }
            // Slow ways out add up.
            self.within[axis] = Some([
                if at < least { low.max(at - shift) } else { at },
                if at > most { high.min(at + shift) } else { at },
            ]);
        }
        self.found
    }

    /// The ends of an axis, as far as its place is known.
    fn ends_of(&self, axis: usize, known: Known) -> Option<[f64; 2]> {
        let [least, most] = self.ends[axis];
        let below = f64::from(known.below_um) / 1000.0;
        match (axis, known.homed[axis]) {
            (2, is_homed) if known.touches => Some([-below - TOUCH, if is_homed { most } else { f64::INFINITY }]),
            (2, true) => Some([least - below, most + below]),
            (_, is_homed) => is_homed.then_some([least, most]),
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
        (Reach::new(&s), counts)
    }

    /// The axis that is found on a way through these places.
    fn found(known: Known, way: &[[f64; 3]]) -> Option<char> {
        found_in(known, &way.iter().map(|at| (EndstopSet::NONE, *at)).collect::<Vec<_>>())
    }

    /// The same in moves that these switches end.
    fn found_in(known: Known, way: &[(EndstopSet, [f64; 3])]) -> Option<char> {
        let (mut rule, counts) = rule();
        let mut looks = way.iter().zip(0..);
        let beyond = looks.find_map(|((watched, at), tick)| rule.look(tick, known, *watched, &counts(*at), || 0.0));
        beyond.map(|beyond| beyond.axis)
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

    /// Motors have skipped, so the switch of x is 0.3 mm beyond its place, by the firmware's names.
    #[test]
    fn an_axis_goes_beyond_its_end_to_meet_its_own_switch_there_and_comes_back() {
        use EndstopSet as Switch;
        let at = |x: f64| [x, 5.0, 5.0];
        assert_eq!(found_in(HOMED, &[(Switch::NONE, at(5.0)), (Switch::X, at(-0.3)), (Switch::NONE, at(4.7))]), None);
        // From there, by another switch, at the other end, and another time, it may not.
        for way in [
            [(Switch::X, at(-0.3)), (Switch::NONE, at(-0.4))],
            [(Switch::Y, at(5.0)), (Switch::Y, at(-0.3))],
            [(Switch::X, at(389.0)), (Switch::X, at(390.3))],
        ] {
            assert_eq!(found_in(HOMED, &way), Some('X'), "{way:?}");
        }
        let again = [(Switch::X, at(-0.3)), (Switch::NONE, at(4.7)), (Switch::NONE, at(-0.3))];
        assert_eq!(found_in(HOMED, &again), Some('X'));
    }

    #[test]
    fn a_touch_goes_down_to_its_floor() {
        let touch = Known { touches: true, ..HOMED };
        let down = |z: f64| [[100.0, 100.0, 5.0], [100.0, 100.0, z]];
        assert_eq!([found(touch, &down(-2.0)), found(touch, &down(-2.2))], [None, Some('Z')]);
        assert_eq!(found(HOMED, &down(-2.0)), Some('Z'));
        assert_eq!(found(Known { below_um: 500, ..HOMED }, &down(-0.5)), None);
        // Of a probe that triggers 3 mm above 0, or below it.
        for (below_um, floor) in [(-3000, 1.0), (3000, -5.0)] {
            let touch = Known { below_um, ..touch };
            assert_eq!([found(touch, &down(floor)), found(touch, &down(floor - 0.2))], [None, Some('Z')]);
        }
        // It rises again.
        let (mut rule, counts) = rule();
        for (known, z) in [(touch, 5.0), (touch, -1.5), (HOMED, -1.5), (HOMED, -0.5), (HOMED, 5.0)] {
            assert_eq!(rule.look(0, known, EndstopSet::PROBE, &counts([100.0, 100.0, z]), || 0.0), None, "{z}");
        }
    }

    /// Z is homed, and has its old name until the next move.
    #[test]
    fn a_shift_goes_on_from_where_z_was() {
        let way = [(-5.75, 0.0), (-5.95, 0.2), (-5.9, 0.2)];
        let beyond = |way: &[(f64, f64)]| {
            let (mut rule, counts) = rule();
            let mut looks = way.iter().map(|(z, offset)| (counts([100.0, 100.0, *z]), *offset));
            looks.find_map(|(counts, offset)| rule.look(0, HOMED, EndstopSet::NONE, &counts, || offset))
        };
        assert_eq!(beyond(&way), None);
        let farther = [way.as_slice(), &[(-6.1, 0.2)]].concat();
        assert_eq!(beyond(&farther).map(|beyond| beyond.axis), Some('Z'));
    }

    /// The height that z had by another name, before it is homed.
    #[test]
    fn a_touch_that_homes_z_goes_down_to_the_floor_of_a_known_bed() {
        let homes = Known { homed: [true, true, false], touches: true, below_um: 120_000 };
        let down = |z: f64| [[100.0, 100.0, -100.0], [100.0, 100.0, z]];
        assert_eq!([found(homes, &down(-122.0)), found(homes, &down(-122.2))], [None, Some('Z')]);
        assert_eq!(found(Known { touches: false, ..homes }, &down(-400.0)), None);
    }
}
