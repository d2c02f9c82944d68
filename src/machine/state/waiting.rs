//! The Console's waits, and the timers that each of them stops.
//!
//! A wait that may last has its state here; motion, room, storage and drivers are `Nothing`. The [`job`](super::job)
//! waits for the user, not a command. Every timer has an exhaustive match on it: a new state forces a decision whether
//! heaters may stay on in it.

/// The wait of the present command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Waiting {
    /// For the next line, or for something that is over in a moment: motion, room, storage, a driver.
    Nothing,
    /// G4 lets time pass.
    Time,
    /// For a temperature: M109, M116, M190, M191.
    Heat,
    /// M303 finds out how a heater behaves.
    Tuning,
    /// SELF_TEST.
    SelfTest,
}

impl Waiting {
    /// Whether the time counts after which unused heaters go off. Waits for the machine itself end by themselves; a
    /// host may stay away for hours.
    pub const fn is_idle_for_heaters(self) -> bool {
        match self {
            Self::Nothing => true,
            Self::Time | Self::Heat | Self::Tuning | Self::SelfTest => false,
        }
    }

    /// Whether the time counts after which unused motors lose their power, and the axes their homes: not while the user
    /// is expected to continue.
    pub const fn is_idle_for_motors(self) -> bool {
        match self {
            Self::Nothing => true,
            Self::Time | Self::Heat | Self::Tuning | Self::SelfTest => false,
        }
    }
}
