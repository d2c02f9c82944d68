//! M104, M109, M140, M190, M141, M191: the targets of the heaters; each second code waits for its own.

use super::heating::order_heat;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::connectors::Heater;
use crate::gcode::{Grammar, Nature, Number, Part};

const fn target(numbers: &'static [u16], grammar: &'static Grammar) -> Entry {
    Entry::m("Heat and fans", numbers).nature(Nature::Report).works_if(heats).grammar(grammar)
}

pub(in crate::machine) const HOTEND: Entry =
    target(&[104, 109], &Grammar::numbers(b"SRT").parts(&[(b'T', Part::Tool), (b'I', Part::Preset)]))
        .does("S R T", "target of the hotend; M109 waits, R waits while it cools too")
        .examples(&[
            ("M104 S200", &["echo:no heaters configured"]),
            ("M104 Snan", &["echo:line ignored: S needs a number"]),
            ("M109 S200", &["echo:no heaters configured"]),
        ]);

pub(in crate::machine) const BED: Entry = target(
    &[140, 190],
    &Grammar::numbers(b"SR").parts(&[(b'P', Part::Bed), (b'H', Part::Heater), (b'I', Part::Preset)]),
)
.does("S R", "target of the bed; M190 waits, R waits while it cools too")
.examples(&[
    ("M140 S60", &["echo:no heaters configured"]),
    ("M140 S1,5", &["echo:line ignored: \"S1,5\" is not a letter with a number"]),
    ("M190 S60", &["echo:no heaters configured"]),
]);

pub(in crate::machine) const CHAMBER: Entry =
    target(&[141, 191], &Grammar::numbers(b"SR").parts(&[(b'P', Part::Chamber), (b'H', Part::Heater)]))
        .does("S R", "target of the chamber; M191 waits, R waits while it cools too")
        .examples(&[("M141 S40", &[]), ("M191 S40", &[])]);

/// The codes with their names, the heater, and whether they wait for it.
const TARGETS: [(u16, &str, Heater, bool); 6] = [
    (104, "M104", Heater::Hotend, false),
    (109, "M109", Heater::Hotend, true),
    (140, "M140", Heater::Bed, false),
    (190, "M190", Heater::Bed, true),
    (141, "M141", Heater::Chamber, false),
    (191, "M191", Heater::Chamber, true),
];

/// Whether a target above 0 is to be set. Heat goes off in any state of a print.
fn heats(command: &TableCommand<'_>) -> bool {
    command.number(b'S').or_else(|| command.number(b'R')).is_some_and(|target| target > Number::ZERO)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let Some((_, code, heater, waits)) = TARGETS.into_iter().find(|(code, ..)| *code == command.code()) else {
        return Ok(Answer::Nothing);
    };
    order_heat(main_loop, states, command, code, (heater, waits)).await
}
