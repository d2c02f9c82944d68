//! M410: stops the motion, and drops all queued moves. The receive path has acted on it.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};

/// Without a grammar: it must act in any case.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[410])
    .nature(Nature::Mode)
    .mark(Mark::ActsInUpload)
    .does("", "brakes along the path and drops queued moves; acts at once")
    .examples(&[("M410", &[])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    Answer::Nothing
}
