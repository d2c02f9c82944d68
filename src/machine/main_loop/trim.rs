//! Trim: one motor of a belt turns against the others, which strains the belt or takes strain from it.
//!
//! The motor takes the place of z during a trim, as a circulating belt does (`belt::circulate`). The position in the
//! firmware stays the same, though the tool moves by about a quarter of the trim.

use crate::kinematics::{Grouping, Residual};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::{Motor, Pend};
use crate::units::Steps;

/// The motor of a residual that is turned against the others, and its part of the sum.
pub(in crate::machine) fn trimmed(residual: &Residual) -> Option<(Motor, i32)> {
    Motor::ALL.into_iter().zip(*residual).find(|(_, times)| *times != 0)
}

/// Residual caused by a preload in steps: the trimmed motor turns by it.
pub(in crate::machine) fn preload_of(residual: &Residual, preload: i32) -> i32 {
    trimmed(residual).map_or(0, |(_, times)| preload * times.abs())
}

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// Turns one motor by `by` steps, and no other, when motion rests. All motors of the belt have power.
    pub async fn trim(&mut self, motor: Motor, by: i32) -> Result<(), Interrupt> {
        // A stroke may still be moving if its driver did not answer.
        self.finish().await?;
        if by == 0 {
            return Ok(());
        }
        let ([x, y, ..], [.., z, e]) = (self.real_steps(), self.planner.end());
        self.trimming.begin([x, y, z, e]);
        let coupling = self.real.groups_in(Grouping::Trim).trim_coupling(motor);
        let [x, y] = [x, y].map(Steps::wrapping_round);
        self.couple(Grouping::Trim, &coupling, [x, y, Steps::ZERO, e]).await?;
        self.plan_whole([x, y, Steps::wrapping_from_num(i64::from(by)), e], self.settings.belt.max_speed, false);
        self.finish().await?;
        self.end_trim().await
    }

    /// The motor has finished its turn, or was stopped: z has its place again. Motion rests.
    pub async fn end_trim(&mut self) -> Result<(), Interrupt> {
        if self.real.grouping() != Grouping::Trim {
            return Ok(());
        }
        let held = self.trimming.held();
        let coupling = self.real.groups_in(Grouping::Tool).coupling();
        self.couple(Grouping::Tool, &coupling, held).await?;
        self.stand_at_end();
        Ok(())
    }
}
