//! What M122 says of the belt: whether its motors are aligned, whether its drivers have made the steps that the firmware counts, and how
//! long ago the switches of x and y showed where the tool is.

use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::BeltAnswer;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// M122, the part of the belt; nothing on a machine whose motors cannot pull against each other.
pub(in crate::machine) async fn report_belt<P: PortSet, W: Pend>(crank: &mut Crank<'_, P, W>) -> Result<(), Interrupt> {
    let residuals = crank.residuals();
    if residuals.is_empty() {
        return Ok(());
    }
    crank.tell(Answer::Belt(BeltAnswer::State)).await?;
    // Drivers are asked where they stand at rest: on the way there is another place for each answer.
    if crank.trimming().is_aligned() && !crank.has_motion() && crank.has_power(residuals.motors()) {
        for (number, residual) in residuals.iter().enumerate() {
            if let Some(strain) = crank.strain(number, residual).await? {
                crank.tell(Answer::Belt(BeltAnswer::Fields(strain))).await?;
            }
        }
    }
    let since = crank.homed().since_met(crank.planned_path());
    crank.tell(Answer::Belt(BeltAnswer::Met(since))).await
}
