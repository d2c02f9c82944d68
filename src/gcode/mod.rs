//! G-code: one line of text in, one [`Command`] out.
//!
//! The dialect is the one that slicers and hosts write for Marlin 2. This room knows words and numbers,
//! but neither line numbers and checksums (room `protocol`) nor the meaning of a command (room `machine`).
//! It keeps no state: a line means the same whatever came before it.

mod code;
mod command;
mod grammar;
mod lexer;
mod m_codes;
mod named;
mod number;
mod parse;
mod print;
mod quiet;
mod shaping;
mod text;

pub use command::{ArcShape, AxisFlags, AxisWords, Command, Flaw, Form, Plane, VelocityWords};
pub use number::Number;
pub use parse::parse;
