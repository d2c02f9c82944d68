//! M154, M155: position and temperatures every S seconds.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature, Number};
use crate::machine::hosts::schedule::{PERIOD_S, Report};
use crate::machine::state::clamps::Clamps;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[154, 155])
    .nature(Nature::Report)
    .mark(Mark::SaidOnConnecting)
    .grammar(&Grammar::numbers(b"S"))
    .does("S", "position, temperatures every S s")
    .examples(&[
        ("M154", &[]),
        ("M154 S5", &[]),
        ("M154 S-1", &["echo:M154 S-1 is out of range, set to 0"]),
        ("M155 S2", &[]),
        ("M155 S99", &["echo:M155 S99 is out of range, set to 60"]),
        ("M155 S", &["echo:line ignored: S needs a number"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let report = if command.code() == 154 { Report::Position } else { Report::Temperatures };
    report_every(main_loop, clamps, report, command.number(b'S'))
}

/// Without S nothing changes.
pub(in crate::machine) fn report_every<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    report: Report,
    seconds: Option<Number>,
) -> Answer<'static> {
    if let Some(seconds) = seconds.and_then(|s| clamps.whole_of([report.code(), "S"], s, PERIOD_S, None)) {
        main_loop.hosts.schedule(report, seconds as u8, main_loop.now());
    }
    Answer::Nothing
}
