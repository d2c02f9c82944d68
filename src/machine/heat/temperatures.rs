//! M105: the temperatures, in the line of the `ok`.

use super::heating::await_readings;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::connectors::HEATERS;
use crate::gcode::{Mark, Nature};
use crate::machine::reports::heat_report::report_temperatures;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[105])
    .nature(Nature::Report)
    .mark(Mark::AnsweredWhenStopped)
    .mark(Mark::ActsInUpload)
    .does("", "reports temperatures")
    .examples(&[("M105", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    await_readings(main_loop, [true; HEATERS]).await?;
    Ok(Answer::words_with_ok(&report_temperatures))
}
