//! G-code: one line of text in, one [`Command`] out.
//!
//! The dialect is the one that slicers and hosts write for Marlin 2, with the commands of Klipper, RepRapFirmware and
//! Prusa that stand in sliced files. This room knows what each command takes: its letters, the names that other
//! firmwares give it, which of its numbers are illegal, what a missing one means, and which commands need nothing but
//! `ok`. What a command then does is for room `machine`; a line's number and checksum were taken off by room
//! `protocol`. No state is kept: a line gives the same command whatever came before it.
//!
//! `parse` finds the code and hands over to `m_codes` (M), `named` (Klipper's names), `text` (lines with a text for
//! people), `heat` or `shaping`; `grammar` says which lines are not in order, `index` which
//! words are for parts that are not there, `quiet` which commands need only `ok` because
//! the machine has nothing to do for them.

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
