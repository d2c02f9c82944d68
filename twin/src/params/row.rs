//! Row: what there is to know about a number of a machine.

use super::{Each, Params, split_unit};

/// A number of the machine.
pub struct Row {
    /// Its key in the table `[twin]` of a machine file, which ends with its unit.
    pub key: &'static str,
    /// Its nominal value; `None` where another one counts in its place, as `source` says.
    pub default: Option<f64>,
    /// Its legal values.
    pub range: Range,
    /// Its meaning.
    pub meaning: &'static str,
    /// Where the nominal value comes from.
    pub source: &'static str,
    /// Its place among the numbers.
    pub field: fn(&mut Params) -> Field<'_>,
}

/// Legal values of a number, up to [`Row::MOST`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// Whole numbers from 1.
    Count,
}

/// The place of a number.
pub enum Field<'p> {
    /// One number.
    One(&'p mut f64),
    /// One number, or none.
    Maybe(&'p mut Option<f64>),
    /// A number for all parts of a kind, or a list.
    Each(&'p mut Each, Parts),
}

impl Field<'_> {
    /// Whether a list of numbers is legal.
    #[must_use]
    pub const fn is_list(&self) -> bool {
        matches!(self, Self::Each(..))
    }

    /// What a list has a number for; none where a list is not legal.
    #[must_use]
    pub const fn parts(&self) -> Option<Parts> {
        match self {
            Self::Each(_, parts) => Some(*parts),
            Self::One(_) | Self::Maybe(_) => None,
        }
    }

    /// Its numbers.
    #[must_use]
    pub fn values(&self) -> Each {
        match self {
            Self::One(value) => Each::all(**value),
            Self::Maybe(value) => value.map_or(Each::NONE, Each::all),
            Self::Each(each, _) => **each,
        }
    }

    /// Sets it; of a list only an `Each` keeps more than the first number.
    pub fn set(self, values: Each) {
        match self {
            Self::One(value) => *value = values.get(0).unwrap_or(*value),
            Self::Maybe(value) => *value = values.get(0),
            Self::Each(each, _) => *each = values,
        }
    }
}

/// What a list has a number for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// Each belt.
    Belts,
    /// Each span, belt after belt.
    Spans,
    /// Each motor, by their numbers.
    Motors,
    /// x and y.
    Axes,
}

impl std::fmt::Display for Parts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Belts => "belts",
            Self::Spans => "spans",
            Self::Motors => "motors",
            Self::Axes => "axes",
        })
    }
}

impl std::fmt::Debug for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.key)
    }
}

impl Row {
    /// The greatest legal value of any number.
    pub const MOST: f64 = 1e6;

    /// Its unit; empty for a count or a ratio.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        split_unit(self.key).1
    }

    /// Its numbers on a machine.
    #[must_use]
    pub fn values(&self, params: &Params) -> Each {
        (self.field)(&mut params.clone()).values()
    }

    /// Whether a list of numbers is legal.
    #[must_use]
    pub fn is_list(&self) -> bool {
        (self.field)(&mut Params::default()).is_list()
    }

    /// Whether a number is legal.
    #[must_use]
    pub fn allows(&self, value: f64) -> bool {
        value <= Self::MOST
            && match self.range {
                Range::Positive => value > 0.0,
                Range::NotNegative => value >= 0.0,
                Range::Count => value >= 1.0 && value.fract() == 0.0,
            }
    }

    /// What another value must be.
    #[must_use]
    pub const fn wanted(&self, value: f64) -> &'static str {
        if value > Self::MOST {
            return "must be at most 1000000";
        }
        match self.range {
            Range::Positive => "must be above 0",
            Range::NotNegative => "must not be below 0",
            Range::Count => "must be a whole number from 1 on",
        }
    }

    /// The legal values in words.
    #[must_use]
    pub const fn legal(&self) -> &'static str {
        match self.range {
            Range::Positive => "above 0, to 1000000",
            Range::NotNegative => "0 to 1000000",
            Range::Count => "the whole numbers 1 to 1000000",
        }
    }
}
