//! G-code: one line of text in, one [`Command`] out.
//!
//! The dialect is that which slicers and hosts write for Marlin 2, plus the commands of Klipper, RepRapFirmware and
//! Prusa in sliced files. This room knows the words of each command: its letters, its names in other firmwares, its
//! illegal numbers, and the meaning of a missing number. It also knows which commands need nothing but `ok`. Room
//! `machine` carries the command out; room `protocol` has already removed a line's number and checksum. No state is
//! kept: a line gives the same command after any other lines.
//!
//! `parse` finds the code and hands over to `m_codes` (M), `named` (Klipper's names), `text` (lines with a text for
//! people), `heat` or `shaping`. `grammar` finds invalid lines, and `index` finds words for missing parts. `quiet`
//! lists commands that need only `ok` because the machine has nothing to do for them.

mod axes;
mod code;
mod command;
mod grammar;
mod heat;
mod index;
mod lexer;
mod m_codes;
mod machine_record;
mod named;
mod number;
mod parse;
mod parts;
mod quiet;
mod shaping;
mod text;

pub use command::Command;
pub use index::{Absent, Named, Part};
pub use named::names;
pub use number::Number;
pub use parse::parse;
pub use parts::{
    ArcShape, Audience, AxisFlags, AxisWords, Flaw, Form, MachineRecord, ModelWords, ParkWords, Plane, VelocityWords,
};
pub use shaping::ShaperName;
