//! An axis of the trajectory: the taps that it follows, and the progress of each.

use super::span::{AxisState, Boundary, ONE, Span};
use super::stiffening::Stiffening;
use super::taps::{TAPS, Tap, Taps};
use crate::motion::number::{from_f32, to_f32};
use crate::settings::Kept;
use crate::units::{Steps, SubTicks};

// A delay has 8 bits of a tick and a time 16, so the product of a delay and a scale is shifted by 22 bits.
const _: () = assert!(ONE == 1 << (22 + 8));

/// Progress of a tap: inside the span of this number, or still before it.
#[derive(Clone, Copy, Debug)]
struct Cursor {
    span: u32,
    is_inside: bool,
}

impl Cursor {
    /// Advances to `time`, as far as spans are laid.
    #[inline(always)]
    fn advance(&mut self, tap: &Tap, late: Lateness, spans: &impl Spans, time: SubTicks) {
        while self.span != spans.laid() {
            let (span, end) = spans.get(self.span);
            if !self.is_inside {
                if time < span.begin.time + late.of(tap, &span.begin) {
                    break;
                }
                self.is_inside = true;
            }
            if time < end.time + late.of(tap, end) {
                break;
            }
            self.span = self.span.wrapping_add(1);
            // Spans follow each other without a gap, or there was a rest.
            self.is_inside = false;
        }
    }
}

/// The spans as an axis sees them.
pub(super) trait Spans {
    /// Number of spans laid so far.
    fn laid(&self) -> u32;
    /// A span and its end.
    fn get(&self, number: u32) -> (&Span, &Boundary);
    /// End of the last one.
    fn end(&self) -> &Boundary;
}

/// An axis.
pub(super) struct AxisPath {
    index: usize,
    taps: Kept<Taps>,
    cursors: [Cursor; TAPS],
    /// Whether the copies add up to a position. Otherwise only their differences count.
    is_position: bool,
    stiffening: Stiffening,
    lateness: Lateness,
}

/// Delays of an axis's taps.
#[derive(Clone, Copy)]
struct Lateness {
    /// The axis, if its taps do not have equal delays everywhere.
    stiffening: Option<usize>,
    /// Mean delay in ticks times 2^8. Only differences from it are scaled.
    mean: i64,
}

impl Lateness {
    /// Delay of a tap at an end of a span, in ticks times 2^16.
    #[inline]
    fn of(self, tap: &Tap, at: &Boundary) -> SubTicks {
        let Some(axis) = self.stiffening else {
            return tap.late();
        };
        let scale = i64::from(at.scale.get(axis).copied().unwrap_or(ONE));
        let own = ((i64::from(tap.delay) - self.mean) * scale) >> 22;
        SubTicks(((self.mean << 8) + own).max(0) as u64)
    }
}

impl AxisPath {
    /// An axis that follows the spans without delay.
    pub fn new(index: usize) -> Self {
        Self {
            index,
            taps: Kept::new(Taps::new()),
            cursors: [Cursor { span: 0, is_inside: false }; TAPS],
            is_position: true,
            stiffening: Stiffening::NONE,
            lateness: Lateness { stiffening: None, mean: 0 },
        }
    }

    /// Follows other taps from now on; the axis is at rest.
    pub fn follow(&mut self, taps: &[Tap], is_position: bool) {
        self.taps = Kept::new(taps.iter().copied().take(TAPS).collect());
        self.is_position = is_position;
        self.update_lateness();
    }

    /// Whether its taps are unchanged in memory.
    pub fn is_whole(&self) -> bool {
        self.taps.is_whole()
    }

    /// A tap, which must not be changed.
    #[cfg(test)]
    pub fn damage(&mut self) -> Option<&mut Tap> {
        self.taps.damage().first_mut()
    }

    /// Sets its stiffening from now on; the axis is at rest.
    pub fn stiffen(&mut self, stiffening: Stiffening) {
        self.stiffening = stiffening;
        self.update_lateness();
    }

