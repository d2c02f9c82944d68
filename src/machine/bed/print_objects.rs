//! EXCLUDE_OBJECT_DEFINE: an object of the print, by its outline. A mesh can be measured around them.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Mark;
use crate::machine::state::known_bed::PrintArea;

pub(in crate::machine) const ENTRY: Entry = Entry::name("Bed mesh", &["EXCLUDE_OBJECT_DEFINE"])
    .mark(Mark::MayBeCut)
    .does(
        "NAME= CENTER= POLYGON= RESET=",
        "an object of the print: a mesh can be measured around them; none is skipped",
    )
    .examples(&[("EXCLUDE_OBJECT_DEFINE NAME=cube CENTER=10,10 POLYGON=[[5,5],[15,5],[15,15]]", &[])]);

/// The text of POLYGON, or of CENTER without one. A polygon has no blanks, or stands last. `None` for RESET: no object
/// is known.
fn outline(text: &[u8]) -> Option<&[u8]> {
    let behind = |name: &[u8]| {
        let at = text.windows(name.len()).position(|part| part.eq_ignore_ascii_case(name))?;
        text.get(at + name.len()..)
    };
    let outline = behind(b"POLYGON=").or_else(|| behind(b"CENTER="));
    outline.or(if behind(b"RESET=").is_some() { None } else { Some(b"") })
}

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { area, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match outline(command.text()) {
        Some(outline) => area.add_object(outline),
        None => *area = PrintArea::NONE,
    }
    Answer::Nothing
}
