//! M555: the area that the print needs, for the next measurement of the bed.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Grammar;
use crate::machine::state::known_bed::PrintArea;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Bed mesh", &[555])
    .grammar(&Grammar::numbers(b"XYWH"))
    .does("X Y W H", "area that the print needs (Prusa): the next G29 without an area measures no more")
    .examples(&[
        ("M555 X1 Y1 W9 H9", &[]),
        ("M555 X10 Y10 W100 H80", &[]),
        ("M555 X1 Y1", &["echo:M555 names no area: it needs X, Y, W and H"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { area, modal, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    *area = PrintArea::NONE;
    let [x, y, width, depth] = [b'X', b'Y', b'W', b'H'].map(|letter| command.number(letter));
    let (Some(x), Some(y), Some(width), Some(depth)) = (x, y, width, depth) else {
        return Answer::Line(packed!("echo:M555 names no area: it needs X, Y, W and H"));
    };
    let [x, y, width, depth] = [x, y, width, depth].map(|number| modal.length(number));
    *area = PrintArea::of([x, y], [x.saturating_add(width), y.saturating_add(depth)]);
    Answer::Nothing
}
