//! The door: the parts of the main loop that a command may read and change at once.

use super::MainLoop;
use crate::kinematics::Groups;
use crate::machine::ports::PortSet;
use crate::port::{Clock, Pend};
use crate::units::{Instant, Mm, Steps};

impl<'m, P: PortSet, W: Pend> MainLoop<'m, P, W> {
    /// The time.
    pub fn now(&self) -> Instant {
        self.clock.now()
    }

    /// Whether no motion was requested since the start.
    pub const fn is_fresh(&self) -> bool {
        self.link.is_fresh()
    }

    /// Makes the Stepper read the endstops.
    pub fn look_at_endstops(&self) {
        self.link.look_at_endstops();
    }

    /// M220.
    pub const fn feed_percent(&self) -> u16 {
        self.planner.feed_percent()
    }

    /// The groups of motors in use.
    pub const fn groups(&self) -> &'m Groups {
        self.real.groups()
    }

    /// Where the last planned move ends.
    pub const fn planned_end(&self) -> [Steps; 4] {
        self.planner.end()
    }

    /// The same in mm.
    pub fn planned_end_mm(&self) -> [Mm; 4] {
        self.planner.mm(self.planner.end())
    }

    /// The path of the tool that was planned so far, in mm; it wraps.
    pub const fn planned_path(&self) -> u32 {
        self.planner.path()
    }

    /// A position in steps.
    pub fn to_steps(&self, position: [Mm; 4]) -> [Steps; 4] {
        self.planner.steps(position)
    }

    /// A position in mm.
    pub fn to_mm(&self, position: [Steps; 4]) -> [Mm; 4] {
        self.planner.mm(position)
    }

    /// The program stands where the last planned move ends.
    pub fn stand_at_end(&mut self) {
        self.commanded.stand_at(self.planner.mm(self.planner.end()));
    }
}
