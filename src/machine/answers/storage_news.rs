//! News of the storage: results of M500 to M504 and of the start.

use crate::port::StorageError;
use crate::storage::{Receipt, Rejected, SaveError, Slot, Survey};

/// Why the content of a slot is not used.
pub(in crate::machine) type Slots = [(Slot, Option<Rejected>); 2];

/// The news.
#[derive(Clone, Copy)]
pub(in crate::machine) enum StorageNews {
    /// M500 did it.
    Saved(Receipt),
    /// M500 did not.
    NotSaved(SaveError),
    /// M500 stored nothing: a new machine is stored, which takes effect after the next reset.
    MachineWaits,
    /// M500 stored nothing because the board has no machine; the text gives the reason.
    NoMachine(&'static str),
    /// M501 loaded nothing because the board has no machine; the text gives the reason.
    NotLoaded(&'static str),
    /// M501 found no storage.
    Unchanged(StorageError),
    /// M504 found none.
    Unanswered(StorageError),
    /// There was none at the start.
    Unreadable(StorageError),
    /// These settings were found and taken, or the defaults if there is no receipt.
    Loaded { rejected: Slots, receipt: Option<Receipt>, unknown: [u16; 4] },
    /// These settings were found.
    Checked { rejected: Slots, receipt: Option<Receipt>, unknown: [u16; 4] },
    /// M502.
    Defaults,
}

impl StorageNews {
    /// The survey of a load that succeeded.
    pub fn loaded(survey: &Survey) -> Self {
        let (receipt, unknown) = found(survey);
        Self::Loaded { rejected: survey.rejected, receipt, unknown }
    }

    /// The survey of a check.
    pub fn checked(survey: &Survey) -> Self {
        let (receipt, unknown) = found(survey);
        Self::Checked { rejected: survey.rejected, receipt, unknown }
    }
}

/// The receipt of the newest settings, and the first ids in them that this firmware does not know (0 is none).
fn found(survey: &Survey) -> (Option<Receipt>, [u16; 4]) {
    match &survey.newest {
        Some(stored) => (Some(stored.receipt), stored.unknown.first_ids()),
        None => (None, [0; 4]),
    }
}
