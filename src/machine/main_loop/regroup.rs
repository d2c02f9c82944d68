//! Regrouping: a circulating belt, or one motor of it, takes the place of z in the planner, the generator and the step
//! pins.
//!
//! Motors are regrouped at rest. `belt` gives the reason.

use super::MainLoop;
use crate::fault::{Cause, Fault};
use crate::kinematics::{Grouping, Residuals};
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::motors::Coupling;
use crate::port::{DriverBus, EndstopSet, Pend};
use crate::settings::{AxisSettings, Settings};
use crate::units::{Mm, MmPerSec, Steps};

/// The settings of motion while the belt has the place of z.
fn circulating(s: &Settings) -> Settings {
    let z = AxisSettings {
        steps_per_mm: s.axes.x.steps_per_mm,
        max_speed: s.belt.max_speed,
        max_acceleration: s.belt.max_acceleration,
        length: s.axes.z.length,
    };
    let mut settings = *s;
    settings.axes.z = z;
    settings
}

impl<'m, P: PortSet, W: Pend> MainLoop<'m, P, W> {
    /// The residuals of the motors of x and y: the ways in which they can strain the belt.
    pub fn residuals(&self) -> Residuals {
        Residuals::new(&self.settings.mechanism, self.settings.belt.is_closed)
    }

    /// For which coordinates motors step together.
    pub const fn grouping(&self) -> Grouping {
        self.real.grouping()
    }

    /// Calls `work` with the settings that give the planner its resolutions and limits.
    pub(super) fn with_motion_settings<R>(&self, work: impl FnOnce(&Settings) -> R) -> R {
        match self.real.grouping() {
            Grouping::Tool => work(&self.settings),
            Grouping::Circulation | Grouping::Trim => work(&circulating(&self.settings)),
        }
    }

    /// A position of the planner as people see it: z stands where it stood when the belt took its place.
    pub(super) fn seen(&self, position: [Mm; 4]) -> [Mm; 4] {
        match self.real.grouping() {
            Grouping::Tool => position,
            Grouping::Circulation => {
                let ([x, y, _, e], (_, z)) = (position, self.circulation.z());
                [x, y, z, e]
            }
            Grouping::Trim => {
                let ([.., e], [x, y, z, _]) = (position, self.planner.mm(self.trimming.held()));
                [x, y, z, e]
            }
        }
    }

    /// Plans a move to the whole steps next to a position, where the counts of all motors agree.
    pub fn plan_whole(&mut self, position: [Steps; 4], speed: MmPerSec, has_overrides: bool) {
        let [x, y, c, e] = position;
        let [x, y, c] = [x, y, c].map(Steps::wrapping_round);
        let target = Target { position: self.planner.mm([x, y, c, e]), speed, has_overrides, watch: EndstopSet::NONE };
        self.planner.push(&target, &circulating(&self.settings));
        self.policy.note_news();
        self.note_path();
    }

    /// Regroups the motors at rest; the machine stands at `position` then.
    pub async fn regroup(&mut self, grouping: Grouping, position: [Steps; 4]) -> Result<(), Interrupt> {
        let coupling = self.real.groups_in(grouping).coupling();
        self.couple(grouping, &coupling, position).await
    }

    /// The same with a given coupling.
    pub(super) async fn couple(
        &mut self,
        grouping: Grouping,
        coupling: &Coupling,
        position: [Steps; 4],
    ) -> Result<(), Interrupt> {
        self.real.regroup(grouping);
        if !self.are_groups_whole() {
            // Unused groups are not scrubbed.
            self.link.status().fault().set(Fault::plain(Cause::SettingsDamaged));
        }
        self.ports.drivers.couple(coupling);
        let groups = self.real.groups();
        match grouping {
            Grouping::Tool => self.planner.regroup(&self.settings, groups),
            Grouping::Circulation | Grouping::Trim => self.planner.regroup(&circulating(&self.settings), groups),
        }
        self.adopt_exactly(position).await
    }
}
