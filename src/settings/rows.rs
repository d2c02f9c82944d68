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
//! | the field, of a type that `places!` lists in `mod.rs` | getting and setting it |
//! | a unit, and a comment with its meaning | people; not in an image, because nothing there refers to [`Text`] |
//! | a [`Spec`]: its range and kind | all users |
//! | its [`SettingLine`]s, if its number is plain | G-code: reading, setting, reports, docs/reference/gcode.md |
//!
//! A new setting needs a field, its default, and a row with the next free id ([`NEXT_ID`](super::table::NEXT_ID)
//! counts).

use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};
use core::fmt::{self, Display};

pub use super::field::{Field, LONGEST_TEXT, Text24, Value};
use super::line::SettingLine;
pub(super) use super::spec::numbers;
pub use super::spec::{Choice, Legal, Spec, ValueKind};
use super::{Place, Range, Settings};

/// The part of a row that all users need.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Row {
    /// Its number in records.
    pub id: u16,
    /// The table in machine files, of each part that has such a setting; empty for a key at the top. A reference to
    /// a slice takes half the room of a slice in each row of an image.
    pub tables: &'static &'static [&'static str],
    /// The key behind the table; empty if the table is the key.
    pub leaf: &'static str,
    /// The legal values of the first part, and by way of them those of the others.
    legal: &'static Legal,
    /// The lines that set it: one for all parts, or one for each part from the first on. None if it is not plain.
    pub lines: &'static &'static [SettingLine],
}

impl Row {
    /// A row.
    pub(super) const fn new(
        id: u16,
        tables: &'static &'static [&'static str],
        leaf: &'static str,
        legal: &'static Legal,
    ) -> Self {
        Self { id, tables, leaf, legal, lines: &(&[] as &[SettingLine]) }
    }

    /// The same, and these lines set it.
    pub(super) const fn set_by(self, lines: &'static &'static [SettingLine]) -> Self {
        let (mut others, mut is_each) = (*lines, true);
        while let [line, next @ ..] = others {
            is_each &= line.letters.len() == 1;
            others = next;
        }
        let is_all = matches!(*lines, [line] if line.letters.len() == self.tables.len());
        assert!(is_all || is_each && lines.len() <= self.tables.len(), "a letter for each part");
        Self { lines, ..self }
    }

    /// The line that sets a part, and the part's letters in it: its own, and after `/` an older one.
    #[must_use]
    pub fn line(&self, part: u8) -> Option<(&'static SettingLine, &'static str)> {
        let place = usize::from(part);
        let (line, place) = match *self.lines {
            [line] if line.is_of_axes() => (line, place),
            lines => (lines.get(place)?, 0),
        };
        Some((line, *line.letters.get(place)?))
    }

    /// The legal values of a part.
    #[must_use]
    pub fn legal(&self, part: usize) -> Legal {
        let mut legal = self.legal;
        for _ in 0..part {
            legal = legal.next.unwrap_or(legal);
        }
        Legal { next: None, ..*legal }
    }

    /// Whether its numbers may be below 0 by their type, whatever is legal.
    pub(crate) fn is_signed(&self) -> bool {
        self.legal.is_signed
    }

    /// The legal values of the first part; each leads to those that follow.
    pub(crate) const fn first_legal(&self) -> &'static Legal {
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
    pub kind: ValueKind,
}

/// Goes through all settings.
pub trait Visitor {
    /// A setting: its key, and its field, which may be changed.
    fn visit(&mut self, key: Key, field: &mut dyn Field);
}

/// The rows of a file of this room, and the function that finds the field of a row and a part.
pub(crate) struct Rows {
    pub rows: &'static [Row],
    pub place: for<'s> fn(&'s mut Settings, u16, usize) -> Option<Place<'s>>,
}

/// Makes the rows of a file of this room: `for PART in |SETTINGS, NUMBER| PART, named [TABLE of each part]`, then for
/// each setting its comment and `ID "KEY" = FIELD, "UNIT", [SPEC];`. If a line sets it, its code and a letter for each
/// part follow: `ID "KEY" = FIELD, "UNIT", [SPEC], "M201" "X" "Y" "Z" "E";`. Or parts have codes: `.., "M301" "P",
/// "M304" "P";`.
macro_rules! rows {
    (
        for $part:ident in |$settings:ident, $number:pat_param| $its:expr, named $tables:expr;
        $(
            $(#[doc = $meaning:literal])+
            $id:literal $leaf:literal = $field:expr, $unit:literal, [$spec:expr $(, $others:expr)*]
                $(, $code:literal $($letters:literal)+)*;
        )+
    ) => {
        const TABLES: &[&str] = $tables;

        /// The rows.
        pub(in crate::settings) const ROWS: $crate::settings::rows::Rows = $crate::settings::rows::Rows {
            rows: const { &[$(
                $crate::settings::rows::Row::new($id, &TABLES, $leaf, const { &rows!(@legal $spec $(, $others)*) })
                    .set_by(const {
                        use $crate::settings::line::SettingLine;
                        &(&[$(SettingLine::new($code, &[$($letters),+], $unit, $spec.bits())),*] as &[SettingLine])
                    })
            ),+] },
            place,
        };

        /// The texts of the rows for people.
        pub(in crate::settings) const TEXTS: &[$crate::settings::rows::Text] = &[$($crate::settings::rows::Text {
            unit: $unit,
            meaning: &[$($meaning),+ $(, concat!(" Set by ", $code $(, " ", $letters)+, "."))*],
            kind: $spec.kind,
        }),+];

        fn place(
            $settings: &mut $crate::settings::Settings,
            id: u16,
            $number: usize,
        ) -> Option<$crate::settings::Place<'_>> {
            let $part = $its?;
            Some(match id {
                $($id => $field.into(),)+
                _ => return None,
            })
        }
    };
    // A copy: a reference into the spec would keep all of it, with the names of choices, in an image.
    (@legal $spec:expr) => {{ $spec.legal }};
    (@legal $spec:expr, $($others:expr),+) => {
        $crate::settings::rows::Legal { next: Some(const { &rows!(@legal $($others),+) }), ..$spec.legal }
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
                let kind = ValueKind::Fixed(<$type>::FRAC_NBITS);
                let is_signed = <$type>::MIN.to_bits() != 0;
                Spec::new(self.least.to_bits() as i64, self.most.to_bits() as i64, kind).of_signed(is_signed)
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
                Spec::new(self.least as i64, self.most as i64, ValueKind::Whole).of_signed(<$type>::MIN != 0)
            }
        })+
    };
}
whole!(u8, u16, u32, i16);
