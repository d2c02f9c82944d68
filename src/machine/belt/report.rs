//! What M122 says of the belt: whether its motors are aligned, whether its drivers have made the steps that the firmware counts, and how
//! long ago the switches of x and y showed where the tool is.

use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::BeltAnswer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::port::Pend;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M122, the part of the belt; nothing on a machine whose motors cannot pull against each other.
    pub(in crate::machine) async fn report_belt(&mut self) -> Result<(), Interrupt> {
        let residuals = self.residuals();
        if residuals.is_empty() {
            return Ok(());
        }
        self.tell(Answer::Belt(BeltAnswer::State)).await?;
        // Drivers are asked where they stand at rest: on the way there is another place for each answer.
        if self.trimming.is_aligned() && !self.has_motion() && self.has_power(residuals.motors()) {
            for (number, residual) in residuals.iter().enumerate() {
                if let Some(strain) = self.strain(number, residual).await? {
                    self.tell(Answer::Belt(BeltAnswer::Fields(strain))).await?;
                }
            }
        }
        let since = self.homed.since_met(self.planner.path());
        self.tell(Answer::Belt(BeltAnswer::Met(since))).await
    }
}
