//! M914: the threshold of StallGuard.

use super::drivers::set_drivers;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Part};
use crate::machine::reports::driver_value::DriverValue;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motors and drivers", &[914])
    .grammar(&Grammar::numbers(b"XYZE").parts(&[(b'T', Part::Extruder)]))
    .does("X Y Z E, I", "StallGuard threshold, of one driver of the axis with I; or reports")
    .examples(&[
        ("M914 X300", &["echo:M914 ignored: X300 is out of range (0 to 255), stays 0"]),
        ("M914 X0 W1:2", &[]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    set_drivers(main_loop, DriverValue::StallThreshold, &command.axes(), command.number(b'I'), states)
}
