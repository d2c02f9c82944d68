//! Out of the look-ahead: the part of a turn that hands moves on when the release policy lets them go.

use super::Motion;
use crate::machine::release::policy::{GATHERED, Release};
use crate::port::Wake;
use crate::settings::Settings;
use crate::units::Instant;

/// What a turn has done for the motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine::main_loop) enum Fed {
    /// Nothing more is to be done now.
    Nothing,
    /// There is more to do at once.
    More,
    /// A move has left the look-ahead, and there is more to do at once.
    Move,
}

impl<W: Wake> Motion<'_, W> {
    /// Hands released moves on, and releases more when it is time.
    pub(in crate::machine::main_loop) fn feed(&mut self, settings: &Settings, now: Instant) -> Fed {
        // Asked at every turn, because that updates the count of steps made.
        let left = self.link.left();
        if self.link.is_shifting() {
            self.link.help_shift();
        }
        let queued = self.link.level();
        let level = (self.planner.len() + queued) as u32;
        self.link.status().set_level(level);
        if self.policy.is_level_telling() {
            self.link.status().note_level(level);
        }
        if self.policy.is_gathering() {
            return self.begin_motion(now);
        }
        // One move a turn, so that bytes and emergencies are handled in between. The next turn follows at once.
        self.hand_on(queued, left, settings, now)
    }

    /// Hands a move on, or lets one go, if it is time, given the moves that have left the look-ahead and their time.
    fn hand_on(&mut self, queued: usize, left: u64, settings: &Settings, now: Instant) -> Fed {
        if !self.link.has_room() {
            return Fed::Nothing;
        }
        let release = self.policy.release(queued, left);
        if release == Release::Nothing {
            return Fed::Nothing;
        }
        if self.planner.is_empty() {
            if self.link.is_idle() {
                self.policy.come_to_rest(now);
            }
            return Fed::Nothing;
        }
        if !self.planner.replan() {
            return Fed::More;
        }
        if let Some(released) = self.planner.pop() {
            self.link.send_move(released, &settings.axes.z);
            return Fed::Move;
        }
        if release == Release::Final {
            return Fed::Nothing;
        }
        // The line that waits to be continued may make the next move final.
        if self.planner.cut_line(settings) {
            self.note_path();
            return Fed::More;
        }
        self.planner.release_next();
        self.policy.note_dry();
        Fed::More
    }

    /// Begins the motion if it is time.
    fn begin_motion(&mut self, now: Instant) -> Fed {
        // A move that is not planned cannot be final, and few moves are not worth the question.
        if !self.policy.is_worth_asking(now) || self.planner.is_empty() {
            return Fed::Nothing;
        }
        let is_due = !self.planner.is_planned() || self.planner.waiting() >= GATHERED;
        let (final_ticks, is_all) = if is_due { self.planner.final_time() } else { (0, true) };
        if !is_all {
            self.policy.note_news();
        }
        if self.policy.begin(final_ticks, now) || !is_all { Fed::More } else { Fed::Nothing }
    }
}
