//! M119: which endstops are pressed.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[119])
    .nature(Nature::Report)
    .does("", "endstops and probe")
    .examples(&[("M119", &["Reporting endstop status", "x_min: open", "y_min: open", "z_min: open"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.motion.look_at_endstops();
    main_loop.poll().await?;
    Ok(Answer::Endstops(main_loop.status.endstops()))
}
