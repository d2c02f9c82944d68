//! M107: a fan is off, in its turn among the moves.

use super::fans::order_fan;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Number};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[107])
    .grammar(&Grammar::numbers(b"P"))
    .does("P", "fan P is off")
    .examples(&[("M107", &[]), ("M107 P2", &["echo:fan 2 is not commanded"])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    order_fan(main_loop, states, command, Number::ZERO)
}
