//! M116: waits for all heaters that are on.

use super::heating::await_heaters;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Part};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[116])
    .nature(Nature::Work)
    .grammar(&Grammar::numbers(b"").parts(&[(b'P', Part::Tool)]))
    .does("", "waits for all heaters that are on")
    .examples(&[("M116", &["echo:no heaters configured"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    _: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    await_heaters(main_loop, &mut states.notices).await
}
