//! M104, M109: the target of the hotend; M109 waits for it.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::connectors::Heater;
use crate::gcode::{Grammar, Nature, Part};
use crate::machine::commands::heating::order_heat;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Heat and fans", &[104, 109])
    .nature(Nature::Heat)
    .grammar(&Grammar::numbers(b"SRT").parts(&[(b'T', Part::Tool), (b'I', Part::Preset)]))
    .does("S R T", "target of the hotend; M109 waits, R waits while it cools too")
    .examples(&[
        ("M104 S200", &["echo:no heaters configured"]),
        ("M104 Snan", &["echo:line ignored: S needs a number"]),
        ("M109 S200", &["echo:no heaters configured"]),
    ]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    let waits = command.code() == 109;
    order_heat(main_loop, states, command, if waits { "M109" } else { "M104" }, (Heater::Hotend, waits))
}
