//! M107: a fan is off, in its turn among the moves.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::{Grammar, Number};
use crate::machine::commands::fans::order_fan;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Heat and fans", &[107])
    .grammar(&Grammar::numbers(b"P"))
    .does("P", "fan P is off")
    .examples(&[("M107", &[]), ("M107 P2", &["echo:fan 2 is not commanded"])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    order_fan(main_loop, states, command, Number::ZERO)
}
