//! Commands that move: straight moves (G0, G1), arcs (G2, G3), retraction (G10, G11).
//!
//! Each ends in `plan` of the crank, which waits until there is room for the move.

use super::arcs::arc::{Arc, Shape, Way, join, split};
use super::cold_extrusion::{ColdExtrusion, tell_of_cold};
use crate::gcode::{ArcShape, AxisWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::BeltAnswer;
use crate::machine::belt::align::lacks_alignment;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::commanded::{LEAST_FILAMENT, Wanted};
use crate::machine::state::modal::{FARTHEST, Modal, are_apart};
use crate::machine::state::notices::{Notice, Notices};
use crate::machine::state::retraction::{RetractionMove, RetractionSettings};
use crate::machine::state::soft_endstops::clamp;
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::settings::Alignment;
use crate::units::{Mm, MmPerSec, part_of};

/// The arguments of G2 and G3.
#[derive(Clone, Copy)]
pub(in crate::machine) struct ArcWords<'c> {
    pub clockwise: bool,
    pub to: &'c AxisWords,
    pub feed: Option<Number>,
    pub shape: ArcShape,
    pub turns: u16,
    pub decimals: u8,
}

/// Keeps the tool within what any machine could reach; a point of an arc may lie beyond.
fn bounded(position: [Mm; 4]) -> [Mm; 4] {
    let [x, y, z, e] = position;
    let [x, y, z] = [x, y, z].map(|at| FARTHEST.clamp(at));
    [x, y, z, e]
}

/// The axes that move between two positions.
pub(super) fn moving([x, y, z, _]: [Mm; 4], [to_x, to_y, to_z, _]: [Mm; 4]) -> [bool; 3] {
    [are_apart(x, to_x), are_apart(y, to_y), are_apart(z, to_z)]
}

/// What a line of motion needs: what goes on meanwhile, what numbers mean, what is told of them, and whether filament may move.
pub(in crate::machine) struct Moves<'c, 'm, P: PortSet, W: Pend> {
    pub crank: &'c mut Crank<'m, P, W>,
    pub modal: &'c mut Modal,
    pub clamps: &'c mut Clamps,
    pub notices: &'c mut Notices,
    pub cold: &'c ColdExtrusion,
}

