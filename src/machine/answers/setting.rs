//! Names for the settings that one line of G-code sets: each is a line of M503.

use crate::connectors::Heater;

/// The settings of one line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Setting {
    /// M92.
    Resolutions,
    /// M203.
    MaxSpeeds,
    /// M201.
    MaxAccelerations,
    /// M204.
    Accelerations,
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
    /// All of them, in the order of M503; the lines of the heaters and of G10 and G11 follow.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::successors(Some(Self::Resolutions), |setting| setting.next())
    }

    /// The setting that follows in M503. Without a wildcard: a new one is linked in here.
    const fn next(self) -> Option<Self> {
        match self {
            Self::Resolutions => Some(Self::MaxSpeeds),
            Self::MaxSpeeds => Some(Self::MaxAccelerations),
            Self::MaxAccelerations => Some(Self::Accelerations),
            Self::Accelerations => Some(Self::Corners),
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
