//! Fans: who says how fast each runs. What the fans have in common (`hotend_fan_above`, `fan_run_on_s`) is in
//! [`ThermalSettings`](super::ThermalSettings).

use crate::connectors::FANS;
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
    /// It cools what is printed, and the hotend's block with it. M106 and M107 say how fast, as for a commanded one.
    Part,
}

impl FanRole {
    /// Whether M106 and M107 say how fast it runs.
    #[must_use]
    pub const fn is_commanded(self) -> bool {
        match self {
            Self::Commanded | Self::Part => true,
            Self::Hotend | Self::Controller => false,
        }
    }
}

/// Which fans cool what is printed: all of that role; where no fan has it, the first that is commanded.
#[must_use]
pub fn part_fans(roles: [FanRole; FANS]) -> [bool; FANS] {
    let are_parts = roles.map(|role| role == FanRole::Part);
    if are_parts != [false; FANS] {
        return are_parts;
    }
    let first = roles.iter().position(|role| role.is_commanded());
    core::array::from_fn(|place| first == Some(place))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_fan_is_that_of_the_role_or_the_first_that_is_commanded() {
        let (c, h, p) = (FanRole::Commanded, FanRole::Hotend, FanRole::Part);
        let places = |roles: [FanRole; FANS]| part_fans(roles).map(u8::from);
        assert_eq!(places([c, h, h, c, c, c]), [1, 0, 0, 0, 0, 0]);
        assert_eq!(places([h, c, h, c, c, c]), [0, 1, 0, 0, 0, 0]);
        assert_eq!(places([c, h, h, p, c, p]), [0, 0, 0, 1, 0, 1]);
        assert_eq!(places([h; FANS]), [0; FANS]);
    }
}
