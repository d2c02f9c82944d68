//! The plain settings of a code, as the line that sets them.

use crate::machine::numbers::{exact, shortest_with};
use crate::settings::plain::Word;
use crate::settings::rows::Value;
use crate::settings::{CornerRule, Settings};
use core::fmt::{self, Display, Formatter};
use fixed::types::I32F32;

/// The plain settings of a code.
pub(super) struct PlainSetting<'s> {
    pub code: u16,
    pub s: &'s Settings,
}

impl Display for PlainSetting<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "M{}", self.code)?;
        if self.code == 205 {
            write_corner_rule(f, self.s.corner)?;
        }
        let mut written = Ok(());
        self.s.clone().visit_code(self.code, &mut |word: Word, field| {
            if let Value::Number(bits) = field.get() {
                let value = I32F32::from_bits(bits << (32 - word.line.bits));
                let number = if word.line.is_exact { exact(value) } else { shortest_with(value, word.line.bits) };
                written = written.and_then(|()| write!(f, " {}{number}", word.letter()));
            }
        });
        written
    }
}

/// The letter of M205 that chooses the rule for corners, with its value.
fn write_corner_rule(f: &mut Formatter<'_>, corner: CornerRule) -> fmt::Result {
    match corner {
        CornerRule::JunctionDeviation(deviation) => write!(f, " J{}", exact(deviation)),
        CornerRule::SquareCorner(speed) => {
            let speed = exact(speed);
            write!(f, " X{speed} Y{speed}")
        }
    }
}
