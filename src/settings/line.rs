//! Lines: the line of G-code that sets a setting, as a part of its row.
//!
//! A row has one only if its number is plain: a part of the firmware reads it wherever it needs it, so the next move
//! can take another value. `gcode` reads such lines, and `machine` carries them out and reports them, without a word
//! about the setting anywhere else.

/// The line that sets a setting: a code, and a letter for each part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Line {
    /// The code, such as `M204`.
    pub code: &'static str,
    /// The number of the code.
    pub number: u16,
    /// The letters of each part: its own, and after `/` an older one, which counts without it. Several parts
    /// are axes.
    pub letters: &'static [&'static str],
    /// Whether the value follows the unit of lengths in lines (G20).
    pub is_length: bool,
    /// Bits of the value after the point; 0 for a whole number.
    pub bits: u32,
}

impl Line {
    /// No line.
    pub(super) const NONE: Self = Self { code: "", number: 0, letters: &[], is_length: false, bits: 0 };

    /// A line that sets a value of that unit, with so many bits after the point.
    pub(super) const fn new(code: &'static str, letters: &'static [&'static str], unit: &str, bits: u32) -> Self {
        assert!(matches!(code.as_bytes(), [b'M', ..]), "an M-code");
        let (_, mut digits) = code.as_bytes().split_at(1);
        let mut number = 0;
        while let [digit, others @ ..] = digits {
            number = number * 10 + (*digit - b'0') as u16;
            digits = others;
        }
        Self { code, number, letters, is_length: matches!(unit.as_bytes(), [b'm', b'm', ..]), bits }
    }

    /// Whether the parts are axes.
    pub(super) const fn is_of_axes(&self) -> bool {
        self.letters.len() > 1
    }

    /// The letter that names a part in messages.
    #[must_use]
    pub fn letter(&self, part: u8) -> &'static str {
        self.letters.get(usize::from(part)).and_then(|letters| letters.get(..1)).unwrap_or_default()
    }
}
