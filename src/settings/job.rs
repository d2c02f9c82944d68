//! What a print does if an axis is not homed, or the probe does not find the bed.

use super::rows::{Choice, Spec, numbers, rows};
use serde::{Deserialize, Serialize};

/// What a print does then.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum OnFailure {
    /// It ends.
    Cancel,
    /// It is paused, and its line is carried out again when the user goes on.
    Pause,
}

impl Choice for OnFailure {
    const ALL: &'static [(Self, &'static str)] = &[(Self::Cancel, "cancel"), (Self::Pause, "pause")];

    numbers!(Cancel Pause);
}

/// The settings of a print that fails.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct JobSettings {
    /// What it does.
    pub on_failure: OnFailure,
    /// Whether heaters keep their targets if it ends.
    pub keeps_heat: bool,
}

impl JobSettings {
    /// It ends, and nothing stays hot.
    pub(super) const fn prototype() -> Self {
        Self { on_failure: OnFailure::Cancel, keeps_heat: false }
    }
}

rows! {
    for job in |s, _| Some(&mut s.job), named &["job"];

    /// What a print does if an axis is not homed or the probe does not find the bed: "cancel" ends it; "pause" pauses
    /// it, and M24 tries the line again.
    123 "on_failure" = &mut job.on_failure, "", [Spec::choice::<OnFailure>()];
    /// Whether heaters keep their targets if it ends so, until they are idle for too long.
    124 "keep_heat" = &mut job.keeps_heat, "", [Spec::SWITCH];
}
