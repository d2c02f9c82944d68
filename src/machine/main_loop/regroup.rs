//! Regrouping: a circulating belt, or one motor of it, takes the place of z in the planner, the generator and the step
//! pins.
//!
//! Motors are regrouped at rest. `belt` gives the reason.

use super::MainLoop;
use super::settings::circulating;
use crate::fault::{Cause, Fault};
use crate::kinematics::Grouping;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::motors::Coupling;
use crate::port::{EndstopSet, Pend};
use crate::units::{Mm, MmPerSec, Steps};

impl<'m, P: PortSet, W: Pend> MainLoop<'m, P, W> {
    /// For which coordinates motors step together.
    pub const fn grouping(&self) -> Grouping {
        self.real.grouping()
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
            self.status.fault().set(Fault::plain(Cause::SettingsDamaged));
        }
        self.power.couple(coupling);
        let groups = self.real.groups();
        let planner = &mut self.planner;
        self.settings.of_grouping(grouping, |settings| planner.regroup(settings, groups));
        self.adopt_exactly(position).await
    }
}
