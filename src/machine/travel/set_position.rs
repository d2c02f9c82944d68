//! G92: the present position is called this from now on.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{AxisFlags, AxisWords, Grammar, NO_AXES, Nature, Number};
use crate::machine::state::modal::FARTHEST;
use crate::units::Mm;

pub(in crate::machine) const ENTRY: Entry = Entry::g("Motion", &[92])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"").no_axes(NO_AXES))
    .does("X Y Z E", "names the present position; all 0 without words")
    .examples(&[
        ("G92 E0", &[]),
        ("G92 X99999999999", &["echo:G92 ignored: X1000000000 is out of range (-10000 to 10000)"]),
        ("G92 C0", &["echo:line ignored: there is no axis C"]),
    ]);

/// A letter without a number is zero, and so is everything if there is no letter.
fn words(command: &TableCommand<'_>) -> AxisWords {
    let (AxisWords { x, y, z, e }, flags) = (command.axes(), command.flags());
    let all = flags == AxisFlags::default();
    let word = |number: Option<Number>, is_named| (all || is_named).then(|| number.unwrap_or_default());
    AxisWords { x: word(x, flags.x), y: word(y, flags.y), z: word(z, flags.z), e: word(e, flags.e) }
}

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let words = words(command);
    for (axis, word) in [("X", words.x), ("Y", words.y), ("Z", words.z)] {
        if let Some(number) = word {
            clamps.length_of::<Mm>(modal, ["G92", axis], number, FARTHEST, None);
        }
    }
    if !clamps.refuses_line() {
        main_loop.commanded.rename(&words, modal);
    }
    Answer::Nothing
}
