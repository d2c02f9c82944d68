//! M28, M29: an upload to a card, which there is not. The lines between them are not carried out (`hosts::upload`).

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Mark;

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
        Answer::NoCard(command.trimmed())
    } else {
        main_loop.hosts.end_upload().map_or(Answer::Nothing, Answer::UploadEnded)
    }
}
