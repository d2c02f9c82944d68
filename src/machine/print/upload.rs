//! M28, M29: an upload to a card, which there is not. The lines between them are not carried out (`hosts::upload`).

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Mark;
use crate::protocol::Echo;

/// Without a grammar: the name of a file stands behind it.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Jobs, pauses and waits", &[28, 29])
    .mark(Mark::ActsInUpload)
    .does("", "an upload to a card: answered, not stored, not carried out")
    .examples(&[("M28 a.gco", &["echo:open failed, File: a.gco. There is no card; *"]), ("M29", &[])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    if command.code() == 28 {
        main_loop.hosts.begin_upload(main_loop.now());
        // Marlin's words (language.h, STR_SD_OPEN_FILE_FAIL).
        let name = Echo(command.trimmed());
        main_loop.say(text!("echo:open failed, File: {name}. There is no card; lines up to M29 are ignored"));
        return Answer::Said;
    }
    let Some(lines) = main_loop.hosts.end_upload() else { return Answer::Nothing };
    tell_of_end(main_loop, lines);
    Answer::Said
}

/// An upload has ended; this many lines were not carried out.
pub(in crate::machine) fn tell_of_end<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, lines: u32) {
    main_loop.say(text!("echo:upload ended: there is no card, ignored lines: {lines}"));
}
