//! Commands that end the job, because their missing effect matters.

use super::Command;
use super::row::Described;

/// Commands that end the job, because their missing effect matters.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum RefusedCommand {
    /// M622, M623, `if`, `while` and the like: which lines run depends on it, and this firmware runs them all.
    Conditional,
}

/// They are answered whatever words they have.
pub(super) const ROWS: &[Described] = &[
    Described::m(&[622, 623], |_, _| refused(RefusedCommand::Conditional)).refused(CONDITION),
    // Conditions and loops of RepRapFirmware.
    Described::name(&["if", "elif", "else", "while", "break", "continue", "abort"], |_, _| {
        refused(RefusedCommand::Conditional)
    })
    .refused("the same"),
];

const CONDITION: &str = "a condition: the job ends, because the firmware cannot skip lines";

const fn refused(command: RefusedCommand) -> Option<Command<'static>> {
    Some(Command::Refused(command))
}
