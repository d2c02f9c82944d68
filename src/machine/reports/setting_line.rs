//! Values that a command keeps for itself, as the line that sets them.

use crate::gcode::Number;
use crate::machine::numbers::exact;
use crate::machine::state::retraction::RetractionSettings;
use core::fmt;
use fixed::types::I32F32;

/// A code with its letters and a number for each.
#[derive(Clone, Copy)]
pub(in crate::machine) struct SettingLine {
    /// The code.
    pub code: &'static str,
    /// A letter for each number.
    pub letters: &'static str,
    /// The numbers; those without a letter do not count.
    pub numbers: [Number; 4],
}

impl SettingLine {
    /// A number for each axis.
    pub const fn of_axes(code: &'static str, numbers: [Number; 4]) -> Self {
        Self { code, letters: "XYZE", numbers }
    }

    /// M207: how G10 retracts.
    pub fn of_retraction(settings: &RetractionSettings) -> Self {
        let (length, feed, lift) =
            (exact(settings.length), exact(I32F32::from(settings.speed) * 60), exact(settings.lift));
        Self { code: "M207", letters: "SFZ", numbers: [length, feed, lift, Number::ZERO] }
    }

    /// M208: how G11 differs.
    pub fn of_recovery(settings: &RetractionSettings) -> Self {
        let (extra, feed) = (exact(settings.extra), exact(I32F32::from(settings.recover_speed) * 60));
        Self { code: "M208", letters: "SF", numbers: [extra, feed, Number::ZERO, Number::ZERO] }
    }
}

impl fmt::Display for SettingLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.code)?;
        self.letters.chars().zip(self.numbers).try_for_each(|(letter, number)| write!(f, " {letter}{number}"))
    }
}
