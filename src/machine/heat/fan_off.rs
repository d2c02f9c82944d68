//! M107: a fan is off, in its turn among the moves.

use super::fans::order_fan;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Number};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[107])
    .grammar(&Grammar::numbers(b"P"))
    .does("P", "fan P is off")
    .examples(&[("M107", &[]), ("M107 P2", &["echo:fan 2 is not commanded"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    order_fan(main_loop, states, command, Number::ZERO).await
}
