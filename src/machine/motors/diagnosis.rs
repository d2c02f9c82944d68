//! M122: drivers, belt, overload and heat.

use super::driver_report::{Seen, report_driver};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::driver::DriverJob;
use crate::gcode::Nature;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::belt::report::report_belt;
use crate::machine::reports::heat_report::report_heat;
use crate::port::{BoardFacts, Motor};
use crate::status::{Late, Overload};
use crate::units::TICKS_PER_MS;

pub(in crate::machine) const ENTRY: Entry =
    Entry::m("Reports and messages", &[122]).nature(Nature::Report).does("", "drivers, heaters, faults, overload");

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let fitted = main_loop.motion.groups().fitted();
    for motor in Motor::ALL.into_iter().filter(|motor| fitted.has(*motor)) {
        let has_uart = main_loop.power.uarts().has(motor);
        let reading = if has_uart { Some(main_loop.ask_driver(DriverJob::Read, motor).await?) } else { None };
        let seen = reading.map(|reading| reading.map(|reading| Seen::new(main_loop.power.drivers(), motor, reading)));
        main_loop.reply(Answer::words(&|to, facts| report_driver(to, motor, seen.as_ref(), facts.settings))).await?;
    }
    report_belt(main_loop).await?;
    main_loop.tell(|to, facts| report_overload(to, facts.status.overload()));
    for warning in main_loop.board.warnings().into_iter().flatten() {
        main_loop.say(text!("echo:{warning}"));
    }
    let times = main_loop.board.registers_set_right();
    if times > 0 {
        main_loop.say(text!(
            "echo:registers of the heaters changed by themselves and were set right, {times} times: look for a disturbance, \
             such as a loose ground"
        ));
    }
    Ok(Answer::words(&report_heat))
}

/// Overload since the start, and its worst case.
fn report_overload(to: &mut ReplyWriter<'_>, overload: Overload) {
    let Overload { events, spans, starved, underruns } = overload;
    let us = |late: Late| late.worst / const { TICKS_PER_MS / 1000 };
    to.say(text!(
        "echo:overload: {} steps late, worst {} us; {} spans stretched, worst {} us; {starved} times out of steps, \
         {underruns} times out of moves",
        events.count,
        us(events),
        spans.count,
        us(spans)
    ));
}
