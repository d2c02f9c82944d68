//! Commands that move: straight moves (G0, G1), arcs (G2, G3), retraction (G10, G11).
//!
//! Each ends in `go` or `plan` of `stream`, which wait until there is room for the move.

use super::arcs::arc::{Arc, Shape, join, split};
use crate::gcode::{ArcShape, AxisWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::BeltAnswer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::modal::Wanted;
use crate::machine::state::notices::Notice;
use crate::machine::state::retraction::RetractionMove;
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::settings::Alignment;
use crate::units::{Mm, part_of};

/// The arguments of G2 and G3.
#[derive(Clone, Copy)]
pub(in crate::machine) struct ArcWords<'c> {
    pub clockwise: bool,
    pub to: &'c AxisWords,
    pub feed: Option<Number>,
    pub shape: ArcShape,
    pub turns: u16,
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// G0, G1. A line that is refused changes nothing, F included.
    pub(in crate::machine) async fn line(
        &mut self,
        to: &AxisWords,
        feed: Option<Number>,
    ) -> Result<Answer<'static>, Interrupt> {
        let feed = self.clamps.feed(&self.modal, feed).unwrap_or(self.modal.feed);
        let wanted = self.target(to).await?;
        let at = self.modal.position;
        let moves = [0, 1, 2].map(|axis| wanted.position.get(axis) != at.get(axis));
        if !self.may_move(moves).await? {
            return Ok(Answer::NotHomed);
        }
        let [x, y, _] = moves;
        if (x || y) && !self.may_print(wanted.position).await? {
            return Ok(Answer::Belt(BeltAnswer::Needed));
        }
        self.go(wanted.position, feed).await?;
        self.modal.feed = feed;
        self.modal.extrusion = wanted.extrusion;
        Ok(Answer::Nothing)
    }

    /// Whether these axes may move: they were homed, or need not be, of which the host is told once.
    pub(in crate::machine) async fn may_move(&mut self, moves: [bool; 3]) -> Result<bool, Interrupt> {
        if !self.homed.lacks_one_of(moves) {
            return Ok(true);
        }
        if self.settings.require_homing {
            self.clamps.clear();
            return Ok(false);
        }
        if self.notices.give(Notice::MotionBeforeHoming) {
            self.tell(Answer::Line("echo:motion before homing (G28), the ends of the axes are not known")).await?;
        }
        Ok(true)
    }

    /// Whether a move of x and y to `position` may be made: it does not print, or the motors of the belt are aligned, or need not be, of
    /// which the host is told once.
    async fn may_print(&mut self, position: [Mm; 4]) -> Result<bool, Interrupt> {
        let ([.., to], [.., from]) = (position, self.modal.position);
        let rule = self.settings.belt.alignment;
        if rule == Alignment::Off || to.wrapping_sub(from) <= 0 || !self.lacks_alignment() {
            return Ok(true);
        }
        if rule == Alignment::Required {
            self.clamps.clear();
            return Ok(false);
        }
        if self.notices.give(Notice::NotAligned) {
            self.tell(Answer::Line("echo:printing with belt motors that are not aligned (M915)")).await?;
        }
        Ok(true)
    }

    /// Where the words of a line lead; the host is told what they ask for beyond the possible.
    pub(in crate::machine) async fn target(&mut self, to: &AxisWords) -> Result<Wanted, Interrupt> {
        let wanted = self.modal.target(to, &self.settings, self.is_too_cold());
        if wanted.is_held_back {
            self.tell_of_cold().await?;
        }
        if wanted.too_much {
            self.tell(Answer::TooMuchFilament).await?;
        }
        if wanted.is_too_far {
            self.tell_of_edge().await?;
        }
        Ok(wanted)
    }

    /// G2, G3. The axis across the plane and E run evenly along the arc.
    pub(in crate::machine) async fn arc(&mut self, words: &ArcWords<'_>) -> Result<Answer<'static>, Interrupt> {
        let speed = self.clamps.feed(&self.modal, words.feed).unwrap_or(self.modal.feed);
        let wanted = self.target(words.to).await?;
        let plane = self.modal.plane;
        let (start, [sz, se]) = split(plane, self.modal.position);
        let (end, [ez, ee]) = split(plane, wanted.position);
        let arc = Shape::new(words.shape, plane, |n| self.modal.length(n))
            .and_then(|shape| Arc::new(start, end, shape, words.clockwise, words.turns, self.settings.arc_tolerance));
        let arc = match arc {
            Ok(arc) => arc,
            Err(error) => {
                self.clamps.clear();
                return Ok(Answer::Line(error.text()));
            }
        };
        let [x, y, z, _] = join(plane, [true, true], [sz != ez, false]);
        if !self.may_move([x, y, z]).await? {
            return Ok(Answer::NotHomed);
        }
        if !self.may_print(wanted.position).await? {
            return Ok(Answer::Belt(BeltAnswer::Needed));
        }
        self.modal.feed = speed;
        let begin = self.modal.extrusion;
        let between = |from: Mm, to: Mm, part: u32| {
            let length = to.to_bits().wrapping_sub(from.to_bits());
            Mm::from_bits(from.to_bits().wrapping_add(part_of(length, u64::from(part), u64::from(arc.chords()))))
        };
        for part in 1..=arc.chords() {
            let along = [between(sz, ez, part), between(se, ee, part)];
            self.go(join(plane, arc.point(part), along), speed).await?;
            self.modal.extrusion = between(begin, wanted.extrusion, part);
        }
        Ok(Answer::Nothing)
    }

    /// G10 and G11: plans moves away from the commanded position, or back to it.
    ///
    /// Not with a cold hotend: what was pulled back stays so until it is hot.
    pub(in crate::machine) async fn retract(&mut self, moves: Option<[RetractionMove; 2]>) -> Result<(), Interrupt> {
        if self.is_too_cold() {
            return self.tell_of_cold().await;
        }
        for step in moves.into_iter().flatten() {
            let position = self.retraction.after(step, self.modal.position);
            self.plan(Target { position, speed: step.speed, has_overrides: false, watch: EndstopSet::NONE }).await?;
            self.retraction.note_planned(step);
        }
        if let Some(extra) = self.retraction.take_extra() {
            let [_, _, _, e] = &mut self.modal.position;
            *e = e.wrapping_add(extra);
        }
        Ok(())
    }
}
