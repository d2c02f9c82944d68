//! Out of the look-ahead: the part of a turn that hands moves on when the release policy lets them go.

use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::release::policy::{GATHERED, Release};
use crate::motion::Work;
use crate::port::Pend;
use crate::units::Instant;

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// Hands released moves on, and releases more when it is time.
    pub(in crate::machine::main_loop) fn feed_motion(&mut self, now: Instant) {
        // Asked at every turn, because that updates the count of steps made.
        let left = self.link.left();
        let queued = self.link.level();
        let level = (self.planner.len() + queued) as u32;
        self.status.set_level(level);
        if self.policy.is_level_telling() {
            self.status.note_level(level);
        }
        if self.policy.is_gathering() {
            if self.begin_motion(now) {
                self.come_again();
            }
            return;
        }
        // One move a turn, so that bytes and emergencies are handled in between. The next turn follows at once.
        if self.hand_on(queued, left, now) {
            self.come_again();
        }
    }

    /// Hands a move on, or lets one go, if it is time, given the moves that have left the look-ahead and their time.
    fn hand_on(&mut self, queued: usize, left: u64, now: Instant) -> bool {
        if !self.link.has_room() {
            return false;
        }
        let release = self.policy.release(queued, left);
        if release == Release::Nothing {
            return false;
        }
        if self.planner.is_empty() {
            if self.link.is_idle() {
                self.policy.come_to_rest(now);
            }
            return false;
        }
        if !self.planner.replan() {
            self.come_again();
            return false;
        }
        if let Some(released) = self.planner.pop() {
            self.link.send(Work::Move(released));
            // It may be over before the next check for idleness.
            self.power.note_motion(now);
            return true;
        }
        if release == Release::Final {
            return false;
        }
        // The line that waits to be continued may make the next move final.
        if self.planner.cut_line(&self.settings) {
            self.note_path();
            return true;
        }
        self.planner.release_next();
        self.policy.note_dry();
        true
    }

    /// Whether motion begins now.
    fn begin_motion(&mut self, now: Instant) -> bool {
        // A move that is not planned cannot be final, and few moves are not worth the question.
        if !self.policy.is_worth_asking(now) || self.planner.is_empty() {
            return false;
        }
        let is_due = !self.planner.is_planned() || self.planner.waiting() >= GATHERED;
        let (final_ticks, is_all) = if is_due { self.planner.final_time() } else { (0, true) };
        if !is_all {
            self.policy.note_news();
            self.come_again();
        }
        self.policy.begin(final_ticks, now)
    }
}
