//! The table of commands: a file each, with all of a command.
//!
//! | part of a file | is |
//! |---|---|
//! | `ENTRY` | codes, rules for words, the line of docs/reference/gcode.md, and examples with their answers |
//! | `carry_out` | its effect, at once; the result is its answer, or a next step that the dispatch awaits |
//!
//! Words of an answer are functions in the same file ([`Says`](crate::machine::answers::says::Says)). A command that
//! waits more than once is an arm of its family, one folder up.

mod auto_reports;
mod bed_target;
mod chamber_target;
mod cold_extrusion;
mod controller_fan;
mod debug_flags;
mod driver_current;
mod fan_off;
mod fan_speed;
mod fan_turns;
mod finish;
mod flow_percent;
mod heater_model;
mod heater_self_test;
mod heater_tuning;
mod heaters_reached;
mod home_offsets;
mod hotend_target;
mod hybrid_threshold;
mod inches;
mod plane;
mod position;
mod power_loss;
mod power_off;
mod print_area;
mod progress;
mod recovery;
mod retraction;
mod screw_place;
mod soft_endstops;
mod stall_threshold;

use super::states::States;
use crate::gcode::{self, Command, Example, Line, OwnCommand, OwnEntry, OwnRow, parse_with};
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use core::marker::PhantomData;

/// The list, from which both tables are made.
macro_rules! list {
    ($($file:ident,)*) => {
        const ENTRIES: &[OwnEntry] = &[$($file::ENTRY),*];

        impl<P: PortSet, W: Wake> Effects<P, W> {
            const ALL: [Effect<P, W>; ENTRIES.len()] = [$($file::carry_out),*];
        }
    };
}

list! {
    auto_reports,
    bed_target,
    chamber_target,
    cold_extrusion,
    controller_fan,
    debug_flags,
    driver_current,
    fan_off,
    fan_speed,
    fan_turns,
    finish,
    flow_percent,
    heater_model,
    heater_self_test,
    heater_tuning,
    heaters_reached,
    home_offsets,
    hotend_target,
    hybrid_threshold,
    inches,
    plane,
    position,
    power_loss,
    power_off,
    print_area,
    progress,
    recovery,
    retraction,
    screw_place,
    soft_endstops,
    stall_threshold,
}

/// Carries out a command, and returns its answer.
type Effect<P, W> = for<'m, 'a> fn(&mut MainLoop<'m, P, W>, &mut States, &OwnCommand<'a>) -> Answer<'a>;

/// The effects of the commands, in their order.
struct Effects<P, W>(PhantomData<(P, W)>);

/// The rows without what an image does not need.
static ROWS: [OwnRow; ENTRIES.len()] = {
    let mut rows = [ENTRIES[0].row(); ENTRIES.len()];
    let mut place = 0;
    while place < rows.len() {
        rows[place] = ENTRIES[place].row();
        place += 1;
    }
    rows
};

/// Carries out a command of the table.
pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    Effects::<P, W>::ALL.get(command.place()).map_or(Answer::Nothing, |effect| effect(main_loop, states, command))
}

/// The command of a line, in the machine's own table or in that of `gcode`.
///
/// Never fails: an unknown command is [`Command::Unknown`].
#[must_use]
pub fn parse(line: &[u8]) -> Command<'_> {
    parse_with(&ROWS, line)
}

/// Every row for people. Not for images: the texts would be in them.
pub fn described() -> impl Iterator<Item = Line> {
    gcode::described().chain(ENTRIES.iter().map(OwnEntry::line))
}

/// The codes that are known, as letters and numbers.
pub fn codes() -> impl Iterator<Item = (char, u16)> {
    let codes = |line: Line| line.codes.1.iter().map(move |number| (line.codes.0, *number));
    gcode::codes().chain(ENTRIES.iter().map(OwnEntry::line).flat_map(codes))
}

/// The names that are known.
pub fn names() -> impl Iterator<Item = &'static str> {
    gcode::names().chain(ENTRIES.iter().map(OwnEntry::line).flat_map(|line| line.names).copied())
}

/// Lines with their answers.
pub fn examples() -> impl Iterator<Item = Example> {
    ENTRIES.iter().flat_map(OwnEntry::its_examples)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::collections::BTreeSet;
    use std::string::String;

    #[test]
    fn every_code_stands_once() {
        assert_eq!(codes().count(), codes().collect::<BTreeSet<_>>().len());
    }

    #[test]
    fn every_command_has_an_example() {
        for line in ENTRIES.iter().map(OwnEntry::line) {
            let (letter, numbers) = line.codes;
            for number in numbers {
                let begins = |line: &str| line.split(' ').next() == Some(&std::format!("{letter}{number}") as &str);
                assert!(examples().any(|(line, _)| begins(line)), "{letter}{number}");
            }
        }
        let unknown: std::vec::Vec<String> =
            examples().map(|(line, _)| line.into()).filter(|line: &String| !is_own(line)).collect();
        assert!(unknown.is_empty(), "{unknown:?} belong to other rows");
    }

    fn is_own(line: &str) -> bool {
        matches!(parse(line.as_bytes()), Command::Own(_) | Command::Malformed(_))
    }
}
