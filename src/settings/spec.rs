//! Specs: the numbers of a setting that are legal, and its kind of value.

/// One of a few things, which a machine file calls by a name and a record by its number.
pub trait Choice: Copy + PartialEq + 'static {
    /// All of them by their numbers, with their names.
    const ALL: &'static [(Self, &'static str)];

    /// Its number.
    fn number(self) -> u8;

    /// The one with that number, if there is one.
    fn numbered(number: u8) -> Option<Self>;
}

/// The numbers of a [`Choice`] with variants alone, in the order of `ALL`. Without `ALL`: an image need not have the
/// names then.
macro_rules! numbers {
    ($($variant:ident)+) => {
        fn number(self) -> u8 {
            self as u8
        }

        fn numbered(number: u8) -> Option<Self> {
            $(if number == Self::$variant as u8 {
                return Some(Self::$variant);
            })+
            None
        }
    };
}
pub(super) use numbers;

/// The kind of value of a setting: its form in a machine file.
#[derive(Clone, Copy, Debug)]
pub enum ValueKind {
    /// A number with this many bits after the point.
    Fixed(u32),
    /// A whole number.
    Whole,
    /// `true` or `false`.
    Switch,
    /// One of these names, by its number.
    Choice(fn(usize) -> Option<&'static str>),
    /// Such a number, or "auto" for 0.
    Auto(u32),
    /// A whole number of one motor. It is left out for 0: the value of its group counts.
    OfMotor,
    /// A whole place in mm. It is left out for the greatest legal number, which is no place.
    Place,
    /// The name of a machine.
    Name,
    /// The name of a motor.
    MotorName,
    /// The name of a connector, with `!` before it if it is inverted.
    Plug,
    /// The name of a connector.
    Connector,
    /// The name of a thermistor, or its numbers.
    Thermistor,
    /// The turn of a motor for a step of each axis.
    MotorRow,
}

/// Which numbers are legal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Legal {
    /// The least, in bits; of texts 0.
    pub least: i64,
    /// The greatest, in bits; of texts their most characters.
    pub most: i64,
    /// Whether 0 is legal too, although it is less than `least`: it switches something off.
    pub may_be_zero: bool,
    /// The values are texts.
    pub is_text: bool,
    /// Their type has numbers below 0, so records have a sign for them. It stays as it is for an id.
    pub is_signed: bool,
    /// The legal values of the parts that follow, if they have others.
    pub next: Option<&'static Self>,
}

impl Legal {
    /// Whether a number is legal.
    #[must_use]
    pub const fn holds(&self, number: i64) -> bool {
        (self.least <= number && number <= self.most) || (self.may_be_zero && number == 0)
    }
}

/// The legal values of a setting.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    /// Which numbers are legal.
    pub legal: Legal,
    /// Its kind of value.
    pub kind: ValueKind,
}

impl Spec {
    /// `true` or `false`.
    pub const SWITCH: Self = Self::new(0, 1, ValueKind::Switch);

    pub(super) const fn new(least: i64, most: i64, kind: ValueKind) -> Self {
        Self { legal: Legal { least, most, may_be_zero: false, is_text: false, is_signed: false, next: None }, kind }
    }

    /// One of these.
    #[must_use]
    pub const fn choice<T: Choice>() -> Self {
        Self::new(0, T::ALL.len() as i64 - 1, ValueKind::Choice(name_of::<T>))
    }

    /// A text of `longest` characters at most.
    pub(super) const fn text(longest: usize, kind: ValueKind) -> Self {
        let Self { legal, kind } = Self::new(0, longest as i64, kind);
        Self { legal: Legal { is_text: true, ..legal }, kind }
    }

    /// A number that its field packs and reads by itself, from -`most` to `most`.
    pub(super) const fn packed(most: i64, kind: ValueKind) -> Self {
        Self::new(-most, most, kind).of_signed(true)
    }

    /// The same, of a type that has numbers below 0 or none.
    pub(super) const fn of_signed(self, is_signed: bool) -> Self {
        Self { legal: Legal { is_signed, ..self.legal }, ..self }
    }

    /// Bits after the point of its number.
    pub(super) const fn bits(self) -> u32 {
        match self.kind {
            ValueKind::Fixed(bits) | ValueKind::Auto(bits) => bits,
            _ => 0,
        }
    }

    /// The same, and 0 as well, which is "auto".
    #[must_use]
    pub const fn or_auto(self) -> Self {
        match self.kind {
            ValueKind::Fixed(bits) => Self { kind: ValueKind::Auto(bits), ..self.or_zero() },
            _ => self,
        }
    }

    /// The same, and 0 as well, which is the value of the motor's group.
    #[must_use]
    pub const fn or_group(self) -> Self {
        Self { kind: ValueKind::OfMotor, ..self.or_zero() }
    }

    /// The same, and the next number above them as well, which is none.
    #[must_use]
    pub const fn or_nowhere(self) -> Self {
        Self { kind: ValueKind::Place, legal: Legal { most: self.legal.most + 1, ..self.legal } }
    }

    /// The same, and 0 as well.
    #[must_use]
    pub const fn or_zero(self) -> Self {
        Self { legal: Legal { may_be_zero: true, ..self.legal }, ..self }
    }

    /// The same from 0 on.
    #[must_use]
    pub const fn from_zero(self) -> Self {
        Self { legal: Legal { least: 0, ..self.legal }, ..self }
    }
}

/// The name of a choice.
fn name_of<T: Choice>(number: usize) -> Option<&'static str> {
    T::ALL.get(number).map(|(_, name)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accelerometer::{SensorAxis, SensorKind as Accelerometer};
    use crate::connectors::{Output, Sensor};
    use crate::settings::{
        Alignment, AxisEnd, Control, FanRole, HomedAxis, OnFailure, ProbeKind, SensorSource, ShaperKind, Tachometer,
    };

    /// Whether the numbers of a choice are the places in its list.
    fn is_numbered<T: Choice>() -> bool {
        let is_in_place = |(place, (choice, _)): (usize, &(T, &str))| {
            usize::from(choice.number()) == place && T::numbered(place as u8) == Some(*choice)
        };
        T::ALL.iter().enumerate().all(is_in_place) && T::numbered(T::ALL.len() as u8).is_none()
    }

    #[test]
    fn the_number_of_a_choice_is_its_place_in_the_list() {
        assert!(is_numbered::<AxisEnd>() && is_numbered::<HomedAxis>() && is_numbered::<SensorAxis>());
        assert!(is_numbered::<Option<Accelerometer>>() && is_numbered::<SensorSource>() && is_numbered::<Sensor>());
        assert!(is_numbered::<Output>() && is_numbered::<Control>() && is_numbered::<FanRole>());
        assert!(is_numbered::<Tachometer>() && is_numbered::<ProbeKind>() && is_numbered::<Alignment>());
        assert!(is_numbered::<OnFailure>() && is_numbered::<ShaperKind>());
    }
}
