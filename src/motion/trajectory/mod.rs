//! The trajectory: the position of every axis at every time, given the moves so far. The generator runs it.
//!
//! ```text
//! spans:  |--speeding--|-----steady-----|--slowing--|            laid one after the other, a ring of them
//! tap 1:        |--speeding--|-----steady-----|--slowing--|      a copy that is late by d1, with the weight w1
//! tap 2:             |--speeding--|-----steady-----|--slowing--| late by d2, weight w2
//! axis:   sum of w * copy, a quadratic between any two changes of a copy
//! ```
//!
//! Moves are laid as consecutive [`Span`]s, and each axis follows them through its [`Tap`]s. Time is the time of the
//! output, in ticks times 2^16: at the time t a tap with the delay d is where the spans were at t - d. One of all taps
//! has no delay ([`taps`] ensures this), so a motion laid after a rest begins at once.
//!
//! On a surface, z is the spans' z and the surface's height where x and y are, shaped ([`surface`](super::surface)).
//! Its state can be asked beyond its next change, as far as spans are laid: so its pieces need not end with each change
//! of x and y.
//!
//! A new shaper is an arm of `impulses` in `shaper.rs`. It may have up to `MOST_IMPULSES` (there), and an axis up to
//! [`TAPS`] (`taps.rs`), which cost every axis memory and time. Where a shaper is longer than [`SPANS`] of short moves,
//! short moves take longer.
//!
//! # Words
//!
//! - **span**: a piece of the trajectory in which the tool goes straight and its speed changes evenly; a phase of a
//!   move, or a part of a long phase. **boundary**: place and time where one span ends and the next begins.
//! - **tap**: a delayed copy with a weight, as in a filter with a tapped delay line; an input shaper has one for each
//!   impulse.
//! - **advance**: the axis of the pressure in the extruder. **stiffening**: see [`stiffening`].
//! - **offset**: steps that z stands aside of its path, live ([`z_offset`]).
//! - **position**: the positions of all axes, in steps.

mod axis;
pub(in crate::motion) mod phase;
mod shaper;
mod span;
mod stiffening;
mod taps;
mod z_offset;

pub(in crate::motion) use shaper::MOST_PUSH;
#[cfg(test)]
pub(crate) use shaper::impulses;
pub use shaper::{advance_window, stiffenings, taps};
pub(crate) use span::{ADVANCE, AXES, AxisState, Boundary, LONGEST, Position, Span, Z};
pub use stiffening::Stiffening;
pub use taps::{TAPS, Tap, Taps};

use crate::motion::moves::WHOLE;
use crate::motion::number::ticks;
use crate::motion::surface::SurfaceFrame;
use crate::settings::Kept;
use crate::surface::{Heights, MOST_POINTS};
use crate::units::{Steps, SubTicks, part_of};
use axis::{AxisPath, Spans};
use phase::{Curve, Phase, point};
use span::ONE;
use z_offset::ZOffset;

/// Number of spans in memory; a power of two. At the 0.25 ms of a move of 0.05 mm at 200 mm/s they last for 32 ms: a
/// shaper of 60 Hz with two humps takes 25. A longer shaper makes such short moves take longer.
const SPANS: usize = 128;
const _: () = assert!(SPANS.is_power_of_two());

/// Memory for the spans.
pub struct SpanMemory([Span; SPANS]);

impl SpanMemory {
    /// Without spans.
    #[must_use]
    pub const fn new() -> Self {
        Self([Span::EMPTY; SPANS])
    }
}

impl Default for SpanMemory {
    fn default() -> Self {
        Self::new()
    }
}

struct Ring<'m> {
    spans: &'m mut SpanMemory,
    laid: u32,
    end: Boundary,
}

impl Ring<'_> {
    #[inline(always)]
    fn span(&self, number: u32) -> &Span {
        // The mask keeps the index in range.
        self.spans.0.get(number as usize % SPANS).unwrap_or(&Span::EMPTY)
    }
}

impl Spans for Ring<'_> {
    fn laid(&self) -> u32 {
        self.laid
    }

    #[inline(always)]
    fn get(&self, number: u32) -> (&Span, &Boundary) {
        let next = number.wrapping_add(1);
        (self.span(number), if next == self.laid { &self.end } else { &self.span(next).begin })
    }

    fn end(&self) -> &Boundary {
        &self.end
    }
}

/// Linear interpolation from `from` to `to` over `whole`, after `part` of it.
fn between(from: u32, to: u32, SubTicks(part): SubTicks, SubTicks(whole): SubTicks) -> u32 {
    let way = part_of(i64::from(to) - i64::from(from), part.min(whole), whole.max(1));
    (i64::from(from) + way) as u32
}

/// The spans, and the progress of each axis in them.
pub(crate) struct Trajectory<'m> {
    ring: Ring<'m>,
    axes: [AxisPath; AXES],
    z_offset: ZOffset,
    /// The last span was taken back and is laid again as far as it has passed: the taps' scale at its end, and its
    /// duration.
    cut: Option<([u32; 2], SubTicks)>,
    surface: SurfaceFrame,
    heights: Kept<Heights>,
}

