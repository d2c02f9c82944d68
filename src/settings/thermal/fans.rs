//! Fans: who says how fast each runs. What the fans have in common (`hotend_fan_above`, `fan_run_on_s`) is in
//! [`ThermalSettings`](super::ThermalSettings).

use crate::units::Ratio;
use serde::{Deserialize, Serialize};

/// Who says how fast a fan runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum FanRole {
    /// M106 and M107, with its number as P.
    Commanded,
    /// It cools the hotend's cold end, so it runs while the hotend is warm.
    Hotend,
    /// It cools the drivers, so it runs while motors or heaters have power.
    Controller,
}

/// A fan.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct FanSettings {
    /// Who says how fast it runs.
    pub role: FanRole,
    /// Milliseconds at full power when it starts, so that it starts at all.
    pub kick_ms: u16,
    /// The least duty at which it turns; what is asked for is scaled from here.
    pub least: Ratio,
    /// The duty at full speed.
    pub most: Ratio,
}

impl FanSettings {
    /// A fan of 24 V: it may need a push to start, and hums below a tenth.
    #[must_use]
    pub const fn new(role: FanRole) -> Self {
        Self { role, kick_ms: 100, least: Ratio::ZERO, most: Ratio::ONE }
    }
}
