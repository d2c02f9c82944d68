//! Names of motors, as machine files give them.

use crate::text::{NameKind, ShortName};

/// The kind of [`MotorName`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum OfMotor {}

impl NameKind for OfMotor {
    const IS_ALPHANUMERIC: bool = true;
    const EXPECTED: &str = "the name of a motor, of at most 4 letters and digits";
}

/// The name of a motor: up to 4 letters and digits of ASCII. The empty name is no motor.
pub type MotorName = ShortName<4, OfMotor>;

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    #[test]
    fn a_name_is_short_and_of_letters_and_digits() {
        for text in ["m1", "z3", "Yr", "1234", ""] {
            let name = MotorName::new(text).unwrap();
            assert_eq!((name.as_str(), name.is_none()), (text, text.is_empty()));
            assert_eq!((format!("{name}"), format!("{name:?}")), (text.into(), format!("{text:?}")));
        }
        for text in ["12345", "m 1", "m,1", "m.1", "#1", "\u{fc}"] {
            assert_eq!(MotorName::new(text), None, "{text}");
        }
    }
}
