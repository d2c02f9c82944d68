//! M141, M191: the target of the chamber; M191 waits for it.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::connectors::Heater;
use crate::gcode::{Grammar, Nature, Part};
use crate::machine::commands::heating::order_heat;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Heat and fans", &[141, 191])
    .nature(Nature::Heat)
    .grammar(&Grammar::numbers(b"SR").parts(&[(b'P', Part::Chamber), (b'H', Part::Heater)]))
    .does("S R", "the same for the chamber")
    .examples(&[("M141 S40", &[]), ("M191 S40", &[])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    let waits = command.code() == 191;
    order_heat(main_loop, states, command, if waits { "M191" } else { "M141" }, (Heater::Chamber, waits))
}
