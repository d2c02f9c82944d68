//! T: the only tool. Another one is answered by the words by which OctoPrint learns that it is not there.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Absent, Flaw, Mark, Named, Nature, Part, Verdict};

pub(in crate::machine) const ENTRY: Entry = Entry::t("Motion")
    .nature(Nature::Mode)
    .mark(Mark::SaidOnConnecting)
    .judge(|number, _| judge(number))
    .does("", "the only tool; another one is answered `echo:T1 Invalid extruder` once a print")
    .examples(&[("T0", &[]), ("T1", &["echo:T1 Invalid extruder"]), ("Tx", &[])]);

/// The highest number of a tool in any firmware; beyond it a T is something else, or damaged.
const MOST_TOOLS: u16 = 255;

const fn judge(number: u16) -> Verdict<'static> {
    match number {
        0 => Verdict::InOrder,
        1..=MOST_TOOLS => {
            Verdict::Flawed(Flaw::Absent(Absent { command: Named::Code(b'T', number), part: Part::Tool, which: b"" }))
        }
        _ => Verdict::Unknown,
    }
}

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    Answer::Nothing
}
