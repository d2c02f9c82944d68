//! Each: one number for all parts of a kind (belts, spans, motors), or one for each of them.

use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// Most parts of a kind: eight motors with two spans of belt each.
pub const MOST_PARTS: usize = 16;

/// A number of each part.
#[derive(Clone, Copy, Debug)]
pub struct Each {
    listed: [f64; MOST_PARTS],
    count: usize,
}

impl PartialEq for Each {
    fn eq(&self, other: &Self) -> bool {
        self.values() == other.values()
    }
}

impl Each {
    /// No number: another one counts in its place.
    pub const NONE: Self = Self { listed: [0.0; MOST_PARTS], count: 0 };

    /// One number for all parts.
    #[must_use]
    pub const fn all(value: f64) -> Self {
        Self { listed: [value; MOST_PARTS], count: 1 }
    }

    /// A number for each part; `None` if there are too many.
    #[must_use]
    pub fn listed(values: &[f64]) -> Option<Self> {
        let mut each = Self { count: values.len(), ..Self::NONE };
        each.listed.get_mut(..values.len())?.copy_from_slice(values);
        Some(each)
    }

    /// The number of a part. The last one of a list counts for all further parts. `None` without any number.
    #[must_use]
    pub fn get(&self, part: usize) -> Option<f64> {
        self.values().get(part.min(self.count.saturating_sub(1))).copied()
    }

    /// The number of a part; 0 without any number.
    #[must_use]
    pub fn of(&self, part: usize) -> f64 {
        self.get(part).unwrap_or(0.0)
    }

    /// The numbers as listed: one stands for all parts.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        self.listed.get(..self.count).unwrap_or_default()
    }

    /// The same with other numbers in the same proportions, of which `value` is the first.
    #[must_use]
    pub fn with_first(&self, value: f64) -> Self {
        match *self.values() {
            [first, _, ..] => self.times(value / first),
            _ => Self::all(value),
        }
    }

    /// The same with another number of one part, of this many parts.
    #[must_use]
    pub fn with_part(&self, part: usize, value: f64, parts: usize) -> Self {
        let count = self.count.max(parts).max(part + 1).min(MOST_PARTS);
        let mut each = Self { listed: std::array::from_fn(|i| self.of(i)), count };
        if let Some(listed) = each.listed.get_mut(part) {
            *listed = value;
        }
        each
    }

    /// All numbers times a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { listed: self.listed.map(|value| value * factor), count: self.count }
    }
}

impl From<f64> for Each {
    fn from(value: f64) -> Self {
        Self::all(value)
    }
}

impl std::fmt::Display for Each {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.values() {
            [value] => write!(f, "{value}"),
            values => write!(f, "{values:?}"),
        }
    }
}

/// A number, or a list of them.
impl Serialize for Each {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.values() {
            [value] => serializer.serialize_f64(*value),
            values => values.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Each {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Each;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, or a list of numbers")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Each, E> {
                Ok(Each::all(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Each, E> {
                Ok(Each::all(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Each, E> {
                Ok(Each::all(value as f64))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Each, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = items.next_element()? {
                    values.push(value);
                }
                Each::listed(&values).ok_or_else(|| de::Error::invalid_length(values.len(), &"at most 16 numbers"))
            }
        }
        deserializer.deserialize_any(Either)
    }
}
