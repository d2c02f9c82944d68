//! M122: drivers, belt, overload and heat.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::driver::DriverJob;
use crate::gcode::Nature;
use crate::machine::belt::report::report_belt;
use crate::port::Motor;

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
        main_loop.reply(Answer::Driver(motor, reading)).await?;
    }
    report_belt(main_loop).await?;
    main_loop.tell(Answer::Overload);
    Ok(Answer::Heat)
}
