//! M114: where the program is, or where the tool is.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};
use crate::machine::main_loop::place::tell_place;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[114])
    .nature(Nature::Report)
    .mark(Mark::SaidOnConnecting)
    .does("R", "position; R counts it from the steps made")
    .examples(&[
        ("M114", &["X:100.00 Y:100.00 Z:50.00 E:0.00 C:0.00 Count A:16000 B:0 Z:40000"]),
        ("M114 D", &["X:100.00 Y:100.00 Z:50.00 E:0.00 C:0.00 Count A:16000 B:0 Z:40000"]),
        ("M114 R", &["X:100.00 Y:100.00 Z:50.00 E:0.00 C:0.00 Count A:16000 B:0 Z:40000"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    tell_place(main_loop, command.has(b'R'))
}
