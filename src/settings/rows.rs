//! Rows: one row defines a setting, next to its field. All other users of settings go through these rows: the record in
//! memory (`storage`), the check of ranges, machine files with their schema and comments, and
//! docs/reference/settings.md.
//!
//! A file of this room ends with its rows (`rows!`). A row has
//!
//! | part | for |
//! |---|---|
//! | an id | records: it stays for ever, and is never used again for another setting |
//! | a key | machine files and errors; behind the table of each part of the machine that has such a setting |
//! | the field | getting and setting it |
//! | a unit, and a comment with its meaning | people; not in an image, because nothing there refers to [`Text`] |
//! | a [`Spec`]: its range and kind | all users |
//! | its [`Line`]s, if its number is plain | G-code: reading, setting, reports, docs/reference/gcode.md |
//!
//! A new setting needs a field, its default, and a row with the next free id ([`NEXT_ID`](super::table::NEXT_ID)
//! counts).

use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};
use core::fmt::{self, Display};

use super::line::Line;
pub use super::spec::{Choice, Kind, Legal, Spec};
use super::{Range, Settings};

/// Characters of the longest text that a setting may have.
pub const LONGEST_TEXT: usize = 24;

/// A text as a value.
pub type Text24 = heapless::String<LONGEST_TEXT>;

/// A value of any type.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Value {
    /// It has none: another key of the same field has.
    Absent,
    /// The bits of a fixed-point number, a whole number, the number of a choice, or 0 and 1.
    Number(i64),
    /// A name.
    Text(Text24),
}

/// A field that a row reads and writes.
pub trait Field {
    /// Its value.
    fn get(&self) -> Value;

    /// Takes a value, and returns whether it fits the type; otherwise nothing changes. Ranges are asked elsewhere.
    #[must_use]
    fn set(&mut self, value: &Value) -> bool;
}

/// The part of a row that all users need.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Row {
    /// Its number in records.
    pub id: u16,
    /// The table in machine files, of each part that has such a setting; empty for a key at the top.
    pub tables: &'static [&'static str],
    /// The key behind the table; empty if the table is the key.
    pub leaf: &'static str,
    /// The legal values: one entry for all parts, or one for each.
    legal: &'static [Legal],
    /// The lines that set it: one for all parts, or one for each part from the first on. None if it is not plain.
    pub lines: &'static [Line],
}

impl Row {
    /// A row.
    pub(super) const fn new(
        id: u16,
        tables: &'static [&'static str],
        leaf: &'static str,
        legal: &'static [Legal],
    ) -> Self {
        Self { id, tables, leaf, legal, lines: &[] }
    }

    /// The same, and these lines set it.
    pub(super) const fn set_by(self, lines: &'static [Line]) -> Self {
        let (mut others, mut is_each) = (lines, true);
        while let [line, next @ ..] = others {
            is_each &= line.letters.len() == 1;
            others = next;
        }
        let is_all = matches!(lines, [line] if line.letters.len() == self.tables.len());
        assert!(is_all || is_each && lines.len() <= self.tables.len(), "a letter for each part");
        Self { lines, ..self }
    }

    /// The line that sets a part, and the part's letters in it: its own, and after `/` an older one.
    #[must_use]
    pub fn line(&self, part: u8) -> Option<(&'static Line, &'static str)> {
        let place = usize::from(part);
        let (line, place) = match self.lines {
            [line] if line.is_of_axes() => (line, place),
            lines => (lines.get(place)?, 0),
        };
        Some((line, *line.letters.get(place)?))
    }

    /// The legal values of a part.
    #[must_use]
    pub fn legal(&self, part: usize) -> Legal {
        let of_all = self.legal.first().copied();
        let none = Legal { least: 0, most: 0, may_be_zero: false, is_text: false, is_signed: false };
        self.legal.get(part).copied().or(of_all).unwrap_or(none)
    }

    /// Whether its numbers may be below 0 by their type, whatever is legal.
    pub(crate) fn is_signed(&self) -> bool {
        self.legal.first().is_some_and(|legal| legal.is_signed)
    }

    /// The legal values of all parts: one entry for all, or one for each.
    pub(crate) const fn legals(&self) -> &'static [Legal] {
        self.legal
    }
}

/// A setting of a part: its row, and which part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Key {
    /// Its row.
    pub row: &'static Row,
    /// Which part.
    pub part: u8,
}

impl Key {
    /// The table of the part.
    #[must_use]
    pub fn table(&self) -> &'static str {
        self.row.tables.get(usize::from(self.part)).copied().unwrap_or_default()
    }
}

impl Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (table, leaf) = (self.table(), self.row.leaf);
        let point = if table.is_empty() || leaf.is_empty() { "" } else { "." };
        write!(f, "{table}{point}{leaf}")
    }
}

/// The part of a row for people and for programs on their computers.
#[derive(Clone, Copy, Debug)]
pub struct Text {
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// Its meaning, in lines of a comment.
    pub meaning: &'static [&'static str],
    /// Its kind of value.
    pub kind: Kind,
}

/// Goes through all settings.
pub trait Visitor {
    /// A setting: its key, and its field, which may be changed.
    fn visit(&mut self, key: Key, field: &mut dyn Field);
}

/// The rows of a file of this room, and the function that shows their fields to a visitor.
pub(crate) struct Rows {
    pub rows: &'static [Row],
    pub visit: fn(&mut Settings, &mut dyn Visitor),
}

