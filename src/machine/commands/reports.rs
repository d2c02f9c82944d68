//! Reports and messages.

use super::messages::send_message;
use super::motors::diagnose;
use super::states::States;
use crate::gcode::{Number, ReportCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::hosts::schedule::{PERIOD_S, Report};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::port::Pend;

/// Carries out a command that reports.
pub(super) async fn carry_out<'a, P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &ReportCommand<'a>,
) -> Result<Answer<'a>, Interrupt> {
    let States { clamps, .. } = states;
    Ok(match *command {
        // The receive path passes nothing of it on.
        ReportCommand::LineNumber => Answer::Nothing,
        ReportCommand::ReportPosition { real } => Answer::Position { real },
        ReportCommand::ReportFirmware => Answer::Firmware,
        // There is no display.
        ReportCommand::Message => Answer::Nothing,
        ReportCommand::Tell { form, to, text } => send_message(main_loop, (form, to), text),
        ReportCommand::ReportEndstops => {
            main_loop.motion.look_at_endstops();
            main_loop.poll().await?;
            Answer::Endstops(main_loop.status.endstops())
        }
        ReportCommand::Diagnose => return diagnose(main_loop).await,
        ReportCommand::FanTurns(None) => Answer::FanTurns,
        ReportCommand::FanTurns(seconds) => report_every(main_loop, clamps, Report::FanTurns, seconds),
        ReportCommand::AutoPosition(seconds) => report_every(main_loop, clamps, Report::Position, seconds),
        ReportCommand::AutoReport(seconds) => report_every(main_loop, clamps, Report::Temperatures, seconds),
    })
}

/// M123, M154, M155. Without S nothing changes.
fn report_every<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    report: Report,
    seconds: Option<Number>,
) -> Answer<'static> {
    if let Some(seconds) = seconds.and_then(|s| clamps.whole_of([report.code(), "S"], s, PERIOD_S, None)) {
        main_loop.hosts.schedule(report, seconds as u8, main_loop.now());
    }
    Answer::Nothing
}