    /// Computes the delays of its taps.
    fn update_lateness(&mut self) {
        let first = self.taps.first().map_or(0, |tap| tap.delay);
        let mean_beyond_first: f32 =
            self.taps.iter().map(|tap| tap.weight * (tap.delay.wrapping_sub(first) as f32)).sum();
        let is_stiffening = self.stiffening.rate > 0.0 && self.taps.len() > 1;
        self.lateness = Lateness {
            stiffening: is_stiffening.then_some(self.index),
            mean: i64::from(first) + i64::from(mean_beyond_first as i32),
        };
    }

    /// Scale of its taps at a position. From the scale at `before` it changes so slowly within `time` that no tap runs
    /// more than a quarter faster or slower.
    pub fn scale(&self, at: Steps, before: Option<(u32, SubTicks)>) -> u32 {
        if self.lateness.stiffening.is_none() {
            return ONE;
        }
        let scale = self.stiffening.scale(at);
        let Some((before, time)) = before else { return scale };
        let farthest = self.taps.iter().map(|tap| (i64::from(tap.delay) - self.lateness.mean).unsigned_abs()).max();
        // A quarter of the time, over the farthest distance of a tap from the mean. Times have 16 fractional bits,
        // delays 8, scales 30.
        let most = (time.0 >> 2).min(1 << 32) * (1 << 22) / farthest.unwrap_or_default().max(1);
        let most = most.min(u64::from(ONE)) as u32;
        scale.clamp(before.saturating_sub(most), before.saturating_add(most))
    }

    /// Delays of its taps, in ticks times 2^16.
    pub fn delays(&self) -> impl Iterator<Item = SubTicks> {
        self.taps.iter().map(Tap::late)
    }

    /// Nothing lies before the spans that are laid from now on.
    pub fn restart(&mut self, laid: u32) {
        self.cursors = [Cursor { span: laid, is_inside: false }; TAPS];
    }

    /// Number of the oldest span, of `laid`, that it still needs.
    pub fn oldest(&self, laid: u32) -> u32 {
        let used = |cursor: &Cursor| laid.wrapping_sub(cursor.span);
        laid.wrapping_sub(self.cursors.iter().take(self.taps.len()).map(used).max().unwrap_or_default())
    }

    /// Advances to `time`; false if a tap needs a span that is not laid yet.
    pub fn advance(&mut self, spans: &impl Spans, time: SubTicks) -> bool {
        for (tap, cursor) in self.taps.iter().zip(&mut self.cursors) {
            cursor.advance(tap, self.lateness, spans, time);
        }
        self.cursors.iter().take(self.taps.len()).all(|cursor| cursor.span != spans.laid())
    }

    /// Time at which the first of its taps that is not at rest runs out of spans; `SubTicks::MAX` if all are at rest.
    pub fn runs_out(&self, spans: &impl Spans) -> SubTicks {
        let end = spans.end();
        let cursors = self.taps.iter().zip(&self.cursors).filter(|(_, cursor)| cursor.span != spans.laid());
        cursors.map(|(tap, _)| end.time + self.lateness.of(tap, end)).min().unwrap_or(SubTicks::MAX)
    }

    /// Next change of its motion up to `until`, or that time: spans in which it stands still are no change.
    pub fn next_motion(&self, spans: &impl Spans, until: SubTicks) -> SubTicks {
        let ([tap], [cursor, ..]) = (self.taps.as_slice(), &self.cursors) else {
            // With several taps one or the other is nearly always in motion.
            return self.next_change(spans).min(until);
        };
        let mut number = cursor.span;
        while number != spans.laid() {
            let (span, end) = spans.get(number);
            if span.begin.at(self.index) != end.at(self.index) {
                let is_inside = number == cursor.span && cursor.is_inside;
                let bound = if is_inside { end } else { &span.begin };
                return (bound.time + self.lateness.of(tap, bound)).min(until);
            }
            if end.time + self.lateness.of(tap, end) >= until {
                return until;
            }
            number = number.wrapping_add(1);
        }
        self.runs_out(spans).min(until)
    }

