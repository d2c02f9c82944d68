//! Into the look-ahead: a command waits until there is room for its move, and for a change of the feed.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::Wake;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Plans a move as soon as there is room for it.
    pub async fn plan(&mut self, target: Target) -> Result<(), Interrupt> {
        let motors = self.motion.groups().fitted();
        if !self.power.is_on(motors) && self.motion.is_move(target.position) {
            self.power_up(motors).await?;
        }
        while !self.motion.has_room(&self.settings) {
            if self.motion.make_room(&self.settings) {
                self.come_again();
            }
            self.poll().await?;
        }
        self.motion.expect(&target, self.now());
        while !self.motion.replan() {
            self.poll_again().await?;
        }
        let now = self.now();
        self.motion.add(&target, &self.settings, now);
        Ok(())
    }

    /// M220: from now on, and for the moves that wait. An earlier change is carried out first, and moves leave before
    /// the next change. Otherwise a host that changes the feed all the time would keep all moves back.
    pub async fn override_feed(&mut self, percent: u16) -> Result<(), Interrupt> {
        if !self.motion.is_planned() {
            while !self.motion.replan() {
                self.poll_again().await?;
            }
            self.poll_again().await?;
        }
        self.motion.override_feed(percent);
        Ok(())
    }
}
