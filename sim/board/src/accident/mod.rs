//! Accidents: what breaks in the simulated machine, where, how much of it, and when. One grammar for all of it:
//! `WHAT[:WHERE[:HOW]]@TIME[+TIME]`.
//!
//! One row of [`ROWS`] is one accident. The command's help and its completion, the page's list,
//! docs/reference/accidents.md, the errors and the soaks follow that table, and no other list of these words exists.
//! Two rows may have one word: then the place says which is meant. `loose` is a sensor's contact, or the screw of a
//! pulley.
//!
//! | file | job |
//! |---|---|
//! | `table` | the rows, and the families with their clocks |
//! | `read` | a text becomes an accident, and an accident a text |
//! | `error` | why a text is none |
//! | `earlier` | the spelling of brakes before there was one grammar |
//! | `effect` | what an accident does to heat and to a probe; the belt plant has its own |
//! | `words` | the table for people: help, completion, the page of the docs |

mod earlier;
mod effect;
mod error;
mod read;
pub mod table;
pub mod words;

pub(crate) use effect::NO_PROBE;
pub use error::AccidentError;
pub use read::Accident;
pub use table::{Family, Place, ROWS, Row};

/// The grammar.
pub const GRAMMAR: &str = "WHAT[:WHERE[:HOW]]@TIME[+TIME]";

#[cfg(test)]
mod tests;