    /// Its state at a time that may be beyond its next changes, as it is seen from before that time.
    pub fn state_ahead(&self, spans: &impl Spans, time: SubTicks) -> AxisState {
        self.state_of(spans, time, Some(SubTicks(time.0.saturating_sub(1))))
    }

    /// Next time at which one of its taps begins or ends a span; `SubTicks::MAX` if there is none.
    pub fn next_change(&self, spans: &impl Spans) -> SubTicks {
        let change = |(tap, cursor): (&Tap, &Cursor)| {
            if cursor.span == spans.laid() {
                return SubTicks::MAX;
            }
            let (span, end) = spans.get(cursor.span);
            let bound = if cursor.is_inside { end } else { &span.begin };
            bound.time + self.lateness.of(tap, bound)
        };
        self.taps.iter().zip(&self.cursors).map(change).min().unwrap_or(SubTicks::MAX)
    }

    /// The single span that it follows unchanged, and its number, if that span begins at `time`: the axis has its
    /// shape.
    pub fn follows<'a>(&self, spans: &'a impl Spans, time: SubTicks) -> Option<(u32, &'a Span)> {
        let ([tap], [cursor, ..], true) = (self.taps.as_slice(), &self.cursors, self.is_position) else {
            return None;
        };
        let (span, _) = spans.get(cursor.span);
        let begins = cursor.is_inside && time == span.begin.time + tap.late();
        (begins && cursor.span != spans.laid()).then_some((cursor.span, span))
    }

    /// Whether it follows no motion.
    pub fn is_still(&self) -> bool {
        self.taps.is_empty()
    }

    /// Its state at a time up to the next change.
    pub fn state(&self, spans: &impl Spans, time: SubTicks) -> AxisState {
        self.state_of(spans, time, None)
    }

    /// Its state at a time. With a time `ahead` each tap is taken as far as there first; its cursor stays. A copy of
    /// all cursors takes longer than the rest.
    #[inline]
    fn state_of(&self, spans: &impl Spans, time: SubTicks, ahead: Option<SubTicks>) -> AxisState {
        let copy = |tap: &Tap, cursor: &Cursor| {
            let mut cursor = *cursor;
            if let Some(ahead) = ahead {
                cursor.advance(tap, self.lateness, spans, ahead);
            }
            if cursor.span == spans.laid() {
                return AxisState::at_rest(spans.end().at(self.index));
            }
            let (span, end) = spans.get(cursor.span);
            // The two ends of the span have delays of their own, so this copy runs through it a little faster or
            // slower.
            if cursor.is_inside && self.lateness.stiffening.is_some() {
                let late = self.lateness;
                let bounds = (span.begin.time + late.of(tap, &span.begin), end.time + late.of(tap, end));
                span.warped(self.index, end, bounds, time)
            } else if cursor.is_inside {
                span.state(self.index, end, time.saturating_sub(tap.late()))
            } else {
                // Before its first span after a rest.
                AxisState::at_rest(span.begin.at(self.index))
            }
        };
        let mut copies = self.taps.iter().zip(&self.cursors);
        let Some((tap, cursor)) = copies.next() else {
            return AxisState::at_rest(Steps::ZERO);
        };
        let first = copy(tap, cursor);
        if self.is_position && self.taps.len() == 1 {
            return first;
        }
        // Their common part is left out of the sum, so an axis at rest is exactly at its target.
        let (mut way, mut speed) = (0.0, tap.weight * first.speed);
        for (tap, cursor) in copies {
            let other = copy(tap, cursor);
            way += tap.weight * to_f32(other.position.wrapping_sub(first.position));
            speed += tap.weight * other.speed;
        }
        let common = if self.is_position { first.position } else { Steps::ZERO };
        AxisState { position: common.wrapping_add(from_f32(way)), speed }
    }
}
