//! G-code: one line of text in, one [`Command`] out.
//!
//! The dialect is that which slicers and hosts write for Marlin 2, plus the commands of Klipper, RepRapFirmware and
//! Prusa in sliced files. This room knows the forms of words, and the rules that a command may have for its own:
//! letters that need a number, illegal numbers, parts that are not there. It reads the words of moves, because most
//! lines are moves. Room `machine` has all other commands; room `protocol` has already removed a line's number and
//! checksum. No state is kept: a line gives the same command after any other lines.
//!
//! The table of codes and names belongs to room `machine`, where a file has all of a command. `parse_with` gets it, and
//! makes the command of a line: `commands`. `index` has the parts that words select. The other files read letters,
//! numbers and axes.

mod axes;
mod code;
mod commands;
mod index;
mod lexer;
mod number;
mod parse;
mod parts;

pub use commands::{
    Command, Entry, Example, Grammar, Line, Mark, MoveCommand, NO_AXES, Nature, Pair, Row, TableCommand, Text,
    Treatment, Verdict, flaw_of_pairs, times_ten_to,
};
pub use index::{Absent, Named, Part, absent_extruder};
pub use lexer::{Word, Words, numbers, skip_blanks};
pub use number::Number;
pub use parse::parse_with;
pub use parts::{ArcShape, ArcWords, AxisFlags, AxisWords, Flaw, Plane};
