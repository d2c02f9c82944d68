//! What M122 says of the belt: whether its motors are aligned, whether its drivers have made the steps that the firmware counts, and how
//! long ago the switches of x and y showed where the tool is.

use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::BeltAnswer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// M122, the part of the belt; nothing on a machine whose motors cannot pull against each other.
pub(in crate::machine) async fn report_belt<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let residuals = main_loop.residuals();
    if residuals.is_empty() {
        return Ok(());
    }
    main_loop.reply(Answer::Belt(BeltAnswer::State)).await?;
    // Drivers are asked where they stand at rest: on the way there is another place for each answer.
    if main_loop.trimming().is_aligned() && !main_loop.has_motion() && main_loop.has_power(residuals.motors()) {
        for (number, residual) in residuals.iter().enumerate() {
            if let Some(strain) = main_loop.strain(number, residual).await? {
                main_loop.reply(Answer::Belt(BeltAnswer::Fields(strain))).await?;
            }
        }
    }
    let since = main_loop.homed().since_met(main_loop.planned_path());
    main_loop.reply(Answer::Belt(BeltAnswer::Met(since))).await
}
