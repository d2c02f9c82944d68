//! Reports of the storage: by M500 to M504, and at the start.

use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::storage_news::{Slots, StorageNews};
use crate::storage::Rejected;

/// Reports news of the storage.
pub(in crate::machine) fn report_storage(to: &mut ReplyWriter<'_>, news: &StorageNews) {
    match *news {
        StorageNews::Saved(receipt) => to.say(text!("echo:Settings Stored {receipt}")),
        StorageNews::NoMachine(why) => to.say(text!("echo:Settings not stored: {why}")),
        StorageNews::NotSaved(error) => to.say(text!("echo:Settings not stored: {error}")),
        StorageNews::MachineWaits => {
            to.say(text!(
                "echo:Settings not stored: a new machine is stored, which takes effect after the next \
                reset"
            ));
        }
        StorageNews::NotLoaded(why) => to.say(text!("echo:Settings unchanged: {why}")),
        StorageNews::Unchanged(error) => to.say(text!("echo:Settings unchanged: {error}")),
        StorageNews::Unanswered(error) => to.say(text!("echo:{error}")),
        StorageNews::Unreadable(error) => {
            to.say(text!("echo:{error}"));
            report_defaults(to);
        }
        StorageNews::Loaded { rejected, receipt, unknown } => {
            report_rejected(to, rejected);
            report_unknown(to, unknown);
            match receipt {
                Some(receipt) => to.say(text!("echo:stored settings retrieved {receipt}")),
                None => report_defaults(to),
            }
        }
        StorageNews::Checked { rejected, receipt, unknown } => {
            report_rejected(to, rejected);
            report_unknown(to, unknown);
            match receipt {
                Some(receipt) => to.say(text!("echo:stored settings valid {receipt}")),
                None => to.say(text!("echo:no valid settings stored")),
            }
        }
        StorageNews::Defaults => report_defaults(to),
    }
}

fn report_defaults(to: &mut ReplyWriter<'_>) {
    to.say(text!("echo:Hardcoded Default Settings Loaded"));
}

/// Names stored settings that this firmware does not have; 0 is none.
fn report_unknown(to: &mut ReplyWriter<'_>, ids: [u16; 4]) {
    for id in ids.into_iter().filter(|id| *id > 0) {
        to.say(text!("echo:stored setting {id} is of later firmware: kept, not used"));
    }
}

/// Names the slots with unused content; an empty slot is not reported.
fn report_rejected(to: &mut ReplyWriter<'_>, slots: Slots) {
    for (slot, why) in slots {
        if let Some(why) = why.filter(|why| *why != Rejected::Blank) {
            to.say(text!("echo:storage slot {slot} not used: {why}"));
        }
    }
}
