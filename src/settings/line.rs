//! Lines: the line of G-code that sets a setting, as a part of its row.
//!
//! A row has one only if its number is plain: its line gives it a value, and nothing else is to be said about it.
//! `gcode` reads such lines, and `machine` carries them out and reports them, without a word about the setting anywhere
//! else. [`plain`](super::plain) says which codes have a condition.

/// The line that sets a setting: a code, and a letter for each part. Parts may have lines of their own.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SettingLine {
    /// The code, such as `M204`.
    pub code: &'static str,
    /// The number of the code.
    pub number: u16,
    /// The letters of each part: its own, and after `/` an older one, which counts without it. Several parts
    /// are axes.
    pub letters: &'static [&'static str],
    /// Whether the value follows the unit of lengths in lines (G20).
    pub is_length: bool,
    /// Whether the value is cut off where its type ends, and reported with all of its digits, as positions are. Others
    /// are the nearest value of the type.
    pub is_exact: bool,
    /// Bits of the value after the point; 0 for a whole number.
    pub bits: u32,
}

impl SettingLine {
    /// No line.
    pub(super) const NONE: Self =
        Self { code: "", number: 0, letters: &[], is_length: false, is_exact: false, bits: 0 };

    /// A line that sets a value of that unit, with so many bits after the point.
    pub(super) const fn new(code: &'static str, letters: &'static [&'static str], unit: &str, bits: u32) -> Self {
        assert!(matches!(code.as_bytes(), [b'M', ..]), "an M-code");
        let (_, mut digits) = code.as_bytes().split_at(1);
        let mut number = 0;
        while let [digit, others @ ..] = digits {
            number = number * 10 + (*digit - b'0') as u16;
            digits = others;
        }
        let is_length = matches!(unit.as_bytes(), [b'm', b'm', ..]);
        let is_exact = is_length || matches!(unit.as_bytes(), [.., b'm', b'm']);
        Self { code, number, letters, is_length, is_exact, bits }
    }

    /// Whether the parts are axes.
    pub(super) const fn is_of_axes(&self) -> bool {
        self.letters.len() > 1
    }
}
