//! Names of connectors, as they are printed on a board.

use core::fmt::{self, Display};
use core::hash::{Hash, Hasher};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The name of a connector: `M0`, `X-STOP`. Up to [`LONGEST`](Self::LONGEST) printable characters of ASCII, without
/// blanks and without `!`, which inverts a connector in machine files. The empty name is no connector: nothing is
/// plugged in.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ConnectorName([u8; Self::LONGEST]);

impl ConnectorName {
    /// Characters of the longest name.
    pub const LONGEST: usize = 8;

    /// Not plugged in.
    pub const NONE: Self = Self([0; Self::LONGEST]);

    /// The name, or `None` if `text` is not a legal one.
    #[must_use]
    pub const fn new(text: &str) -> Option<Self> {
        let mut from = text.as_bytes();
        let mut name = [0; Self::LONGEST];
        let mut to: &mut [u8] = &mut name;
        while let [byte, after @ ..] = from {
            if !byte.is_ascii_graphic() || *byte == b'!' {
                return None;
            }
            let [slot, free @ ..] = to else { return None };
            *slot = *byte;
            (from, to) = (after, free);
        }
        Some(Self(name))
    }

    /// A name in the source: an illegal one does not compile in a `const`.
    #[must_use]
    pub const fn lit(text: &str) -> Self {
        let name = Self::new(text);
        assert!(name.is_some(), "no name of a connector");
        match name {
            Some(name) => name,
            None => Self::NONE,
        }
    }

    /// Names in the source, as [`lit`](Self::lit).
    #[must_use]
    pub const fn all<const N: usize>(texts: [&str; N]) -> [Self; N] {
        let mut names = [Self::NONE; N];
        let (mut from, mut to): (&[&str], &mut [Self]) = (&texts, &mut names);
        while let ([text, texts @ ..], [name, names @ ..]) = (from, to) {
            *name = Self::lit(text);
            (from, to) = (texts, names);
        }
        names
    }

    /// Its bytes, with zeros behind it.
    #[must_use]
    pub const fn as_bytes(&self) -> &[u8; Self::LONGEST] {
        &self.0
    }

    /// The name with these bytes, with zeros behind it.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::LONGEST]) -> Option<Self> {
        let name = Self(bytes);
        let is_name = Self::new(name.as_str()) == Some(name);
        is_name.then_some(name)
    }

    /// Whether nothing is plugged in.
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let text = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        core::str::from_utf8(text).unwrap_or_default()
    }
}

impl Hash for ConnectorName {
    // Two words instead of eight bytes: settings are summed up all the time (`settings::Kept`).
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(u64::from_le_bytes(self.0));
    }
}

impl Display for ConnectorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for ConnectorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl Serialize for ConnectorName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for ConnectorName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = ConnectorName;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a connector, of at most 8 characters")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<ConnectorName, E> {
                ConnectorName::new(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
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
    fn a_name_is_short_and_printable() {
        for text in ["M0", "X-STOP", "E0DET", "Z2-STOP", "12345678", ""] {
            let name = ConnectorName::new(text).unwrap();
            assert_eq!(name.as_str(), text);
            assert_eq!((format!("{name}"), format!("{name:?}")), (text.into(), format!("{text:?}")));
            assert_eq!(name.is_none(), text.is_empty());
        }
        for text in ["123456789", "M 0", "!M0", "M0!", "M\0", "M\u{7f}", "\u{fc}"] {
            assert_eq!(ConnectorName::new(text), None, "{text}");
        }
    }

    #[test]
    fn a_stored_name_is_one_of_these() {
        let name = ConnectorName::lit("X-STOP");
        let mut bytes = [0; 9];
        let bytes = postcard::to_slice(&name, &mut bytes).unwrap();
        assert_eq!(bytes, b"\x06X-STOP");
        assert_eq!(postcard::from_bytes(bytes), Ok(name));
        bytes[1] = b'!';
        assert!(postcard::from_bytes::<ConnectorName>(bytes).is_err());
        assert!(postcard::from_bytes::<ConnectorName>(b"\x09123456789").is_err());
        assert!(postcard::from_bytes::<ConnectorName>(b"\x01\xff").is_err());
    }
}
