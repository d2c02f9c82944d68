//! M208: how G11 differs from G10.

use super::retraction::RETRACTION;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Part};
use crate::machine::reports::setting_line::SettingLine;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[208])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"SF").parts(&[(b'P', Part::Tool)]))
    .does("S F", "recovery: additional length, speed; or reports")
    .examples(&[
        ("M208 S.1", &[]),
        ("M208 F1", &[]),
        ("M208", &["  M208 S0 F480"]),
        ("M208 S-1", &["echo:M208 ignored: S-1 is out of range (0 to 100), stays 0"]),
        ("M208 P1 S2", &["echo:M208 ignored: there is no tool 1"]),
        ("M208 F", &["echo:line ignored: F needs a number"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { retraction, modal, clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let (extra, feed) = (command.number(b'S'), command.number(b'F'));
    if extra.or(feed).is_none() {
        let line = SettingLine::of_recovery(retraction);
        main_loop.tell(|to, _| to.setting(text!("{line}")));
        return Answer::Said;
    }
    let mut wanted = *retraction;
    if let Some(extra) = extra {
        clamps.length(modal, ["M208", "S"], extra, RETRACTION, &mut wanted.extra);
    }
    if let Some(feed) = feed {
        clamps.speed_a_minute(modal, ["M208", "F"], feed, &mut wanted.recover_speed);
    }
    if !clamps.refuses_line() {
        *retraction = wanted;
    }
    Answer::Nothing
}
