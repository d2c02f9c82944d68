//! M140, M190: the target of the bed; M190 waits for it.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::connectors::Heater;
use crate::gcode::{Grammar, Nature, Part};
use crate::machine::commands::heating::order_heat;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Heat and fans", &[140, 190])
    .nature(Nature::Heat)
    .grammar(&Grammar::numbers(b"SR").parts(&[(b'P', Part::Bed), (b'H', Part::Heater), (b'I', Part::Preset)]))
    .does("S R", "the same for the bed")
    .examples(&[
        ("M140 S60", &["echo:no heaters configured"]),
        ("M140 S1,5", &["echo:line ignored: \"S1,5\" is not a letter with a number"]),
        ("M190 S60", &["echo:no heaters configured"]),
    ]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    let waits = command.code() == 190;
    order_heat(main_loop, states, command, if waits { "M190" } else { "M140" }, (Heater::Bed, waits))
}
