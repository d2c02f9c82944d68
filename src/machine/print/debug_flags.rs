//! M111: debug flags, of which one is obeyed: a dry run, in which no filament moves.

use crate::gcode::{Entry, Grammar, Mark, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Jobs, pauses and waits", &[111])
    .mark(Mark::SaidOnConnecting)
    .grammar(&Grammar::numbers(b"S"))
    .does("S", "bit 3 is a dry run without filament; or reports")
    .examples(&[
        ("M111 S6", &[]),
        ("M111 S8", &[]),
        ("M111", &["echo:DEBUG:off"]),
        ("M111 S", &["echo:line ignored: S needs a number"]),
    ]);

/// The bit for a dry run (Marlin, MARLIN_DEBUG_DRYRUN).
const DRY_RUN: u32 = 8;

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.number(b'S') {
        Some(bits) => {
            modal.dry_run = bits.to_u32() & DRY_RUN != 0;
            Answer::Nothing
        }
        None => Answer::Line(if modal.dry_run { packed!("echo:DEBUG:DRYRUN") } else { packed!("echo:DEBUG:off") }),
    }
}
