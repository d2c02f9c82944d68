//! M906: the run current of motors, in mA.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::{Grammar, Part};
use crate::machine::answers::driver_value::DriverValue;
use crate::machine::commands::drivers::set_drivers;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Motors and drivers", &[906])
    .grammar(&Grammar::numbers(b"XYZE").parts(&[(b'T', Part::Extruder)]))
    .does("X Y Z E, I", "run current in mA, of one driver of the axis with I; or reports")
    .examples(&[
        ("M906 X800", &[]),
        ("M906 I0 X700", &[]),
        ("M906 I-1 X700", &[]),
        ("M906 X800 U1:2 E800:700", &[]),
        ("M906 T1 E700", &["echo:M906 ignored: there is no extruder 1"]),
    ]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    set_drivers(main_loop, DriverValue::Current, &command.axes(), command.number(b'I'), states)
}
