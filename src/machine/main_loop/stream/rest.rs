//! To rest: the end of the motion is awaited, or the motion is stopped; and where the machine stands then.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::waiting::Waiting;
use crate::motion::{AXES, Work, stiffenings, taps};
use crate::port::Wake;
use crate::settings::Shapers;
use crate::units::Steps;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Waits until everything planned has been stepped.
    pub async fn finish(&mut self) -> Result<(), Interrupt> {
        self.come_again();
        self.until(|c| {
            c.motion.release_all(&c.settings);
            !c.motion.has_motion()
        })
        .await?;
        self.motion.come_to_rest(self.now());
        Ok(())
    }

    /// Drops all motion and waits until the steps have stopped. The commanded position becomes the real one. A quick
    /// stop that comes meanwhile is returned at the end.
    pub async fn drop_motion(&mut self) -> Result<(), Interrupt> {
        self.motion.drop_all();
        let mut stopped = Ok(());
        while !self.motion.is_dropped() {
            match self.poll().await {
                Err(interrupt @ (Interrupt::Halt | Interrupt::Limp)) => return Err(interrupt),
                // The command that drops its motion is stopped afterwards.
                Err(Interrupt::QuickStop) => stopped = Err(Interrupt::QuickStop),
                Err(Interrupt::NoPower | Interrupt::EndJob) | Ok(()) => {}
            }
        }
        let real = self.motion.restart(self.now());
        self.adopt_position(real).await?;
        let (_, z) = self.circulation.z();
        let stands = self.motion.seen(self.motion.to_mm(real), z, self.trimming.held());
        self.commanded.fall_short(stands);
        stopped
    }

    /// M410: motion slows down along its path, until it has stopped. Time that is let pass has no path.
    pub async fn slow_down(&mut self) -> Result<(), Interrupt> {
        if self.pauses.is_dwelling() {
            return Ok(());
        }
        self.motion.brake();
        while !self.motion.has_stopped() {
            if let Err(interrupt @ (Interrupt::Halt | Interrupt::Limp)) = self.poll().await {
                return Err(interrupt);
            }
        }
        Ok(())
    }

    /// Lets time pass in the motion itself, which rests; M108 ends it.
    pub async fn let_pass(&mut self, ms: u32) -> Result<(), Interrupt> {
        self.until(|c| c.motion.has_room_for_work()).await?;
        self.pauses.begin(Waiting::Time);
        self.motion.dwell(ms);
        self.until(|c| c.pauses.is_over() || c.motion.is_idle()).await?;
        if !self.motion.is_idle() {
            self.drop_motion().await?;
        }
        Ok(())
    }

    /// Gives the planner and the generator the machine's position. Gives the generator its functions for each axis
    /// again, which may have been dropped with the motion. Motion rests.
    pub async fn adopt_position(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
        self.adopt_exactly(self.motion.whole_steps_away(position)).await
    }

    /// The same of a position that rounds to where every motor stands.
    pub(in crate::machine::main_loop) async fn adopt_exactly(&mut self, position: [Steps; 4]) -> Result<(), Interrupt> {
        let regrouped = self.motion.adopt(position);
        self.until(|c| c.motion.has_room_for_work()).await?;
        if let Some(grouping) = regrouped {
            self.motion.send(Work::Regroup(grouping));
            self.until(|c| c.motion.has_room_for_work()).await?;
        }
        let mut part = 0;
        while let Some(work) = self.motion.surface_work(part) {
            self.motion.send(work);
            self.until(|c| c.motion.has_room_for_work()).await?;
            part += 1;
        }
        self.motion.send(Work::Position(position));
        self.follow().await
    }

    /// Gives the generator the function that each axis follows. Motion rests.
    pub(in crate::machine::main_loop) async fn follow(&mut self) -> Result<(), Interrupt> {
        let shapers = self.settings.shapers;
        self.follow_through(shapers).await
    }

    /// The same with these shapers.
    pub(in crate::machine::main_loop) async fn follow_through(&mut self, shapers: Shapers) -> Result<(), Interrupt> {
        let window = self.motion.use_advance(&self.settings);
        for (axis, stiffening) in stiffenings(&self.settings).into_iter().enumerate() {
            self.until(|c| c.motion.has_room_for_work()).await?;
            self.motion.send(Work::Stiffen(axis as u8, stiffening));
        }
        // Found again for each axis, because a vector that waits here would have to be dropped. Every future of the
        // Console would get code that drops it, 8 KB in all.
        for axis in 0..AXES {
            self.until(|c| c.motion.has_room_for_work()).await?;
            if let Some(taps) = taps(&shapers, window).into_iter().nth(axis) {
                self.motion.send(Work::Follow(axis as u8, taps));
            }
        }
        Ok(())
    }
}
