//! Into the look-ahead: a move is planned as soon as there is room for it.

use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::modal::FARTHEST;
use crate::machine::state::notices::Notice;
use crate::machine::state::soft_endstops::clamp;
use crate::motion::Target;
use crate::port::{Clock, EndstopSet, Pend};
use crate::units::{Mm, MmPerSec, Seconds, TICKS_PER_SECOND};

/// Keeps the tool within what any machine could reach; a point of an arc may lie beyond.
fn bounded(position: [Mm; 4]) -> [Mm; 4] {
    let [x, y, z, e] = position;
    let [x, y, z] = [x, y, z].map(|at| FARTHEST.clamp(at));
    [x, y, z, e]
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Plans a move within the reachable space and takes it as the commanded position.
    pub(in crate::machine) async fn go(&mut self, position: [Mm; 4], speed: MmPerSec) -> Result<(), Interrupt> {
        let (inside, moved) = clamp(bounded(position), self.modal.position, self.homed, &self.settings);
        if moved {
            self.tell_of_edge().await?;
        }
        let position = self.retraction.away_from(inside);
        self.plan(Target { position, speed, has_overrides: true, watch: EndstopSet::NONE }).await?;
        self.modal.position = inside;
        Ok(())
    }

    /// Tells once that a target was beyond the edge.
    pub(in crate::machine) async fn tell_of_edge(&mut self) -> Result<(), Interrupt> {
        if self.notices.give(Notice::Edge) {
            self.tell(Answer::Line("echo:target beyond the reachable space, moved to its edge")).await?;
        }
        Ok(())
    }

    /// Plans a move as soon as there is room for it.
    pub(in crate::machine) async fn plan(&mut self, target: Target) -> Result<(), Interrupt> {
        let motors = self.real.groups().fitted();
        if !self.has_power(motors) && self.planner.is_move(target.position) {
            self.power(motors).await?;
        }
        while !self.has_room() {
            self.policy.note_full();
            if !self.planner.replan() {
                self.come_again();
            } else if !self.planner.has_room() && !self.planner.has_ready() {
                self.come_again();
                self.planner.release_some();
            }
            self.turn().await?;
        }
        self.note_added();
        self.follow_stream();
        while !self.planner.prepare() {
            self.turn_again().await?;
        }
        // The stream may have run dry in these turns too.
        self.note_added();
        self.planner.push(&target, &self.settings);
        self.policy.note_news();
        self.note_path();
        Ok(())
    }

    /// Whether the look-ahead takes another move: there is a place for it, and the planned moves do not last for too long. As
    /// long as the first waiting move is not final, there are too few moves, however long they last. So a full look-ahead
    /// delays moves, and changes no speed.
    pub(in crate::machine) fn has_room(&mut self) -> bool {
        let most_ticks = u64::from(self.settings.lookahead_time.to_bits()) * u64::from(TICKS_PER_SECOND);
        let most_ticks = most_ticks >> Seconds::FRAC_NBITS;
        let planned_ticks = self.planner.waiting() + self.link.left();
        self.planner.has_room() && (planned_ticks < most_ticks || self.planner.lacks_moves())
    }

    /// A move is about to be added. If an earlier one has left that would have been faster with it, the host was too slow.
    fn note_added(&mut self) {
        if self.policy.add(self.ports.clock.now()) {
            self.link.status().count_underrun();
        }
    }

    /// Slows down for a stream that has run dry and goes on. How long the moves last is known when all of them are planned.
    pub(in crate::machine) fn follow_stream(&mut self) {
        if !self.policy.is_steady() && self.planner.is_planned() {
            let share = self.policy.share(self.planner.waiting(), self.link.left());
            self.planner.take_share(share);
        }
    }

    /// M220: from now on, and for the moves that wait. An earlier change is carried out first, and moves leave before the
    /// next change: a host that changes the feed all the time would keep all moves back.
    pub(in crate::machine) async fn override_feed(&mut self, percent: u16) -> Result<(), Interrupt> {
        if !self.planner.is_planned() {
            while !self.planner.replan() {
                self.turn_again().await?;
            }
            self.turn_again().await?;
        }
        self.planner.override_feed(percent);
        self.policy.note_news();
        Ok(())
    }

    /// Tells the other contexts how much was planned.
    pub(in crate::machine) fn note_path(&self) {
        let (moves, path) = self.planner.planned();
        self.link.status().set_planned(moves, path);
    }
}