impl<P: PortSet, W: Pend> Moves<'_, '_, P, W> {
    /// G0, G1. A line that is refused changes nothing, F included.
    pub async fn line(&mut self, to: &AxisWords, feed: Option<Number>) -> Result<Answer<'static>, Interrupt> {
        let feed = self.clamps.feed(self.modal, feed).unwrap_or(self.modal.feed);
        let wanted = self.target(to).await?;
        let at = self.crank.commanded().position();
        let moves = moving(at, wanted.position);
        if !self.may_move(moves).await? {
            return Ok(Answer::NotHomed);
        }
        let [x, y, _] = moves;
        if (x || y) && !self.may_print(wanted.position).await? {
            return Ok(Answer::Belt(BeltAnswer::Needed));
        }
        self.go(wanted.position, feed).await?;
        self.modal.feed = feed;
        self.crank.commanded_mut().count_extrusion(wanted.extrusion);
        Ok(Answer::Nothing)
    }

    /// Whether these axes may move: they were homed, or need not be, of which the host is told once.
    pub(super) async fn may_move(&mut self, moves: [bool; 3]) -> Result<bool, Interrupt> {
        if !self.crank.homed().lacks_one_of(moves) {
            return Ok(true);
        }
        if self.crank.settings().require_homing {
            self.clamps.clear();
            return Ok(false);
        }
        if self.notices.give(Notice::MotionBeforeHoming) {
            self.crank
                .tell(Answer::Line("echo:motion before homing (G28), the ends of the axes are not known"))
                .await?;
        }
        Ok(true)
    }

    /// Whether a move of x and y to `position` may be made: it does not print, or the motors of the belt are aligned, or need not be, of
    /// which the host is told once.
    async fn may_print(&mut self, position: [Mm; 4]) -> Result<bool, Interrupt> {
        let ([.., to], [.., from]) = (position, self.crank.commanded().position());
        let rule = self.crank.settings().belt.alignment;
        if rule == Alignment::Off || to.wrapping_sub(from) < LEAST_FILAMENT || !lacks_alignment(self.crank) {
            return Ok(true);
        }
        if rule == Alignment::Required {
            self.clamps.clear();
            return Ok(false);
        }
        if self.notices.give(Notice::NotAligned) {
            self.crank.tell(Answer::Line("echo:printing with belt motors that are not aligned (M915)")).await?;
        }
        Ok(true)
    }

    /// Plans a move within the reachable space and takes it as the commanded position.
    async fn go(&mut self, position: [Mm; 4], speed: MmPerSec) -> Result<(), Interrupt> {
        let (inside, moved) = {
            let crank = &*self.crank;
            clamp(bounded(position), crank.commanded().position(), crank.homed(), crank.settings())
        };
        if moved {
            self.tell_of_edge().await?;
        }
        let position = self.crank.commanded().of_machine(inside);
        self.crank.plan(Target { position, speed, has_overrides: true, watch: EndstopSet::NONE }).await?;
        self.crank.commanded_mut().go_to(inside);
        Ok(())
    }

    /// Tells once that a target was beyond the edge.
    pub(super) async fn tell_of_edge(&mut self) -> Result<(), Interrupt> {
        if self.notices.give(Notice::Edge) {
            self.crank.tell(Answer::Line("echo:target beyond the reachable space, moved to its edge")).await?;
        }
        Ok(())
    }

    /// Where the words of a line lead; the host is told what they ask for beyond the possible.
    pub(super) async fn target(&mut self, to: &AxisWords) -> Result<Wanted, Interrupt> {
        let crank = &*self.crank;
        let wanted = crank.commanded().target(to, self.modal, crank.settings(), self.cold.is_too_cold(crank));
        if wanted.is_held_back {
            tell_of_cold(self.crank, self.notices).await?;
        }
        if wanted.too_much {
            self.crank.tell(Answer::TooMuchFilament).await?;
        }
        if wanted.is_too_far {
            self.tell_of_edge().await?;
        }
        Ok(wanted)
    }

    /// G2, G3. The axis across the plane and E run evenly along the arc.
    pub async fn arc(&mut self, words: &ArcWords<'_>) -> Result<Answer<'static>, Interrupt> {
        let speed = self.clamps.feed(self.modal, words.feed).unwrap_or(self.modal.feed);
        let wanted = self.target(words.to).await?;
        let plane = self.modal.plane;
        let (start, [sz, se]) = split(plane, self.crank.commanded().position());
        let (end, [ez, ee]) = split(plane, wanted.position);
        let arc = Shape::new(words.shape, plane, |n| self.modal.length(n)).and_then(|shape| {
            let way = Way { clockwise: words.clockwise, turns: words.turns };
            Arc::new(start, end, shape, way, self.crank.settings().arc_tolerance, self.modal.rounding(words.decimals))
        });
        let arc = match arc {
            Ok(arc) => arc,
            Err(error) => {
                self.clamps.clear();
                return Ok(Answer::Line(error.text()));
            }
        };
        let [x, y, z, _] = join(plane, [true, true], [are_apart(sz, ez), false]);
        if !self.may_move([x, y, z]).await? {
            return Ok(Answer::NotHomed);
        }
        if !self.may_print(wanted.position).await? {
            return Ok(Answer::Belt(BeltAnswer::Needed));
        }
        self.modal.feed = speed;
        let begin = self.crank.commanded().extrusion();
        let between = |from: Mm, to: Mm, part: u32| {
            let length = to.to_bits().wrapping_sub(from.to_bits());
            Mm::from_bits(from.to_bits().wrapping_add(part_of(length, u64::from(part), u64::from(arc.chords()))))
        };
        for part in 1..=arc.chords() {
            let along = [between(sz, ez, part), between(se, ee, part)];
            self.go(join(plane, arc.point(part), along), speed).await?;
            self.crank.commanded_mut().count_extrusion(between(begin, wanted.extrusion, part));
        }
        Ok(Answer::Nothing)
    }

    /// G10.
    pub async fn retract(&mut self, settings: &RetractionSettings) -> Result<(), Interrupt> {
        self.plan_retraction(self.crank.commanded().moves_away(settings, self.crank.settings().axes.z.max_speed)).await
    }

    /// G11.
    pub async fn recover(&mut self, settings: &RetractionSettings) -> Result<(), Interrupt> {
        self.plan_retraction(self.crank.commanded().moves_back(settings, self.crank.settings().axes.z.max_speed)).await
    }

    /// Plans moves away from the commanded position, or back to it.
    ///
    /// Not with a cold hotend: what was pulled back stays so until it is hot.
    async fn plan_retraction(&mut self, moves: Option<[RetractionMove; 2]>) -> Result<(), Interrupt> {
        if self.cold.is_too_cold(self.crank) {
            return tell_of_cold(self.crank, self.notices).await;
        }
        for step in moves.into_iter().flatten() {
            let position = self.crank.commanded().after(step);
            self.crank
                .plan(Target { position, speed: step.speed, has_overrides: false, watch: EndstopSet::NONE })
                .await?;
            self.crank.commanded_mut().note_retraction(step);
        }
        self.crank.commanded_mut().take_extra();
        Ok(())
    }
}
