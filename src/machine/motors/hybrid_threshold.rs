//! M913: the speed above which spreadCycle replaces stealthChop.

use super::drivers::set_drivers;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Part};
use crate::machine::reports::driver_value::DriverValue;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motors and drivers", &[913])
    .grammar(&Grammar::numbers(b"XYZE").parts(&[(b'I', Part::Driver), (b'T', Part::Extruder)]))
    .does("X Y Z E", "speed above which stealthChop ends, mm/s; or reports")
    .examples(&[
        ("M913 X-5", &["echo:M913 ignored: X-5 is out of range (0 to 3000), stays 0"]),
        ("M913 I 2X100", &["echo:M913 ignored: there is no driver of an axis 2"]),
        ("M913 X0 W100", &[]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    set_drivers(main_loop, DriverValue::HybridThreshold, &command.axes(), None, states)
}
