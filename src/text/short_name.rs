//! Short names: text of a few bytes that settings and boards hold by value.

use core::fmt::{self, Display};
use core::hash::{Hash, Hasher};
use core::marker::PhantomData;
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A kind of name.
pub trait NameKind: Copy + Ord {
    /// Whether all its characters are letters and digits of ASCII. Otherwise all printable characters of ASCII are
    /// legal but the blank and `!`, which inverts a connector in machine files.
    const IS_ALPHANUMERIC: bool;

    /// A legal name, in words.
    const EXPECTED: &str;
}

/// A name of up to `N` characters, with zeros behind it. The empty name names nothing.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ShortName<const N: usize, K>([u8; N], PhantomData<K>);

impl<const N: usize, K: NameKind> ShortName<N, K> {
    /// Characters of the longest name.
    pub const LONGEST: usize = N;

    /// The empty name.
    pub const NONE: Self = Self([0; N], PhantomData);

    /// The name, or `None` if `text` is not a legal one.
    #[must_use]
    pub const fn new(text: &str) -> Option<Self> {
        let mut from = text.as_bytes();
        let mut name = [0; N];
        let mut to: &mut [u8] = &mut name;
        while let [byte, after @ ..] = from {
            let [slot, free @ ..] = to else { return None };
            let is_legal = if K::IS_ALPHANUMERIC {
                byte.is_ascii_alphanumeric()
            } else {
                byte.is_ascii_graphic() && *byte != b'!'
            };
            if !is_legal {
                return None;
            }
            *slot = *byte;
            (from, to) = (after, free);
        }
        Some(Self(name, PhantomData))
    }

    /// A name in the source: an illegal one does not compile in a `const`.
    #[must_use]
    pub const fn lit(text: &str) -> Self {
        let name = Self::new(text);
        assert!(name.is_some(), "no legal name");
        match name {
            Some(name) => name,
            None => Self::NONE,
        }
    }

    /// Names in the source, as [`lit`](Self::lit).
    #[must_use]
    pub const fn all<const M: usize>(texts: [&str; M]) -> [Self; M] {
        let mut names = [Self::NONE; M];
        let (mut from, mut to): (&[&str], &mut [Self]) = (&texts, &mut names);
        while let ([text, texts @ ..], [name, names @ ..]) = (from, to) {
            *name = Self::lit(text);
            (from, to) = (texts, names);
        }
        names
    }

    /// Its bytes, with zeros behind it.
    #[must_use]
    pub const fn as_bytes(&self) -> &[u8; N] {
        &self.0
    }

    /// The name with these bytes, with zeros behind it.
    #[must_use]
    pub fn from_bytes(bytes: [u8; N]) -> Option<Self> {
        let name = Self(bytes, PhantomData);
        let is_name = Self::new(name.as_str()) == Some(name);
        is_name.then_some(name)
    }

    /// Whether it names nothing.
    #[must_use]
    pub const fn is_none(self) -> bool {
        matches!(self.0.as_slice(), [] | [0, ..])
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let text = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        core::str::from_utf8(text).unwrap_or_default()
    }
}

impl<const N: usize, K: NameKind> Default for ShortName<N, K> {
    fn default() -> Self {
        Self::NONE
    }
}

impl<const N: usize, K> Hash for ShortName<N, K> {
    // Words instead of bytes: settings are summed up all the time (`settings::Kept`).
    fn hash<H: Hasher>(&self, state: &mut H) {
        let (words, bytes) = self.0.as_chunks();
        words.iter().for_each(|word| state.write_u32(u32::from_le_bytes(*word)));
        bytes.iter().for_each(|byte| state.write_u8(*byte));
    }
}

impl<const N: usize, K: NameKind> Display for ShortName<N, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl<const N: usize, K: NameKind> fmt::Debug for ShortName<N, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl<const N: usize, K: NameKind> Serialize for ShortName<N, K> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de, const N: usize, K: NameKind> Deserialize<'de> for ShortName<N, K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name<const N: usize, K>(PhantomData<K>);

        impl<const N: usize, K: NameKind> Visitor<'_> for Name<N, K> {
            type Value = ShortName<N, K>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(K::EXPECTED)
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                ShortName::new(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
            }
        }

        deserializer.deserialize_str(Name(PhantomData))
    }
}
