//! To rest: the end of the motion is awaited, or the motion is stopped; and where the machine stands then.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::waiting::Waiting;
use crate::motion::{Work, stiffenings, taps};
use crate::port::Pend;
use crate::units::{Steps, SubTicks, TICKS_PER_MS};

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// Whether anything planned has not been stepped yet.
    pub fn has_motion(&self) -> bool {
        !self.planner.is_empty() || !self.link.is_idle()
    }

    /// Waits until everything planned has been stepped.
    pub async fn finish(&mut self) -> Result<(), Interrupt> {
        self.come_again();
        self.until(|c| {
            c.release_all();
            !c.has_motion()
        })
        .await?;
        self.policy.come_to_rest(self.now());
        Ok(())
    }

    /// Drops all motion and waits until the steps have stopped. The commanded position becomes the real one.
    pub async fn drop_motion(&mut self) -> Result<(), Interrupt> {
        self.planner.stand_at(self.planner.end());
        self.link.abort();
        let mut halted = Ok(());
        while !self.link.is_idle() {
            // A second quick stop changes nothing; a halt does.
            match self.poll().await {
                Err(interrupt @ (Interrupt::Halt | Interrupt::Limp)) => halted = Err(interrupt),
                Err(Interrupt::QuickStop | Interrupt::NoPower | Interrupt::EndJob) | Ok(()) => {}
            }
            halted?;
        }
        self.link.restart();
        self.policy.note_awaited();
        self.policy.come_to_rest(self.now());
        let real = self.real_steps();
        self.planner.fall_short(real);
        self.note_path();
        self.adopt_position(real).await?;
        self.commanded.fall_short(self.seen(self.planner.mm(real)));
        Ok(())
    }

    /// M410: motion slows down along its path, until it has stopped. Time that is let pass has no path.
    pub async fn slow_down(&mut self) -> Result<(), Interrupt> {
        if self.pauses.is_dwelling() {
            return Ok(());
        }
        self.link.brake();
        while !self.link.has_stopped() {
            // The path may lead on into moves that are still in the planner, so they keep leaving it.
            if let Err(interrupt @ (Interrupt::Halt | Interrupt::Limp)) = self.poll().await {
                return Err(interrupt);
            }
        }
        Ok(())
    }

    /// Planned moves are made to their end while a command waits for something else. False once nothing moves.
    pub fn let_motion_end(&mut self) -> bool {
        self.release_all();
        let has_motion = self.has_motion();
        if !has_motion {
            self.policy.come_to_rest(self.now());
        }
        has_motion
    }

    /// All planned moves leave, because a command waits for them.
    pub fn release_all(&mut self) {
        self.policy.note_awaited();
        self.close_line();
        self.planner.release_all();
    }

    /// Lets time pass in the motion itself, which rests; M108 ends it.
    pub async fn let_pass(&mut self, ms: u32) -> Result<(), Interrupt> {
        self.until(|c| c.link.has_room()).await?;
        self.pauses.begin(Waiting::Time);
        self.link.send(Work::Dwell(SubTicks::of_ticks(u64::from(ms) * u64::from(TICKS_PER_MS))));
        self.until(|c| c.pauses.is_over() || c.link.is_idle()).await?;
        if !self.link.is_idle() {
            self.drop_motion().await?;
        }
        Ok(())
    }

    /// Gives the planner and the generator the machine's position. Gives the generator its functions for each axis
    /// again, which may have been dropped with the motion. Motion rests.
    pub async fn adopt_position(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
        self.adopt_exactly(self.real.whole_steps_away(position, self.link.counts())).await
    }

    /// The same of a position that rounds to where every motor stands.
    pub(in crate::machine::main_loop) async fn adopt_exactly(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
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

    /// Gives the generator the function that each axis follows. Motion rests.
    pub(in crate::machine::main_loop) async fn follow(&mut self) -> Result<(), Interrupt> {
        let window = self.advance_in_use.follow(&self.settings);
        self.planner.set_advance_window(window);
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
    pub fn real_steps(&self) -> [Steps; 4] {
        self.real.of_axes(self.link.counts())
    }
}
