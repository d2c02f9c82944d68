//! M503: all settings, as the lines that set them.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

pub(in crate::machine) const ENTRY: Entry =
    Entry::m("Settings", &[503]).nature(Nature::Report).does("S", "reports all settings; S0 as lines to send back");

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { retraction, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    Answer::Settings { retraction: *retraction, for_replay: command.switch() == Some(false) }
}
