//! Names of motors, as machine files give them.

use core::fmt::{self, Display};
use core::hash::{Hash, Hasher};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The name of a motor: up to [`LONGEST`](Self::LONGEST) letters and digits of ASCII. The empty name is no motor.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct MotorName([u8; Self::LONGEST]);

impl MotorName {
    /// Characters of the longest name.
    pub const LONGEST: usize = 4;

    /// No motor.
    pub const NONE: Self = Self([0; Self::LONGEST]);

    /// The name, or `None` if `text` is not a legal one.
    #[must_use]
    pub const fn new(text: &str) -> Option<Self> {
        let mut from = text.as_bytes();
        let mut name = [0; Self::LONGEST];
        let mut to: &mut [u8] = &mut name;
        while let [byte, after @ ..] = from {
            let [slot, free @ ..] = to else { return None };
            if !byte.is_ascii_alphanumeric() {
                return None;
            }
            *slot = *byte;
            (from, to) = (after, free);
        }
        Some(Self(name))
    }

    /// A name in the source: an illegal one does not compile in a `const`.
    #[must_use]
    pub const fn lit(text: &str) -> Self {
        let name = Self::new(text);
        assert!(name.is_some(), "no name of a motor");
        match name {
            Some(name) => name,
            None => Self::NONE,
        }
    }

    /// Whether it names no motor.
    #[must_use]
    pub const fn is_none(self) -> bool {
        u32::from_le_bytes(self.0) == 0
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let text = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        core::str::from_utf8(text).unwrap_or_default()
    }
}

impl Hash for MotorName {
    // One word: settings are summed up all the time (`settings::Kept`).
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u32(u32::from_le_bytes(self.0));
    }
}

impl Display for MotorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for MotorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl Serialize for MotorName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for MotorName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = MotorName;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a motor, of at most 4 letters and digits")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<MotorName, E> {
                MotorName::new(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
            }
        }

        deserializer.deserialize_str(Name)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    #[test]
    fn a_name_is_short_and_of_letters_and_digits() {
        for text in ["m1", "z3", "Yr", "1234", ""] {
            let name = MotorName::new(text).unwrap();
            assert_eq!((name.as_str(), name.is_none()), (text, text.is_empty()));
            assert_eq!((format!("{name}"), format!("{name:?}")), (text.into(), format!("{text:?}")));
        }
        for text in ["12345", "m 1", "m,1", "m.1", "#1", "\u{fc}"] {
            assert_eq!(MotorName::new(text), None, "{text}");
        }
    }
}
