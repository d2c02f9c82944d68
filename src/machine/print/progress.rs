//! M73: the progress of the print, in percent and remaining minutes.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark};
use crate::settings::Range;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Jobs, pauses and waits", &[73])
    .mark(Mark::SaidOnConnecting)
    .grammar(&Grammar::numbers(b"PR"))
    .does("P R", "keeps percent done and minutes left")
    .examples(&[
        ("M73 P5 R10", &[]),
        ("M73 Q7 S3", &[]),
        (
            "M73 P500 R-5",
            &[
                "echo:M73 ignored: P500 is out of range (0 to 100)",
                "echo:M73 ignored: R-5 is out of range (0 to 65535)",
            ],
        ),
        ("M73 R", &["echo:line ignored: R needs a number"]),
    ]);

const PERCENT: Range<u16> = Range { least: 0, most: 100 };

const MINUTES: Range<u16> = Range { least: 0, most: u16::MAX };

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let percent = command.number(b'P').and_then(|percent| clamps.whole_of(["M73", "P"], percent, PERCENT, None));
    let minutes = command.number(b'R').and_then(|minutes| clamps.whole_of(["M73", "R"], minutes, MINUTES, None));
    if !clamps.refuses_line() {
        main_loop.status.print_progress.note_progress(percent.map(u32::from), minutes.map(u32::from));
    }
    Answer::Nothing
}
