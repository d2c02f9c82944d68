//! Into the look-ahead: room for a move, the move itself, and the share of the feed that it gets.
//!
//! The amount of motion planned before a line is answered is decided here (`has_room`), by `Settings::lookahead_time`
//! (default in `Settings::prototype`). Without room the look-ahead counts as full to `release` (`note_full`): motion
//! begins, and a slow host's share ends. A fan that waits for its move (`main_loop::heat_poll`) waits by the same
//! exemption; `main_loop::reply` (P of `advanced_ok`) asks for room too. `sim/board/tests/lookahead_time.rs` tests it.
//! docs/explanation/flow.md, docs/reference/host-protocol/pauses.md, README.md, its row in `settings` and
//! `examples/machines/prototype.toml` describe it. M220 is here too.

use super::{Motion, of_grouping};
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::settings::Settings;
use crate::units::{Feed, Instant, Mm, Seconds, Steps, TICKS_PER_SECOND};

impl<W: Wake> Motion<'_, W> {
    /// M220.
    pub const fn feed_percent(&self) -> u16 {
        self.planner.feed_percent()
    }

    /// Plans a move to the whole steps next to a position, where the counts of all motors agree, while the belt or a
    /// motor has the place of z.
    pub fn plan_whole(&mut self, position: [Steps; 4], speed: Feed, has_overrides: bool, settings: &Settings) {
        let [x, y, c, e] = position;
        let [x, y, c] = [x, y, c].map(Steps::wrapping_round);
        let target = Target { position: self.planner.mm([x, y, c, e]), speed, has_overrides, watch: EndstopSet::NONE };
        of_grouping(self.real.grouping(), settings, |settings| self.push(&target, settings));
    }

    /// All planned moves leave, because a command waits for them.
    pub fn release_all(&mut self, settings: &Settings) {
        self.policy.note_awaited();
        self.close_line(settings);
        self.planner.release_all();
    }

    /// Planned moves are made to their end while a command waits for something else. False once nothing moves.
    pub fn let_end(&mut self, settings: &Settings, now: Instant) -> bool {
        self.release_all(settings);
        let has_motion = self.has_motion();
        if !has_motion {
            self.policy.come_to_rest(now);
        }
        has_motion
    }

    /// Whether a target would be a move.
    pub(in crate::machine::main_loop) fn is_move(&self, position: [Mm; 4]) -> bool {
        self.planner.is_move(position)
    }

    /// Whether the look-ahead takes another move: there is a place for it, and the planned moves do not last for too
    /// long. As long as the first waiting move is not final, there are too few moves, however long they last. So a full
    /// look-ahead delays moves, and changes no speed.
    pub(in crate::machine::main_loop) fn has_room(&mut self, settings: &Settings) -> bool {
        let most_ticks = u64::from(settings.lookahead_time.to_bits()) * u64::from(TICKS_PER_SECOND);
        let most_ticks = most_ticks >> Seconds::FRAC_NBITS;
        let planned_ticks = self.planner.waiting() + self.link.left();
        self.planner.has_room() && (planned_ticks < most_ticks || self.planner.lacks_moves())
    }

    /// The number of moves for which there is a place.
    pub(in crate::machine::main_loop) fn room(&mut self, settings: &Settings) -> usize {
        if self.has_room(settings) { self.planner.room() } else { 0 }
    }

    /// Works towards room for another move, which waits for it. True if there is more to do at once.
    pub(in crate::machine::main_loop) fn make_room(&mut self, settings: &Settings) -> bool {
        self.policy.note_full();
        if !self.planner.replan() {
            return true;
        }
        let is_stuck = !self.planner.has_room() && !self.planner.has_ready();
        if is_stuck && !self.close_line(settings) {
            self.planner.release_some();
        }
        is_stuck
    }

    /// Whether the first move that waits needs more moves to follow it. Something that is not a move waits for room
    /// until then.
    pub(in crate::machine::main_loop) fn lacks_moves(&self) -> bool {
        self.planner.lacks_moves()
    }

    /// Something that is not a move waits for room.
    pub(in crate::machine::main_loop) const fn note_full(&mut self) {
        self.policy.note_full();
    }

    /// A move comes for which there is room.
    pub(in crate::machine::main_loop) fn expect(&mut self, target: &Target, now: Instant) {
        if self.planner.was_cut_before(target) {
            self.policy.note_dry();
        }
        self.note_added(now);
        self.follow_stream();
    }

    /// Adds the move.
    pub(in crate::machine::main_loop) fn add(&mut self, target: &Target, settings: &Settings, now: Instant) {
        // The stream may have run dry since the move was expected.
        self.note_added(now);
        self.planner.add(target, settings);
        self.policy.note_news();
        self.note_path();
    }

    /// Adds a single move, which is no part of a stream.
    pub(in crate::machine::main_loop) fn push(&mut self, target: &Target, settings: &Settings) {
        self.planner.push(target, settings);
        self.policy.note_news();
        self.note_path();
    }

    /// A move is about to be added. If an earlier one has left that would have been faster with it, the host was too
    /// slow.
    fn note_added(&mut self, now: Instant) {
        if self.policy.add(now) {
            self.link.status().count_underrun();
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

    /// Whether an earlier change of the feed was carried out.
    pub(in crate::machine::main_loop) fn is_planned(&self) -> bool {
        self.planner.is_planned()
    }

    /// Carries out a part of it; true if it was all.
    pub(in crate::machine::main_loop) fn replan(&mut self) -> bool {
        self.planner.replan()
    }

    /// M220: from now on, and for the moves that wait.
    pub(in crate::machine::main_loop) fn override_feed(&mut self, percent: u16) {
        self.planner.override_feed(percent);
        self.policy.note_news();
    }

    /// Adds the chords that form one line and wait to be continued to the look-ahead, as settings of the planner
    /// require before they change. False if there are none.
    pub(in crate::machine::main_loop) fn close_line(&mut self, settings: &Settings) -> bool {
        let is_closed = self.planner.close_line(settings);
        if is_closed {
            self.note_path();
        }
        is_closed
    }

    /// Gives the other contexts the planned path.
    pub(super) fn note_path(&self) {
        let (moves, path) = self.planner.planned();
        self.link.status().set_planned(moves, path);
        if self.is_on_surface() {
            self.link.status().set_slowed_moves(self.planner.slowed_moves());
        }
    }

    /// Moves planned so far, wrapping.
    pub(in crate::machine::main_loop) const fn planned_moves(&self) -> u32 {
        self.planner.planned().0
    }

    /// Moves that have left the look-ahead so far, wrapping.
    pub(in crate::machine::main_loop) fn moves_left(&self) -> u32 {
        self.planned_moves().wrapping_sub(self.planner.len() as u32)
    }

    /// The filament that the hotend has got with the extruder `at`, in um.
    pub(in crate::machine::main_loop) fn extruded_um(&self, at: Steps) -> i64 {
        self.planner.filament_um(at)
    }

    /// The filament in um that the hotend gets within so many ticks with the extruder `at`, and um/s at their end.
    pub(in crate::machine::main_loop) fn filament_ahead(&mut self, ticks: u64, at: Steps) -> [i64; 2] {
        self.planner.filament_within(ticks, at, self.link.left())
    }
}
