//! M906: the run current of motors, in mA.

use super::drivers::set_drivers;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Part};
use crate::machine::reports::driver_value::DriverValue;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motors and drivers", &[906])
    .grammar(&Grammar::numbers(b"XYZE").parts(&[(b'T', Part::Extruder)]))
    .does("X Y Z E, I", "run current in mA, of one driver of the axis with I; or reports")
    .examples(&[
        ("M906 X800", &[]),
        ("M906 I0 X700", &[]),
        ("M906 I-1 X700", &[]),
        ("M906 X800 U1:2 E800:700", &[]),
        ("M906 T1 E700", &["echo:M906 ignored: there is no extruder 1"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    set_drivers(main_loop, DriverValue::Current, &command.axes(), command.number(b'I'), states)
}
