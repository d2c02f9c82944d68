//! Names for the settings that one line of G-code sets: each is a line of M503.

use crate::connectors::Heater;
use crate::settings::plain::{AXIS_CODES, MACHINE_CODES};

/// The settings of one line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Setting {
    /// M92.
    Resolutions,
    /// The plain settings of an M-code.
    Plain(u16),
    /// M205.
    Corners,
    /// SET_VELOCITY_LIMIT.
    VelocityLimit,
    /// M593.
    Shapers,
    /// M900 and M572.
    Advance,
}

impl Setting {
    /// All of them, in the order of M503, but plain ones without a place of their own; these, and the lines of the
    /// heaters and of G10 and G11, follow.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::successors(Some(Self::Resolutions), |setting| setting.next())
    }

    /// The other plain ones.
    pub fn others() -> impl Iterator<Item = Self> {
        let codes = AXIS_CODES.iter().chain(MACHINE_CODES).copied().map(Self::Plain);
        codes.filter(|setting| Self::all().all(|other| other != *setting))
    }

    /// The setting that follows in M503. Without a wildcard: a new one is linked in here.
    const fn next(self) -> Option<Self> {
        match self {
            Self::Resolutions => Some(Self::Plain(203)),
            Self::Plain(203) => Some(Self::Plain(201)),
            Self::Plain(201) => Some(Self::Plain(204)),
            Self::Plain(_) => Some(Self::Corners),
            Self::Corners => Some(Self::VelocityLimit),
            Self::VelocityLimit => Some(Self::Shapers),
            Self::Shapers => Some(Self::Advance),
            Self::Advance => None,
        }
    }
}

/// The heater or fan settings of one line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum HeatSetting {
    /// M301, M304.
    Pid(Heater),
    /// M306.
    Model(Heater),
    /// M302.
    ColdExtrusion,
    /// M710.
    ControllerFan,
}

/// The command that sets the gains of a heater.
pub(in crate::machine) const fn pid_code(heater: Heater) -> &'static str {
    match heater {
        Heater::Hotend => "M301",
        Heater::Bed => "M304",
        Heater::Chamber => "M309",
    }
}
