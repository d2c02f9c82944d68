//! Commands: the request in a line of G-code, as a type that cannot hold nonsense; and the table of all codes.
//!
//! | file | holds |
//! |---|---|
//! | [`motion`], [`jobs`], [`settings`], [`motors`] | a family: type, rows and readers |
//! | [`heat`] | rows about heat of other families |
//! | [`probing`], [`bed`], [`resonance`], [`reports`] | the same |
//! | [`refused`], [`silent`] | the same for commands that are not carried out |
//! | [`offset`] | words of the offsets of z, for [`motion`] |
//! | [`pairs`] | the words of Klipper's commands |
//! | [`row`] | the parts of a row |
//! | [`own`] | the rows of another room's own table, and their commands |
//! | [`grammar`] | the rules for words, and the lines that break them |
//! | [`table`] | the rows of all families |

pub(super) mod bed;
pub(super) mod grammar;
mod heat;
mod jobs;
pub(super) mod motion;
mod motors;
mod offset;
pub(super) mod own;
mod pairs;
mod probing;
mod refused;
mod reports;
mod resonance;
pub(super) mod row;
mod settings;
mod silent;
pub(super) mod table;

use super::parts::Flaw;
pub use bed::{BedCommand, Forgets, places};
pub use grammar::Grammar;
pub use jobs::JobCommand;
pub use motion::MotionCommand;
pub use motors::MotorCommand;
pub use own::{Example, Nature, OwnCommand, OwnEntry, OwnRow};
pub use probing::ProbeCommand;
pub use refused::RefusedCommand;
pub use reports::ReportCommand;
pub use resonance::ResonanceCommand;
pub use row::{Text, Treatment};
pub use settings::{SettingCommand, ShaperName};
pub use table::{Line, codes, described, names};

/// A command, by family; every one is answered with one `ok`. Lengths are in the units that G20/G21 chose.
///
/// One that acts at once is a file of `machine::commands::table`. Any other is a variant and a row of its family here,
/// and an arm of the same family in `machine::commands`, for which the compiler asks.
/// `sim/board/tests/commands/table.rs` asks for a row with its answer, `tests/gcode.rs` for a grammar (without one any
/// text is taken), and docs/reference/gcode.md is made from the row. By hand: a code that was ignored leaves `silent`;
/// a code that hosts send to a stopped machine goes into `machine::main_loop::halted`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Command<'a> {
    /// Moves, modes, overrides.
    Motion(MotionCommand),
    /// Jobs, pauses and waits.
    Job(JobCommand<'a>),
    /// Settings, and where they are kept.
    Setting(SettingCommand<'a>),
    /// Motors, their drivers and belts.
    Motor(MotorCommand),
    /// The Z probe.
    Probe(ProbeCommand),
    /// The bed's mesh.
    Bed(BedCommand<'a>),
    /// Resonances.
    Resonance(ResonanceCommand),
    /// Reports and messages.
    Report(ReportCommand<'a>),
    /// A command of another room's own table.
    Own(OwnCommand<'a>),
    /// Known, and refused in words.
    Refused(RefusedCommand),
    /// A command that hosts and slicers send and that needs no answer but `ok`.
    Silent,
    /// A known command on a line that is not in order.
    Malformed(Flaw<'a>),
    /// Anything else, as it came.
    Unknown(&'a [u8]),
}

#[cfg(test)]
mod tests;
