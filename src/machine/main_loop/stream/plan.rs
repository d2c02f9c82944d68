//! Into the look-ahead: a move is planned as soon as there is room for it.
//!
//! The amount of motion planned before a line is answered is decided here (`has_room`), by `Settings::lookahead_time`
//! (default in `Settings::prototype`). Without room the look-ahead counts as full to `release` (`note_full`): motion
//! begins, and a slow host's share ends. `main_loop::heat_turn` (`set_fan`) waits by the same exemption;
//! `main_loop::reply` (P of `advanced_ok`) asks `has_room`. `boards/sim/tests/lookahead_time.rs` tests it.
//! docs/explanation/flow.md, docs/reference/host-protocol.md, README.md, its row in `settings` and
//! `examples/machines/prototype.toml` describe it. M220 is here too.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::Pend;
use crate::units::{Seconds, TICKS_PER_SECOND};

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// Plans a move as soon as there is room for it.
    pub async fn plan(&mut self, target: Target) -> Result<(), Interrupt> {
        let motors = self.real.groups().fitted();
        if !self.power.is_on(motors) && self.planner.is_move(target.position) {
            self.power_up(motors).await?;
        }
        while !self.has_room() {
            self.policy.note_full();
            if !self.planner.replan() {
                self.come_again();
            } else if !self.planner.has_room() && !self.planner.has_ready() {
                self.come_again();
                if !self.close_line() {
                    self.planner.release_some();
                }
            }
            self.poll().await?;
        }
        if self.planner.was_cut_before(&target) {
            self.policy.note_dry();
        }
        self.note_added();
        self.follow_stream();
        while !self.planner.prepare() {
            self.poll_again().await?;
        }
        // The stream may have run dry in these turns too.
        self.note_added();
        self.planner.add(&target, &self.settings);
        self.policy.note_news();
        self.note_path();
        Ok(())
    }

    /// Whether the look-ahead takes another move: there is a place for it, and the planned moves do not last for too
    /// long. As long as the first waiting move is not final, there are too few moves, however long they last. So a full
    /// look-ahead delays moves, and changes no speed.
    pub(in crate::machine::main_loop) fn has_room(&mut self) -> bool {
        let most_ticks = u64::from(self.settings.lookahead_time.to_bits()) * u64::from(TICKS_PER_SECOND);
        let most_ticks = most_ticks >> Seconds::FRAC_NBITS;
        let planned_ticks = self.planner.waiting() + self.link.left();
        self.planner.has_room() && (planned_ticks < most_ticks || self.planner.lacks_moves())
    }

    /// A move is about to be added. If an earlier one has left that would have been faster with it, the host was too
    /// slow.
    fn note_added(&mut self) {
        if self.policy.add(self.now()) {
            self.status.count_underrun();
        }
    }

    /// Slows down for a stream that has run dry and continues. The duration of the moves is known when all of them are
    /// planned.
    pub(in crate::machine::main_loop) fn follow_stream(&mut self) {
        if !self.policy.is_steady() && self.planner.is_planned() {
            let share = self.policy.share(self.planner.waiting(), self.link.left());
            self.planner.take_share(share);
        }
    }

    /// M220: from now on, and for the moves that wait. An earlier change is carried out first, and moves leave before
    /// the next change. Otherwise a host that changes the feed all the time would keep all moves back.
    pub async fn override_feed(&mut self, percent: u16) -> Result<(), Interrupt> {
        if !self.planner.is_planned() {
            while !self.planner.replan() {
                self.poll_again().await?;
            }
            self.poll_again().await?;
        }
        self.planner.override_feed(percent);
        self.policy.note_news();
        Ok(())
    }

    /// Adds the chords that form one line and wait to be continued to the look-ahead, as settings of the planner
    /// require before they change. False if there are none.
    pub(in crate::machine::main_loop) fn close_line(&mut self) -> bool {
        let is_closed = self.planner.close_line(&self.settings);
        if is_closed {
            self.note_path();
        }
        is_closed
    }

    /// Gives the other contexts the planned path.
    pub(in crate::machine::main_loop) fn note_path(&self) {
        let (moves, path) = self.planner.planned();
        self.status.set_planned(moves, path);
    }
}