impl<'m> Trajectory<'m> {
    /// At rest at time 0; no axis has a delay.
    pub fn new(spans: &'m mut SpanMemory) -> Self {
        let end = Boundary::new(SubTicks::ZERO, [Steps::ZERO; AXES]);
        let ring = Ring { spans, laid: 0, end };
        let mut axes = core::array::from_fn(AxisPath::new);
        for axis in axes.iter_mut().take(ADVANCE) {
            axis.follow(&[Tap::IDENTITY], true);
        }
        Self {
            ring,
            axes,
            z_offset: ZOffset::NONE,
            cut: None,
            surface: SurfaceFrame::NONE,
            heights: Kept::new(Heights::NONE),
        }
    }

    /// The offset of z.
    pub const fn z_offset(&self) -> &ZOffset {
        &self.z_offset
    }

    /// The offset of z, to change it.
    pub const fn z_offset_mut(&mut self) -> &mut ZOffset {
        &mut self.z_offset
    }

    /// Makes an axis follow other taps; all axes are at rest. The advance is only the difference of its taps.
    pub fn follow(&mut self, axis: usize, taps: &[Tap]) {
        let is_position = axis != ADVANCE;
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.follow(taps, is_position);
            axis.restart(self.ring.laid);
        }
    }

    /// Z follows another surface, or none; all axes are at rest. Its heights come afterwards.
    pub fn follow_surface(&mut self, surface: SurfaceFrame) {
        self.surface = surface;
        *self.heights = surface.flat();
        self.heights.settle();
    }

    /// Heights of a row of the surface.
    pub fn set_heights(&mut self, row: usize, heights: [i16; MOST_POINTS]) {
        self.heights.set_row(row, heights);
        self.heights.settle();
    }

    /// Whether z follows a surface.
    pub const fn has_surface(&self) -> bool {
        !self.surface.is_none()
    }

    /// The surface that z follows, if any.
    pub fn surface(&self) -> Option<(&SurfaceFrame, &Heights)> {
        self.has_surface().then_some((&self.surface, &*self.heights))
    }

    /// The motors' position at rest for a position of the spans.
    pub fn to_real(&self, position: [Steps; 4]) -> [Steps; 4] {
        self.surface.to_real(&self.heights, position)
    }

    /// Whether the taps of an axis, and the surface if it follows one, are unchanged in memory.
    pub fn is_whole(&self, axis: usize) -> bool {
        self.axes.get(axis).is_none_or(AxisPath::is_whole)
            && (axis != Z || !self.has_surface() || self.heights.is_whole())
    }

    /// A tap of an axis, which must not be changed.
    #[cfg(test)]
    pub fn damage(&mut self, axis: usize) -> Option<&mut Tap> {
        self.axes.get_mut(axis).and_then(AxisPath::damage)
    }

    /// Sets the stiffening of an axis; all axes are at rest.
    pub fn stiffen(&mut self, axis: usize, stiffening: Stiffening) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.stiffen(stiffening);
        }
    }

    /// Scales of x's and y's taps at a position, reached by a span of this `time` from a boundary.
    fn scales(&self, position: &Position, from: Option<(&Boundary, SubTicks)>) -> [u32; 2] {
        let ([x, y, ..], [at_x, at_y, ..]) = (&self.axes, position);
        let before = |axis: usize| from.map(|(end, time)| (end.scale.get(axis).copied().unwrap_or(ONE), time));
        [x.scale(*at_x, before(0)), y.scale(*at_y, before(1))]
    }

    /// Rests at a position from `time` on.
    pub fn rest_at(&mut self, position: Position, time: SubTicks) {
        let scale = self.scales(&position, None);
        self.ring.end = Boundary { time, position, scale };
        self.cut = None;
        for axis in &mut self.axes {
            axis.restart(self.ring.laid);
        }
    }

    /// End of the last span.
    pub const fn end(&self) -> &Boundary {
        &self.ring.end
    }

    /// Time at which all axes have reached the end of the last span.
    pub fn rest_time(&self) -> SubTicks {
        self.ring.end.time + self.longest_delay()
    }

    /// Whether no axis has a delay, so that all have reached the end of the last span when the next is requested.
    pub fn is_prompt(&self) -> bool {
        self.longest_delay() == SubTicks::ZERO
    }

    /// The longest delay of an axis, in ticks.
    pub fn delay_ticks(&self) -> f32 {
        ticks(self.longest_delay())
    }

    fn longest_delay(&self) -> SubTicks {
        self.axes.iter().flat_map(AxisPath::delays).max().unwrap_or_default()
    }

    /// Minimum time of a span laid now. It is zero unless so many short spans wait for the slowest tap that another
    /// could overwrite a span still in use. Then spans take longer to prevent this.
    pub fn least_time(&self) -> SubTicks {
        let used = |axis: &AxisPath| self.ring.laid.wrapping_sub(axis.oldest(self.ring.laid)) as usize;
        let free = SPANS - 1 - self.axes.iter().map(used).max().unwrap_or_default().min(SPANS - 2);
        if free >= SPANS / 4 { SubTicks::ZERO } else { SubTicks(self.longest_delay().0 / free as u64) }
    }

    /// Lays a phase of the move from `first` to `last`, or a part of a phase, after the last span.
    pub fn lay(&mut self, first: &Position, last: &Position, phase: &Phase) {
        let Self { ring, cut, .. } = self;
        let number = ring.laid;
        ring.laid = number.wrapping_add(1);
        // Each part is written in its place: boundaries and spans are too large to be handed around.
        if let Some(span) = ring.spans.0.get_mut(number as usize % SPANS) {
            span.lay(&ring.end, phase);
        }
        for (axis, end) in ring.end.position.iter_mut().enumerate() {
            *end = point(first[axis], last[axis], phase.end);
        }
        ring.end.time += phase.time;
        let cut = cut.take();
        let begin = &self.ring.span(number).begin;
        self.ring.end.scale = match cut {
            None => self.scales(&self.ring.end.position, Some((begin, phase.time))),
            // The part that has passed stays as it was: the taps move evenly within a span.
            Some((scale, time)) => core::array::from_fn(|i| match (begin.scale.get(i), scale.get(i)) {
                (Some(from), Some(to)) => between(*from, *to, phase.time, time),
                _ => ONE,
            }),
        };
    }

    /// Continues from another position, so close that no motor feels it.
    pub fn shift(&mut self, position: &Position) {
        let from = self.ring.end.position;
        self.lay(&from, position, &Phase { curve: Curve::Steady, end: WHOLE, slow_share: 0, time: SubTicks::ZERO });
    }

    /// Advances an axis to `time`; false if it needs a span that is not laid yet.
    pub fn advance(&mut self, axis: usize, time: SubTicks) -> bool {
        let has_surface = axis == Z && self.has_surface();
        let Self { ring, axes, z_offset, .. } = self;
        if axis == Z {
            z_offset.advance(time);
        }
        if has_surface {
            let mut is_laid = true;
            for axis in axes.iter_mut().take(Z + 1) {
                is_laid &= axis.advance(ring, time);
            }
            return is_laid;
        }
        axes.get_mut(axis).is_none_or(|axis| axis.advance(ring, time))
    }

    /// Next change of an axis's motion; `SubTicks::MAX` if that is not known. On a surface this is the next time at
    /// which z itself changes, or up to which x and y are known.
    pub fn next_change(&self, axis: usize) -> SubTicks {
        let change = if axis == Z && self.has_surface() {
            let [x, y, z, ..] = &self.axes;
            z.next_motion(&self.ring, x.runs_out(&self.ring).min(y.runs_out(&self.ring)))
        } else {
            self.axes.get(axis).map_or(SubTicks::MAX, |axis| axis.next_change(&self.ring))
        };
        if axis == Z { change.min(self.z_offset.next_change()) } else { change }
    }

    /// The span that all of some axes follow unchanged from `time` on, if there is one.
    pub fn follows(&self, axes: impl Iterator<Item = usize>, time: SubTicks) -> Option<&Span> {
        let mut common = None;
        let bends = self.has_surface() || self.z_offset.is_moving();
        for (number, axis) in axes.filter_map(|axis| Some((axis, self.axes.get(axis)?))) {
            if bends && number == Z {
                return None;
            }
            if axis.is_still() {
                continue;
            }
            let (number, span) = axis.follows(&self.ring, time)?;
            if common.is_some_and(|(other, _)| other != number) {
                return None;
            }
            common = Some((number, span));
        }
        common.map(|(_, span)| span)
    }

    /// The state of an axis at a time up to its next change.
    pub fn state(&self, axis: usize, time: SubTicks) -> AxisState {
        let state = if axis == Z && self.has_surface() {
            self.state_on_surface(time)
        } else {
            self.axes.get(axis).map_or(AxisState::at_rest(Steps::ZERO), |axis| axis.state(&self.ring, time))
        };
        if axis != Z || self.z_offset.is_none() {
            return state;
        }
        let offset = self.z_offset.state(time);
        AxisState { position: state.position.wrapping_add(offset.position), speed: state.speed + offset.speed }
    }

    /// The state of z on the surface, as far as spans are laid.
    #[inline(never)]
    fn state_on_surface(&self, time: SubTicks) -> AxisState {
        let [x, y, z, ..] = &self.axes;
        let at = |axis: &AxisPath| {
            let state = axis.state_ahead(&self.ring, time);
            (state.position, state.speed)
        };
        let (position, speed) = self.surface.raised(&self.heights, &[at(x), at(y), at(z)]);
        AxisState { position, speed }
    }

    /// Takes back the last span, which is laid again up to the first tap's position in it at `time`. `None` if it has
    /// ended by then.
    pub fn take_back(&mut self, time: SubTicks) -> Option<SubTicks> {
        if self.ring.laid == 0 || time >= self.ring.end.time {
            return None;
        }
        self.ring.laid -= 1;
        let begin = self.ring.span(self.ring.laid).begin;
        let was = core::mem::replace(&mut self.ring.end, begin);
        let passed = time.saturating_sub(self.ring.end.time);
        self.cut = (passed > SubTicks::ZERO).then_some((was.scale, was.time - self.ring.end.time));
        Some(passed)
    }
}
