//! Commands that are refused in words.

use crate::gcode::RefusedCommand;
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// Answers a command that is refused.
pub(super) async fn carry_out<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    command: RefusedCommand,
) -> Result<Answer<'static>, Interrupt> {
    match command {
        RefusedCommand::Conditional => {
            main_loop
                .reply(Answer::Line("Error:this line decides which lines run, and this firmware cannot skip lines"))
                .await?;
            Err(Interrupt::Halt)
        }
    }
}
