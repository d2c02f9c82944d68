//! The belt's part of M122: alignment, lost steps between drivers and counts, and the path since the switches of x and
//! y were met.

use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::BeltAnswer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::phase::strain;
use crate::machine::ports::PortSet;
use crate::port::Wake;

/// The belt's part of M122; nothing on a machine without motors that can pull against each other.
pub(in crate::machine) async fn report_belt<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let residuals = main_loop.settings.residuals();
    if residuals.is_empty() {
        return Ok(());
    }
    main_loop.tell(Answer::Belt(BeltAnswer::State));
    // Drivers are read only at rest: in motion their positions would change between the replies.
    if main_loop.trimming.is_aligned() && !main_loop.motion.has_motion() && main_loop.power.is_on(residuals.motors()) {
        for (number, residual) in residuals.iter().enumerate() {
            // Against the phase of this alignment: settings may have got another one.
            let phase = main_loop.trimming.found(number).and_then(|found| found.phase);
            let Some(phase) = phase else { continue };
            if let Some(strain) = strain(main_loop, phase.into(), residual).await? {
                main_loop.tell(Answer::Belt(BeltAnswer::Fields(strain)));
            }
        }
    }
    let since = main_loop.homed.since_met(main_loop.motion.path());
    main_loop.tell(Answer::Belt(BeltAnswer::Met(since)));
    Ok(())
}
