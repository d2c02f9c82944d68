//! The name of a machine, which hosts and screens show (M115, MACHINE_TYPE).

use super::field::{Field, Value, text};
use core::fmt::{self, Display};
use core::hash::{Hash, Hasher};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The name of a machine without one, as in Marlin (Configuration.h, MACHINE_NAME).
const NAMELESS: &str = "3D Printer";

/// The name of a machine: up to [`LONGEST`](Self::LONGEST) letters, digits, blanks and [`MARKS`](Self::MARKS), a blank
/// neither first nor last. So it cannot be taken for a key of M115 or for a word that hosts act on. The empty name
/// means no name.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct MachineName([u8; Self::LONGEST]);

impl MachineName {
    /// Characters of the longest name: a status line of a screen has room for them, and so has the record.
    pub const LONGEST: usize = 24;

    /// The characters allowed in a name other than letters, digits and blanks.
    pub const MARKS: &str = "+-.,/()&#'";

    /// No name.
    pub const NONE: Self = Self([0; Self::LONGEST]);

    /// The name, or `None` if `text` is not a legal one.
    #[must_use]
    pub const fn new(text: &str) -> Option<Self> {
        let mut from = text.as_bytes();
        if let [b' ', ..] | [.., b' '] = from {
            return None;
        }
        let mut name = [0; Self::LONGEST];
        let mut to: &mut [u8] = &mut name;
        while let [byte, after @ ..] = from {
            let [slot, free @ ..] = to else { return None };
            if !byte.is_ascii_alphanumeric() && *byte != b' ' && !is_mark(*byte) {
                return None;
            }
            *slot = *byte;
            (from, to) = (after, free);
        }
        Some(Self(name))
    }

    /// A name in the source: an illegal one does not compile in a `const`.
    #[must_use]
    pub(super) const fn lit(text: &str) -> Self {
        let name = Self::new(text);
        assert!(name.is_some(), "no name of a machine");
        match name {
            Some(name) => name,
            None => Self::NONE,
        }
    }

    /// Whether there is no name.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let text = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        core::str::from_utf8(text).unwrap_or_default()
    }
}

/// Whether a byte is one of the marks.
const fn is_mark(byte: u8) -> bool {
    let mut marks = MachineName::MARKS.as_bytes();
    while let [mark, after @ ..] = marks {
        if *mark == byte {
            return true;
        }
        marks = after;
    }
    false
}

impl Hash for MachineName {
    // Three words instead of 24 bytes: settings are summed up all the time (`settings::Kept`).
    fn hash<H: Hasher>(&self, state: &mut H) {
        let (words, _) = self.0.as_chunks::<8>();
        words.iter().for_each(|word| state.write_u64(u64::from_le_bytes(*word)));
    }
}

impl Display for MachineName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_none() { NAMELESS } else { self.as_str() })
    }
}

impl fmt::Debug for MachineName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl Serialize for MachineName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for MachineName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = MachineName;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                put!(f, "the name of a machine, of at most 24 characters")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<MachineName, E> {
                MachineName::new(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
            }
        }

        deserializer.deserialize_str(Name)
    }
}

impl Field for MachineName {
    fn get(&self) -> Value {
        text([self.as_str(), ""])
    }

    fn set(&mut self, value: &Value) -> bool {
        let Value::Text(text) = value else { return false };
        let Some(name) = Self::new(text) else { return false };
        *self = name;
        true
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;

    #[test]
    fn a_name_is_short_and_means_nothing_else_to_a_host() {
        for text in ["", "Voron 2.4 350", "H-bot", "a", "Core+ (4/4) & #1, Tom's"] {
            assert_eq!(MachineName::new(text).map(|name| format!("{name:?}")), Some(format!("{text:?}")));
        }
        for text in [" a", "a ", "W\u{f6}rk", "a:b", "a_b", "X:1", "a\nb", "a\"b", "a;b", "1234567890123456789012345"] {
            assert_eq!(MachineName::new(text), None, "{text}");
        }
        assert_eq!(format!("{} {}", MachineName::NONE, MachineName::lit("Voron")), "3D Printer Voron");
    }

    #[test]
    fn a_name_is_stored_as_its_text_and_one_that_is_none_is_refused() {
        let mut memory = [0; 32];
        let bytes = postcard::to_slice(&MachineName::lit("Voron"), &mut memory).map(|bytes| &*bytes);
        assert_eq!(bytes, Ok(&b"\x05Voron"[..]));
        assert_eq!(postcard::from_bytes(b"\x05Voron"), Ok(MachineName::lit("Voron")));
        assert!(postcard::from_bytes::<MachineName>(b"\x05Vo:on").is_err());
    }
}
