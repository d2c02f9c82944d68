//! Fans: the source of each fan's speed. The settings for all fans (`hotend_fan_above`, `fan_run_on_s`) are in
//! [`ThermalSettings`](super::ThermalSettings).

use crate::connectors::FANS;
use crate::settings::rows::{Choice, Spec, numbers, rows};
use crate::settings::{Range, ranges};
use crate::units::Ratio;
use serde::{Deserialize, Serialize};

/// The source of a fan's speed.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum FanRole {
    /// M106 and M107, with its number as P.
    Commanded,
    /// It cools the hotend's cold end, so it runs while the hotend is warm.
    Hotend,
    /// It cools the drivers, so it runs while motors or heaters have power.
    Controller,
    /// It cools the print, and the hotend's block with it. M106 and M107 say how fast, as for a commanded one.
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

/// The fans that cool the print: all of that role; where no fan has it, the first that is commanded.
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
    /// The source of its speed.
    pub role: FanRole,
    /// Milliseconds at full power when it starts, so that it starts at all.
    pub kick_ms: u16,
    /// The least duty at which it turns; commanded speeds are scaled from here.
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

impl Choice for FanRole {
    const ALL: &'static [(Self, &'static str)] = &[
        (Self::Commanded, "commanded"),
        (Self::Hotend, "hotend"),
        (Self::Controller, "controller"),
        (Self::Part, "part"),
    ];

    numbers!(Commanded Hotend Controller Part);
}

/// A duty.
const DUTY: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::ONE };

rows! {
    for fan in |s, part| s.thermal.fans.get_mut(part),
        named &["fans.fan0", "fans.fan1", "fans.fan2", "fans.fan3", "fans.fan4", "fans.fan5"];

    /// What the fan does: commanded (M106), part (the same, and it cools the hotend too), hotend or controller.
    92 "role" = &mut fan.role, "", [Spec::choice::<FanRole>()];
    /// Time of full power at its start.
    93 "kick_ms" = &mut fan.kick_ms, "ms", [ranges::KICK_MS.spec()];
    /// Duty at the lowest speed, of 1.
    94 "least" = &mut fan.least, "", [DUTY.spec()];
    /// Duty at full speed, of 1.
    95 "most" = &mut fan.most, "", [ranges::MAX_DUTY.spec()];
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
