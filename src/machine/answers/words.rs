//! Words: what writes the lines of an answer, in the file of the command, or of the room that decides it.

use super::reply_writer::ReplyWriter;
use crate::connectors::HEATERS;
use crate::machine::state::trimming::Trimming;
use crate::settings::Settings;
use crate::status::Status;
use crate::storage::StoredMesh;
use crate::units::Celsius;

/// What words may read of the main loop, when they are written. What else they need, a closure captures.
pub(in crate::machine) struct Facts<'f> {
    pub settings: &'f Settings,
    pub status: &'f Status,
    /// Whether the motors of one belt agree.
    pub trimming: &'f Trimming,
    /// The mesh of the bed.
    pub mesh: Option<&'f StoredMesh>,
    /// The ordered targets of the heaters.
    pub targets: [Celsius; HEATERS],
    /// Whether a self-test of the heaters is under way.
    pub is_testing: bool,
    /// Whether there is memory for settings.
    pub has_storage: bool,
}

/// Writes the lines of an answer: a function or a closure. If a line finds no room, all of it runs again later, so it
/// changes nothing. It does not allocate.
pub(in crate::machine) trait Words {
    fn write(&self, to: &mut ReplyWriter<'_>, facts: &Facts<'_>);
}

impl<F: Fn(&mut ReplyWriter<'_>, &Facts<'_>)> Words for F {
    fn write(&self, to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
        self(to, facts);
    }
}
