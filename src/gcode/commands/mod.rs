//! Commands: the request in a line of G-code.
//!
//! | file | holds |
//! |---|---|
//! | [`moves`] | moves, with their words |
//! | [`entry`] | a row of the machine's table, and a command that it has |
//! | [`row`] | the parts of a row |
//! | [`grammar`] | the rules for words, and the lines that break them |
//! | [`pairs`] | the words of Klipper's commands |

pub(super) mod entry;
pub(super) mod grammar;
pub(super) mod moves;
mod pairs;
pub(super) mod row;

use super::parts::Flaw;
pub use entry::{Entry, Example, Line, Mark, Nature, Row, TableCommand, Verdict};
pub use grammar::{Grammar, NO_AXES};
pub use moves::MoveCommand;
pub use pairs::{Pair, flaw_of_pairs, times_ten_to};
pub use row::{Text, Treatment};

/// A command; every one is answered with one `ok`. Lengths are in the units that G20/G21 chose.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Command<'a> {
    /// A move.
    Move(MoveCommand),
    /// A command of the machine's table.
    Table(TableCommand<'a>),
    /// A condition: which lines run depends on it, and this firmware runs them all.
    Condition,
    /// A command that hosts and slicers send and that needs no answer but `ok`.
    Silent,
    /// A known command on a line that is not in order.
    Malformed(Flaw<'a>),
    /// Anything else, as it came.
    Unknown(&'a [u8]),
}
