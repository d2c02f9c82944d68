//! To rest: the end of the motion is awaited, or the motion is stopped; and where the machine stands then.

use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::motion::{Work, stiffenings, taps};
use crate::port::{Clock, Pend};
use crate::units::Steps;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
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
        let real = self.retraction.commanded(self.seen(self.planner.mm(real)));
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
        self.end_circulation().await?;
        self.end_trim().await?;
        self.end_measuring().await?;
        if self.homed.stop() {
            self.tell(Answer::Line("echo:homing was ended, the axis has no known position")).await?;
        }
        Ok(())
    }

    /// Tells the planner and the generator where the machine stands, and the generator anew what it follows, which may
    /// have been dropped with the motion. Motion rests.
    pub(in crate::machine) async fn adopt_position(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
        self.adopt_exactly(self.real.whole_steps_away(position, self.link.counts())).await
    }

    /// The same of a position that rounds to where every motor stands.
    pub(in crate::machine) async fn adopt_exactly(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
        self.planner.stand_at(position);
        self.real.adopt(position, self.link.counts());
        self.until(|c| c.link.has_room()).await?;
        if self.real.has_regrouped() {
            self.link.send(Work::Regroup(self.real.grouping()));
            self.until(|c| c.link.has_room()).await?;
        }
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
