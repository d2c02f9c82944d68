//! The Console's dealings with motion: planning moves, waiting for them, stopping them.

use super::release_policy::{GATHERED, Release};
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::reports::answer::Answer;
use crate::machine::state::modal::FARTHEST;
use crate::machine::state::notices::Notice;
use crate::machine::state::soft_endstops::clamp;
use crate::motion::{Target, Work, stiffenings, taps};
use crate::port::{Clock, EndstopSet, Pend};
use crate::units::{Mm, MmPerSec, Seconds, Steps, TICKS_PER_SECOND};

/// Keeps the tool within what any machine could reach; a point of an arc may lie beyond.
fn bounded(position: [Mm; 4]) -> [Mm; 4] {
    let [x, y, z, e] = position;
    let [x, y, z] = [x, y, z].map(|at| FARTHEST.clamp(at));
    [x, y, z, e]
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Plans a move within the reachable space and takes it as the commanded position.
    pub(in crate::machine) async fn go(&mut self, position: [Mm; 4], speed: MmPerSec) -> Result<(), Interrupt> {
        let (inside, moved) = clamp(bounded(position), self.homed, &self.settings);
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

    fn note_path(&self) {
        let (moves, path) = self.planner.planned();
        self.link.status().set_planned(moves, path);
    }

    /// Hands released moves on, and releases more when it is time.
    pub(in crate::machine) fn feed_motion(&mut self) {
        // Asked at every turn, because that counts up what was stepped.
        self.link.left();
        let level = (self.planner.len() + self.link.level()) as u32;
        self.link.status().set_level(level);
        if self.policy.is_level_telling() {
            self.link.status().note_level(level);
        }
        if self.policy.is_gathering() {
            if self.begin_motion() {
                self.come_again();
            }
            return;
        }
        // One move a turn, so that bytes and emergencies are looked at in between. The next turn follows at once.
        if self.hand_on() {
            self.come_again();
        }
    }

    /// Hands a move on, or lets one go, if it is time.
    fn hand_on(&mut self) -> bool {
        if !self.link.has_room() {
            return false;
        }
        let release = self.policy.release(self.link.level(), self.link.left());
        if release == Release::Nothing {
            return false;
        }
        if self.planner.is_empty() {
            if self.link.is_idle() {
                self.policy.come_to_rest(self.ports.clock.now());
            }
            return false;
        }
        if !self.planner.replan() {
            self.come_again();
            return false;
        }
        if let Some(released) = self.planner.pop() {
            self.link.send(Work::Move(released));
            return true;
        }
        if release == Release::Final {
            return false;
        }
        self.planner.release_next();
        self.policy.note_dry();
        true
    }

    /// Whether motion begins now.
    fn begin_motion(&mut self) -> bool {
        let now = self.ports.clock.now();
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

    /// Whether anything planned has not been stepped yet.
    pub(in crate::machine) fn has_motion(&self) -> bool {
        !self.planner.is_empty() || !self.link.is_idle()
    }

    /// Waits until everything planned has been stepped.
    pub(in crate::machine) async fn finish(&mut self) -> Result<(), Interrupt> {
        self.come_again();
        self.until(|c| {
            c.policy.note_awaited();
            c.planner.release_all();
            !c.has_motion()
        })
        .await?;
        self.policy.come_to_rest(self.ports.clock.now());
        Ok(())
    }

    /// Drops all motion and waits until the steps have stopped. The commanded position becomes the real one.
    pub(in crate::machine) async fn drop_motion(&mut self) -> Result<(), Interrupt> {
        self.planner.stand_at(self.planner.end());
        self.link.abort();
        let mut halted = Ok(());
        while !self.link.is_idle() {
            // A second quick stop changes nothing; a halt does.
            match self.turn().await {
                Err(Interrupt::Halt) => halted = Err(Interrupt::Halt),
                Err(Interrupt::QuickStop | Interrupt::NoPower) | Ok(()) => {}
            }
            halted?;
        }
        self.link.restart();
        self.policy.note_awaited();
        self.policy.come_to_rest(self.ports.clock.now());
        let real = self.real_steps();
        self.planner.fall_short(real);
        self.note_path();
        self.adopt_position(real).await?;
        let real = self.retraction.commanded(self.planner.mm(real));
        self.modal.extrusion = self.modal.named_position(real)[3];
        self.modal.position = real;
        Ok(())
    }

    /// M410: motion slows down along its path and ends; the position stays true.
    pub(in crate::machine) async fn quick_stop(&mut self) -> Result<(), Interrupt> {
        if !self.pauses.is_dwelling() {
            self.link.brake();
            while !self.link.has_stopped() {
                // The path may lead on into moves that have not left the planner, so they go on leaving it.
                if self.turn().await == Err(Interrupt::Halt) {
                    return Err(Interrupt::Halt);
                }
            }
        }
        self.drop_motion().await?;
        if self.homed.stop() {
            self.tell(Answer::Line("echo:homing was ended, the axis has no known position")).await?;
        }
        Ok(())
    }

    /// Tells the planner and the generator where the machine stands, and the generator anew what it follows, which may
    /// have been dropped with the motion. Motion rests.
    pub(in crate::machine) async fn adopt_position(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
        let counts = self.link.counts();
        let position = self.real.whole_steps_away(position, counts);
        self.planner.stand_at(position);
        self.real.adopt(position, counts);
        self.until(|c| c.link.has_room()).await?;
        self.link.send(Work::Position(position));
        self.follow().await
    }

    /// Tells the generator what each axis follows. Motion rests.
    pub(in crate::machine) async fn follow(&mut self) -> Result<(), Interrupt> {
        let window = self.advance_in_use.window(&self.settings);
        for (axis, stiffening) in stiffenings(&self.settings).into_iter().enumerate() {
            self.until(|c| c.link.has_room()).await?;
            self.link.send(Work::Stiffen(axis as u8, stiffening));
        }
        for (axis, taps) in taps(&self.settings.shapers, window).into_iter().enumerate() {
            self.until(|c| c.link.has_room()).await?;
            self.link.send(Work::Follow(axis as u8, taps));
        }
        Ok(())
    }

    /// Where the machine really is, in steps of x, y, z and e.
    pub(in crate::machine) fn real_steps(&self) -> [Steps; 4] {
        self.real.of_axes(self.link.counts())
    }
}
