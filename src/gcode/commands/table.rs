//! The table of all codes and names: the rows of each family, in one order.

use super::row::{Described, Row, Text};
use super::{bed, heat, jobs, motion, motors, offset, probing, refused, reports, resonance, settings, silent};
use crate::gcode::code::Code;

/// The families with their headings in docs/reference/gcode.md. Arcs are frequent, so their family is the first.
const FAMILIES: [(&str, &[Described]); 12] = [
    ("Motion", motion::ROWS),
    ("Offsets", offset::ROWS),
    ("Jobs, pauses and waits", jobs::ROWS),
    ("Heat and fans", heat::ROWS),
    ("Settings", settings::ROWS),
    ("Motors and drivers", motors::ROWS),
    ("Z probe", probing::ROWS),
    ("Bed mesh", bed::ROWS),
    ("Resonances", resonance::ROWS),
    ("Reports and messages", reports::ROWS),
    ("Accepted silently", silent::ROWS),
    ("Refused", refused::ROWS),
];

const COUNT: usize = {
    let (mut count, mut families) = (0, FAMILIES.as_slice());
    while let [(_, rows), others @ ..] = families {
        count += rows.len();
        families = others;
    }
    count
};

/// All rows without their texts, which an image does not get.
static ROWS: [Row; COUNT] = {
    let mut all = [motion::ROWS[0].row; COUNT];
    let (mut place, mut families) = (0, FAMILIES.as_slice());
    while let [(_, rows), others @ ..] = families {
        let mut rows = *rows;
        while let [first, next @ ..] = rows {
            all[place] = first.row;
            place += 1;
            rows = next;
        }
        families = others;
    }
    all
};

/// The row of a code.
pub(in crate::gcode) fn row_of(code: Code) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.begin.is_code(code, row.letters))
}

/// The row of a name.
pub(in crate::gcode) fn row_of_name(name: &[u8]) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.begin.is_name(name))
}

/// The names that are known.
pub fn names() -> impl Iterator<Item = &'static str> {
    ROWS.iter().flat_map(|row| row.begin.parts().1).copied()
}

/// The codes that are known, as letters and numbers.
pub fn codes() -> impl Iterator<Item = (char, u16)> {
    ROWS.iter()
        .map(|row| row.begin.parts().0)
        .flat_map(|(letter, numbers)| numbers.iter().map(move |number| (letter, *number)))
}

/// A row for people: its family, its codes with their letter, its names, and its texts.
pub struct Line {
    /// The heading of its family.
    pub family: &'static str,
    /// The letter and the numbers of its codes.
    pub codes: (char, &'static [u16]),
    /// Its names.
    pub names: &'static [&'static str],
    /// Its texts.
    pub text: &'static Text,
}

/// Every row for people. Not for images: the texts would be in them.
pub fn described() -> impl Iterator<Item = Line> {
    FAMILIES.iter().flat_map(|(family, rows)| {
        rows.iter().map(|Described { row, text }| {
            let (codes, names) = row.begin.parts();
            Line { family, codes, names, text }
        })
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_code_and_every_name_stands_once() {
        assert_eq!(codes().count(), codes().collect::<BTreeSet<_>>().len());
        assert_eq!(names().count(), names().collect::<BTreeSet<_>>().len());
    }
}
