//! M116: waits for all heaters that are on.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::{Grammar, Nature, Part};
use crate::machine::commands::heating::await_heaters;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Heat and fans", &[116])
    .nature(Nature::Work)
    .grammar(&Grammar::numbers(b"").parts(&[(b'P', Part::Tool)]))
    .does("", "waits for all heaters that are on")
    .examples(&[("M116", &["echo:no heaters configured"])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    _: &OwnCommand<'a>,
) -> Answer<'a> {
    await_heaters(main_loop, &mut states.notices)
}
