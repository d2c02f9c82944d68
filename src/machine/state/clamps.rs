//! Values out of range: each is brought to the edge of its range, and the host is told.

use crate::gcode::Number;
use crate::machine::numbers::{nearest, shortest, to_thousandth};
use crate::machine::state::modal::Modal;
use crate::settings::{Range, ranges};
use crate::units::{Mm, MmPerSec};
use core::fmt;
use fixed::traits::Fixed;
use fixed::types::I32F32;
use heapless::Vec;

/// A word of a command whose value was out of range, as `M203 X99999`.
#[derive(Clone, Copy)]
pub(in crate::machine) struct Clamp {
    word: [&'static str; 2],
    asked: Number,
    set: Number,
}

impl fmt::Display for Clamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { word: [code, name], asked, set } = self;
        let gap = if code.is_empty() { "" } else { " " };
        write!(f, "{code}{gap}{name}{asked} is out of range, set to {set}")
    }
}

/// What a line asked for beyond all ranges.
#[derive(Default)]
pub(in crate::machine) struct Clamps {
    /// No command has more words with a range.
    list: Vec<Clamp, 6>,
}

impl Clamps {
    pub const fn new() -> Self {
        Self { list: Vec::new() }
    }

    /// `asked` became `set`. Inlined, it would stand in every function for a type.
    #[inline(never)]
    pub fn note(&mut self, word: [&'static str; 2], asked: Number, set: Number) {
        let _ = self.list.push(Clamp { word, asked, set });
    }

    /// Nothing was brought into range after all.
    pub fn clear(&mut self) {
        self.list.clear();
    }

    /// The value at this place, counted from 0.
    pub fn get(&self, place: usize) -> Option<Clamp> {
        self.list.get(place).copied()
    }

    /// `wanted` in its range. `wanted` is what its type can hold of `value`; if they are far apart, the type has cut `value`
    /// off. The host is told the legal value as `scale` converts it.
    fn bring<T: Fixed + Into<I32F32>>(
        &mut self,
        word: [&'static str; 2],
        asked: Number,
        value: I32F32,
        wanted: T,
        range: Range<T>,
        scale: impl FnOnce(I32F32) -> I32F32,
    ) -> T {
        let legal = range.clamp(wanted);
        let is_cut = value.saturating_sub(wanted.into()).saturating_abs() > T::DELTA.into();
        if legal != wanted || is_cut {
            self.note(word, asked, Number::saturating(scale(shortest(legal).value())));
        }
        legal
    }

    /// A length, or so many of them a second.
    pub fn length<T: Fixed + Into<I32F32>>(
        &mut self,
        modal: &Modal,
        word: [&'static str; 2],
        asked: Number,
        range: Range<T>,
    ) -> T {
        let value = modal.length(asked);
        self.bring(word, asked, value, T::saturating_from_num(value), range, |set| modal.in_words(set))
    }

    /// A length a minute, as a speed.
    pub fn speed_a_minute(&mut self, modal: &Modal, word: [&'static str; 2], asked: Number) -> MmPerSec {
        let value: Mm = modal.length(asked) / 60;
        let scale = |set: I32F32| to_thousandth(modal.in_words(set.saturating_mul_int(60)));
        self.bring(word, asked, value, MmPerSec::saturating_from_num(value), ranges::SPEED, scale)
    }

    /// F, in units a minute. `None` without it; 0 and less leave the feed as it is.
    pub fn feed(&mut self, modal: &Modal, asked: Option<Number>) -> Option<MmPerSec> {
        const F: [&str; 2] = ["", "F"];
        let asked = asked?;
        if asked > Number::ZERO {
            return Some(self.speed_a_minute(modal, F, asked));
        }
        let minute = shortest(modal.feed).value().saturating_mul_int(60);
        self.note(F, asked, Number::saturating(to_thousandth(modal.in_words(minute))));
        None
    }

    /// Any other number, cut off where its type ends.
    pub fn plain<T: Fixed + Into<I32F32>>(&mut self, word: [&'static str; 2], asked: Number, range: Range<T>) -> T {
        let value = asked.value();
        self.bring(word, asked, value, T::saturating_from_num(value), range, |set| set)
    }

    /// Any other number, as the nearest value of its type.
    pub fn near<T: Fixed + Into<I32F32>>(&mut self, word: [&'static str; 2], asked: Number, range: Range<T>) -> T {
        self.bring(word, asked, asked.value(), nearest(asked), range, |set| set)
    }

    /// A whole number; decimals are cut off.
    pub fn whole(&mut self, word: [&'static str; 2], asked: Number, range: Range<u16>) -> u16 {
        let legal = asked.to_int().clamp(i32::from(range.least), i32::from(range.most));
        if legal != asked.to_int() {
            self.note(word, asked, Number::from(legal));
        }
        legal as u16
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::units::{MmPerSec2, Seconds};
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn number(text: &str) -> Number {
        Number::read(text.as_bytes()).unwrap().0
    }

    fn texts(clamps: &Clamps) -> Vec<String> {
        clamps.list.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_in_range_is_not_reported() {
        let (mut clamps, modal) = (Clamps::new(), Modal::new());
        for text in ["0.01", "3000", "250.3", "0.1234567"] {
            clamps.length(&modal, ["M203", "X"], number(text), ranges::SPEED);
        }
        for text in ["0", "4", "0.00001", "3.9999999"] {
            clamps.near(["M900", "K"], number(text), ranges::ADVANCE);
        }
        for text in ["0.001", "1"] {
            clamps.length(&modal, ["M205", "J"], number(text), ranges::TOLERANCE);
        }
        for text in ["0.6", "180000", "1800"] {
            clamps.feed(&modal, Some(number(text)));
        }
        clamps.whole(["M113", "S"], number("60.9"), Range { least: 0, most: 60 });
        assert_eq!(texts(&clamps), [""; 0]);
    }

    #[test]
    fn what_is_beyond_is_reported_in_the_units_of_the_line() {
        let (mut clamps, mut modal) = (Clamps::new(), Modal::new());
        assert_eq!(clamps.length(&modal, ["M203", "X"], number("99999"), ranges::SPEED), ranges::SPEED.most);
        assert_eq!(clamps.length(&modal, ["M201", "X"], number("0"), ranges::ACCELERATION), MmPerSec2::ONE);
        // A type without a sign holds 0 of it, which is legal.
        assert_eq!(clamps.near(["M900", "K"], number("-1"), ranges::ADVANCE), Seconds::ZERO);
        modal.inches = true;
        assert_eq!(clamps.feed(&modal, Some(number("99999"))), Some(ranges::SPEED.most));
        assert_eq!(clamps.feed(&modal, Some(number("-5"))), None);
        assert_eq!(clamps.whole(["M220", "S"], number("-5"), Range { least: 10, most: 999 }), 10);
        assert_eq!(
            texts(&clamps),
            [
                "M203 X99999 is out of range, set to 3000",
                "M201 X0 is out of range, set to 1",
                "M900 K-1 is out of range, set to 0",
                "F99999 is out of range, set to 7086.614",
                "F-5 is out of range, set to 118.11",
                "M220 S-5 is out of range, set to 10",
            ]
        );
    }
}