/// Makes the rows of a file of this room: `for PART in PARTS named [TABLE of each part]`, then for each setting its
/// comment and `ID "KEY" = FIELD, "UNIT", [SPEC];`. If a line sets it, its code and a letter for each part follow:
/// `ID "KEY" = FIELD, "UNIT", [SPEC], "M201" "X" "Y" "Z" "E";`. Or parts have codes: `.., "M301" "P", "M304" "P";`.
macro_rules! rows {
    (
        for $part:ident in $parts:path, named $tables:expr;
        $(
            $(#[doc = $meaning:literal])+
            $id:literal $leaf:literal = $field:expr, $unit:literal, [$spec:expr $(, $others:expr)*]$(, $code:literal $($letters:literal)+)*;
        )+
    ) => {
        /// The rows.
        pub(in crate::settings) const ROWS: $crate::settings::rows::Rows = $crate::settings::rows::Rows {
            rows: const { &[$(
                $crate::settings::rows::Row::new($id, const { $tables }, $leaf, const { &[$spec.legal $(, $others.legal)*] })
                    .set_by(const {
                        &[$($crate::settings::line::Line::new($code, &[$($letters),+], $unit, $spec.bits())),*]
                    })
            ),+] },
            visit,
        };

        /// The texts of the rows for people.
        pub(in crate::settings) const TEXTS: &[$crate::settings::rows::Text] = &[$($crate::settings::rows::Text {
            unit: $unit,
            meaning: &[$($meaning),+ $(, concat!(" Set by ", $code $(, " ", $letters)+, "."))*],
            kind: $spec.kind,
        }),+];

        fn visit(settings: &mut $crate::settings::Settings, visitor: &mut dyn $crate::settings::rows::Visitor) {
            // One loop for all rows, not one for each, as images have little room.
            for row in ROWS.rows {
                for ($part, part) in $parts(settings).into_iter().zip(0..) {
                    let key = $crate::settings::rows::Key { row, part };
                    match row.id {
                        $($id => visitor.visit(key, &mut $field),)+
                        _ => {}
                    }
                }
            }
        }
    };
}
pub(super) use rows;

/// Ranges of fixed-point numbers as specs.
macro_rules! specs {
    ($($type:ty),+) => {
        $(impl Range<$type> {
            /// A number in this range.
            #[must_use]
            pub const fn spec(self) -> Spec {
                let kind = Kind::Fixed(<$type>::FRAC_NBITS);
                let is_signed = <$type>::MIN.to_bits() != 0;
                Spec::new(self.least.to_bits() as i64, self.most.to_bits() as i64, kind).of_signed(is_signed)
            }
        }

        impl Field for $type {
            fn get(&self) -> Value {
                Value::Number(i64::from(self.to_bits()))
            }

            fn set(&mut self, value: &Value) -> bool {
                let Value::Number(bits) = value else { return false };
                // By way of a type that none of them has, so that the conversion may fail for all.
                let Ok(bits) = i128::from(*bits).try_into() else { return false };
                *self = Self::from_bits(bits);
                true
            }
        })+
    };
}
specs!(MmPerSec, MmPerSec2, StepsPerMm, Hertz, Seconds, Celsius, Watts, JoulesPerKelvin, WattsPerKelvin, Mm, Ratio);

/// Ranges of whole numbers as specs.
macro_rules! whole {
    ($($type:ty),+) => {
        $(impl Range<$type> {
            /// A whole number in this range.
            #[must_use]
            pub const fn spec(self) -> Spec {
                Spec::new(self.least as i64, self.most as i64, Kind::Whole).of_signed(<$type>::MIN != 0)
            }
        }

        impl Field for $type {
            fn get(&self) -> Value {
                Value::Number(i64::from(*self))
            }

            fn set(&mut self, value: &Value) -> bool {
                let Value::Number(number) = value else { return false };
                let Ok(number) = (*number).try_into() else { return false };
                *self = number;
                true
            }
        })+
    };
}
whole!(u8, u16, u32, i16);

impl Field for bool {
    fn get(&self) -> Value {
        Value::Number((*self).into())
    }

    fn set(&mut self, value: &Value) -> bool {
        match value {
            Value::Number(0) => *self = false,
            Value::Number(1) => *self = true,
            _ => return false,
        }
        true
    }
}

/// A choice as a field.
#[derive(Debug)]
pub struct Chosen<'a, T>(pub &'a mut T);

impl<T: Choice> Field for Chosen<'_, T> {
    fn get(&self) -> Value {
        let number = T::ALL.iter().position(|(choice, _)| *choice == *self.0).unwrap_or_default();
        Value::Number(number as i64)
    }

    fn set(&mut self, value: &Value) -> bool {
        let Value::Number(number) = value else { return false };
        let choice = usize::try_from(*number).ok().and_then(|number| T::ALL.get(number));
        if let Some((choice, _)) = choice {
            *self.0 = *choice;
        }
        choice.is_some()
    }
}

/// A text as a value.
pub(super) fn text(parts: [&str; 2]) -> Value {
    let mut text = Text24::new();
    // A name that is too long is refused, so nothing is cut off.
    let _ = parts.into_iter().try_for_each(|part| text.push_str(part));
    Value::Text(text)
}
