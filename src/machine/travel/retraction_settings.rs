//! M207: how G10 retracts. Retracted filament is recovered by the length of its retraction.

use super::retraction::RETRACTION;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Part};
use crate::machine::reports::setting_line::SettingLine;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[207])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"SFZ").parts(&[(b'P', Part::Tool)]))
    .does("S F Z", "retraction: length, speed, lift; or reports")
    .examples(&[
        ("M207 S2 F1800 Z.2", &[]),
        ("M207", &["  M207 S3 F2700 Z0"]),
        (
            "M207 S200 F0",
            &[
                "echo:M207 ignored: S200 is out of range (0 to 100), stays 3",
                "echo:M207 ignored: F0 is out of range (0.6 to 180000), stays 2700",
            ],
        ),
        ("M207 P1 S2", &["echo:M207 ignored: there is no tool 1"]),
        ("M207 Z", &["echo:line ignored: Z needs a number"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { retraction, modal, clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let [length, feed, lift] = [b'S', b'F', b'Z'].map(|letter| command.number(letter));
    if length.or(feed).or(lift).is_none() {
        let line = SettingLine::of_retraction(retraction);
        main_loop.tell(|to, _| to.setting(text!("{line}")));
        return Answer::Said;
    }
    let mut wanted = *retraction;
    if let Some(length) = length {
        clamps.length(modal, ["M207", "S"], length, RETRACTION, &mut wanted.length);
    }
    if let Some(feed) = feed {
        clamps.speed_a_minute(modal, ["M207", "F"], feed, &mut wanted.speed);
    }
    if let Some(lift) = lift {
        clamps.length(modal, ["M207", "Z"], lift, RETRACTION, &mut wanted.lift);
    }
    if !clamps.refuses_line() {
        *retraction = wanted;
    }
    Answer::Nothing
}
