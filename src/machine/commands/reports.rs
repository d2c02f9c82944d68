//! Reports and messages.

use super::heating::await_readings;
use super::messages::send_message;
use super::motors::diagnose;
use crate::connectors::HEATERS;
use crate::gcode::ReportCommand;
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;

/// Carries out a command that reports.
pub(super) async fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    command: &ReportCommand<'a>,
) -> Result<Answer<'a>, Interrupt> {
    Ok(match *command {
        // The receive path passes nothing of it on.
        ReportCommand::LineNumber => Answer::Nothing,
        ReportCommand::ReportFirmware => Answer::Firmware,
        // There is no display.
        ReportCommand::Message => Answer::Nothing,
        ReportCommand::Tell { form, to, text } => send_message(main_loop, (form, to), text),
        ReportCommand::ReportEndstops => {
            main_loop.motion.look_at_endstops();
            main_loop.poll().await?;
            Answer::Endstops(main_loop.status.endstops())
        }
        ReportCommand::Temperatures => {
            await_readings(main_loop, [true; HEATERS]).await?;
            Answer::Temperatures
        }
        ReportCommand::Diagnose => return diagnose(main_loop).await,
    })
}
