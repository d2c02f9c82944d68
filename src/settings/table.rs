//! The table of all settings: the rows of each file of this room, in one order.

use super::Settings;
use super::rows::{Field, Key, Row, Rows, Text, Visitor};

/// The greatest id of a row that is gone: no other setting gets it. 0 if it is less than one in use.
const RETIRED: u16 = 0;

/// The id that the next new setting gets.
pub const NEXT_ID: u16 = {
    let (mut greatest, mut files) = (RETIRED, ALL);
    while let [file, other_files @ ..] = files {
        let mut rows = file.rows;
        while let [row, others @ ..] = rows {
            greatest = if row.id > greatest { row.id } else { greatest };
            rows = others;
        }
        files = other_files;
    }
    greatest + 1
};

/// The files that have rows. A record has no id for an element that follows the one with the id before, so files of
/// ids in a row stand in a row.
macro_rules! files {
    ($($file:ident$(::$inner:ident)*),+ $(,)?) => {
        /// The rows of each file.
        pub(crate) const ALL: &[Rows] = &[$(super::$file$(::$inner)*::ROWS),+];

        /// The texts of the rows of each file.
        const TEXTS: &[&[Text]] = &[$(super::$file$(::$inner)*::TEXTS),+];
    };
}

files! {
    top,
    axis,
    axis::min,
    axis::homing,
    bed,
    belt,
    belt::phases,
    drivers,
    drivers::own,
    endstops,
    endstops::order,
    pause,
    probe,
    probe::switches,
    probe::quiet,
    probe::home,
    job,
    fan_plugs,
    fan_plugs::pulses,
    probe::offset,
    screws,
    mesh,
    accelerometer,
    accelerometer::axes,
    corner,
    safe_z_home::place,
    safe_z_home,
    supply,
    thermal::sensors,
    shaping,
    shaping::advance,
    thermal,
    thermal::heater,
    thermal::fans,
    wiring::names,
    wiring::motors,
    wiring::endstops,
    wiring::filament,
    wiring::mechanism,
}

impl Settings {
    /// Shows every setting to a visitor, a row after the other, and of a row a part after the other.
    pub fn visit(&mut self, visitor: &mut dyn Visitor) {
        for file in ALL {
            for row in file.rows {
                for part in 0..row.tables.len() {
                    if let Some(mut place) = (file.place)(self, row.id, part) {
                        visitor.visit(Key { row, part: part as u8 }, &mut place);
                    }
                }
            }
        }
    }

    /// Whether each row has the same value in both: their records would be equal. `==` compares field by field, which
    /// takes a hundred times the code.
    #[must_use]
    #[inline(never)]
    pub fn has_values_of(&self, other: &Self) -> bool {
        let (mut a, mut b) = (*self, *other);
        ALL.iter().all(|file| {
            file.rows.iter().all(|row| {
                let value = |s: &mut Self, part| (file.place)(s, row.id, part).map(|place| place.get());
                (0..row.tables.len()).all(|part| value(&mut a, part) == value(&mut b, part))
            })
        })
    }
}

/// Whether this firmware knows a setting with this id, or knew one once.
#[must_use]
pub const fn is_known(id: u16) -> bool {
    0 < id && id < NEXT_ID
}

/// Every row with its text for people. Not for images: the texts would be in them.
pub fn described() -> impl Iterator<Item = (&'static Row, &'static Text)> {
    let texts = TEXTS.iter().copied().flatten();
    ALL.iter().flat_map(|file| file.rows).zip(texts)
}
