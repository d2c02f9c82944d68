//! Fields: a setting by the type of its field, which says how its value is read and written.

use super::spec::Choice;
use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};

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

/// A field with a number.
pub(super) trait Number {
    /// Its number; none if another key has it.
    fn value(&self) -> Option<i64>;

    /// Takes a number, and returns whether it fits the type; otherwise nothing changes.
    fn put(&mut self, number: i64) -> bool;
}

impl<T: Number> Field for T {
    fn get(&self) -> Value {
        self.value().map_or(Value::Absent, Value::Number)
    }

    fn set(&mut self, value: &Value) -> bool {
        if let Value::Number(number) = value { self.put(*number) } else { false }
    }
}

/// Makes the fields of all types: choices, other numbers, names, and fields that stand for others. One function reads
/// all of them, and one writes them: a table of functions for each type, and a call for each row, take three times the
/// room in an image.
macro_rules! places {
    (
        choices: $($choice:ident($kind:ty)),+;
        numbers: $($number:ident($type:ty)),+;
        names: $($name:ident),+;
        others: $($other:ident),+;
    ) => {
        /// The field of a setting, by its type.
        #[derive(Debug)]
        #[allow(missing_docs, reason = "a variant has the name of its type")]
        pub enum Place<'a> {
            $($choice(&'a mut $kind),)+
            $($number(&'a mut $type),)+
            $($name(&'a mut $name),)+
            $($other($other<'a>),)+
        }

        places!(@from $($choice($kind)),+, $($number($type)),+, $($name($name)),+);

        $(impl<'a> From<$other<'a>> for Place<'a> {
            fn from(field: $other<'a>) -> Self {
                Self::$other(field)
            }
        })+

        impl Field for Place<'_> {
            fn get(&self) -> Value {
                let number = match self {
                    $(Self::$choice(field) => Number::value(*field),)+
                    $(Self::$number(field) => field.value(),)+
                    $(Self::$other(field) => field.value(),)+
                    $(Self::$name(field) => return field.get(),)+
                };
                number.map_or(Value::Absent, Value::Number)
            }

            fn set(&mut self, value: &Value) -> bool {
                let number = match (value, &mut *self) {
                    (Value::Number(number), _) => *number,
                    $((_, Self::$name(field)) => return field.set(value),)+
                    _ => return false,
                };
                // Once for all choices.
                let small = u8::try_from(number).ok();
                match self {
                    $(Self::$choice(field) => {
                        small.and_then(Choice::numbered).map(|choice| **field = choice).is_some()
                    })+
                    $(Self::$number(field) => field.put(number),)+
                    $(Self::$other(field) => field.put(number),)+
                    $(Self::$name(_) => false,)+
                }
            }
        }
    };
    (@from $($variant:ident($type:ty)),+) => {
        $(impl<'a> From<&'a mut $type> for Place<'a> {
            fn from(field: &'a mut $type) -> Self {
                Self::$variant(field)
            }
        })+
    };
}
pub(super) use places;

/// Fixed-point numbers, by their bits.
macro_rules! fixed {
    ($($type:ty),+) => {
        $(impl Number for $type {
            fn value(&self) -> Option<i64> {
                Some(i64::from(self.to_bits()))
            }

            fn put(&mut self, number: i64) -> bool {
                // By way of a type that none of them has, so that the conversion may fail for all.
                let Ok(bits) = i128::from(number).try_into() else { return false };
                *self = Self::from_bits(bits);
                true
            }
        })+
    };
}
fixed!(MmPerSec, MmPerSec2, StepsPerMm, Hertz, Seconds, Celsius, Watts, JoulesPerKelvin, WattsPerKelvin, Mm, Ratio);

/// Whole numbers.
macro_rules! whole {
    ($($type:ty),+) => {
        $(impl Number for $type {
            fn value(&self) -> Option<i64> {
                Some(i64::from(*self))
            }

            fn put(&mut self, number: i64) -> bool {
                let Ok(number) = number.try_into() else { return false };
                *self = number;
                true
            }
        })+
    };
}
whole!(u8, u16, u32, i16);

impl Number for bool {
    fn value(&self) -> Option<i64> {
        Some((*self).into())
    }

    fn put(&mut self, number: i64) -> bool {
        match number {
            0 => *self = false,
            1 => *self = true,
            _ => return false,
        }
        true
    }
}

impl<T: Choice> Number for T {
    fn value(&self) -> Option<i64> {
        Some(Choice::number(*self).into())
    }

    fn put(&mut self, number: i64) -> bool {
        let Some(choice) = u8::try_from(number).ok().and_then(T::numbered) else { return false };
        *self = choice;
        true
    }
}

/// A text as a value.
pub(super) fn text(parts: [&str; 2]) -> Value {
    let mut text = Text24::new();
    // A name that is too long is refused, so nothing is cut off.
    let _ = parts.into_iter().try_for_each(|part| text.push_str(part));
    Value::Text(text)
}
