//! News of the storage: what M500 to M504 and the start have to say of it.

use crate::machine::reports::speaker::Speaker;
use crate::port::StorageError;
use crate::storage::{Receipt, Rejected, SaveError, Slot, Survey};

/// Why the content of a slot is not used.
type Slots = [(Slot, Option<Rejected>); 2];

/// What there is to tell of the storage.
#[derive(Clone, Copy)]
pub(in crate::machine) enum StorageNews {
    /// M500 did it.
    Saved(Receipt),
    /// M500 did not.
    NotSaved(SaveError),
    /// M501 found no storage.
    Unchanged(StorageError),
    /// M504 found none.
    Unanswered(StorageError),
    /// There was none at the start.
    Unreadable(StorageError),
    /// These settings were found and taken, or the defaults if there is no receipt.
    Loaded { rejected: Slots, receipt: Option<Receipt> },
    /// These settings were found.
    Checked { rejected: Slots, receipt: Option<Receipt> },
    /// M502.
    Defaults,
}

impl StorageNews {
    /// What was found and taken.
    pub fn loaded(survey: &Survey) -> Self {
        Self::Loaded { rejected: survey.rejected, receipt: survey.newest.map(|stored| stored.receipt) }
    }

    /// What was found.
    pub fn checked(survey: &Survey) -> Self {
        Self::Checked { rejected: survey.rejected, receipt: survey.newest.map(|stored| stored.receipt) }
    }
}

/// Says what there is to tell of the storage.
pub(in crate::machine) fn say_storage(to: &mut Speaker<'_>, news: &StorageNews) {
    match *news {
        StorageNews::Saved(receipt) => to.say(format_args!("echo:Settings Stored {receipt}")),
        StorageNews::NotSaved(error) => to.say(format_args!("echo:Settings not stored: {error}")),
        StorageNews::Unchanged(error) => to.say(format_args!("echo:Settings unchanged: {error}")),
        StorageNews::Unanswered(error) => to.say(format_args!("echo:{error}")),
        StorageNews::Unreadable(error) => {
            to.say(format_args!("echo:{error}"));
            say_defaults(to);
        }
        StorageNews::Loaded { rejected, receipt } => {
            say_rejected(to, rejected);
            match receipt {
                Some(receipt) => to.say(format_args!("echo:stored settings retrieved {receipt}")),
                None => say_defaults(to),
            }
        }
        StorageNews::Checked { rejected, receipt } => {
            say_rejected(to, rejected);
            match receipt {
                Some(receipt) => to.say(format_args!("echo:stored settings valid {receipt}")),
                None => to.say(format_args!("echo:no valid settings stored")),
            }
        }
        StorageNews::Defaults => say_defaults(to),
    }
}

fn say_defaults(to: &mut Speaker<'_>) {
    to.say(format_args!("echo:Hardcoded Default Settings Loaded"));
}

/// Names the slots whose content is not used; an empty one is no news.
fn say_rejected(to: &mut Speaker<'_>, slots: Slots) {
    for (slot, why) in slots {
        if let Some(why) = why.filter(|why| *why != Rejected::Blank) {
            to.say(format_args!("echo:storage slot {slot} not used: {why}"));
        }
    }
}
