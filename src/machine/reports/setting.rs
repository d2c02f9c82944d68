//! Names for the settings that one line of G-code sets: each is a line of M503.

use crate::settings::plain::{CODES, Owner, condition};

/// The settings of one line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Setting {
    /// The plain settings of an M-code.
    Plain(u16),
    /// SET_VELOCITY_LIMIT.
    VelocityLimit,
    /// M593.
    Shapers,
    /// M900 and M572.
    Advance,
    /// M422.
    Screws,
    /// M420.
    Levelling,
}

impl Setting {
    /// All of them, in the order of M503, but plain ones without a place of their own; these, and the lines of the
    /// heaters and of G10 and G11, follow.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::successors(Some(Self::Plain(92)), |setting| setting.next())
    }

    /// The other plain ones, without those of heaters, which stand with their heater.
    pub fn others() -> impl Iterator<Item = Self> {
        let codes = CODES.iter().copied().filter(|code| condition(*code).owner != Owner::Heaters).map(Self::Plain);
        codes.filter(|setting| Self::all().all(|other| other != *setting))
    }

    /// The setting that follows in M503. Without a wildcard for kinds: a new one is linked in here.
    const fn next(self) -> Option<Self> {
        match self {
            Self::Plain(92) => Some(Self::Plain(203)),
            Self::Plain(203) => Some(Self::Plain(201)),
            Self::Plain(201) => Some(Self::Plain(204)),
            Self::Plain(204) => Some(Self::Plain(205)),
            Self::Plain(_) => Some(Self::VelocityLimit),
            Self::VelocityLimit => Some(Self::Shapers),
            Self::Shapers => Some(Self::Advance),
            Self::Advance => Some(Self::Screws),
            Self::Screws => Some(Self::Levelling),
            Self::Levelling => None,
        }
    }
}
