//! Trim: one motor of a belt turns against the others, which strains the belt or takes strain from it.
//!
//! The motor has the place of z meanwhile, as a belt that runs round has ([`circulate`](super::circulate)). What the firmware calls its
//! position stays the same, though the tool goes aside by a quarter of the trim or so.

use crate::kinematics::Grouping;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::port::{Motor, Pend};
use crate::units::Steps;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Turns one motor by so many steps, and no other, when motion rests. All motors of the belt have power.
    pub(super) async fn trim(&mut self, motor: Motor, by: i32) -> Result<(), Interrupt> {
        // A stroke whose driver did not answer may be under way.
        self.finish().await?;
        if by == 0 {
            return Ok(());
        }
        let ([x, y, ..], [.., z, e]) = (self.real_steps(), self.planner.end());
        self.trimming.begin([x, y, z, e]);
        let coupling = self.real.groups_in(Grouping::Trim).trim_coupling(motor);
        let [x, y] = [x, y].map(Steps::wrapping_round);
        self.couple(Grouping::Trim, &coupling, [x, y, Steps::ZERO, e]).await?;
        self.plan_whole([x, y, Steps::wrapping_from_num(by), e], self.settings.belt.max_speed, false);
        self.finish().await?;
        self.end_trim().await
    }

    /// The motor has turned as far as it should, or was stopped: z has its place again. Motion rests.
    pub(in crate::machine) async fn end_trim(&mut self) -> Result<(), Interrupt> {
        if self.real.grouping() != Grouping::Trim {
            return Ok(());
        }
        let held = self.trimming.held();
        let coupling = self.real.groups_in(Grouping::Tool).coupling();
        self.couple(Grouping::Tool, &coupling, held).await?;
        self.modal.position = self.retraction.commanded(self.planner.mm(self.planner.end()));
        Ok(())
    }
}
