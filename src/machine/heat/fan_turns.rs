//! M123: how fast fans turn, at once or every S seconds.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature};
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::hosts::schedule::Report;
use crate::machine::messages::auto_reports::report_every;
use crate::machine::reports::fan_report::FanTurns;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[123])
    .nature(Nature::Report)
    .mark(Mark::SaidOnConnecting)
    .grammar(&Grammar::numbers(b"S"))
    .does("S", "turns of fans with a tachometer, or every S s")
    .examples(&[
        ("M123", &["echo:no fan has a tachometer"]),
        ("M123 S5", &[]),
        ("M123 S61", &["echo:M123 S61 is out of range, set to 60"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.number(b'S') {
        Some(seconds) => report_every(main_loop, clamps, Report::FanTurns, Some(seconds)),
        None => Answer::words(&say_turns),
    }
}

fn say_turns(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    let turns = FanTurns { settings: facts.settings, heat: facts.status.heat() };
    if turns.has_any() {
        to.say(text!("{turns}"));
    } else {
        to.say(text!("echo:no fan has a tachometer"));
    }
}
