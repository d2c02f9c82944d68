//! Pairs: the words of Klipper's commands, `NAME=VALUE`.

use crate::gcode::lexer::is_blank;
use crate::gcode::number::Number;
use crate::gcode::parts::Flaw;
use crate::text::is_word;
use fixed::types::I32F32;

/// A pair.
pub struct Pair<'a> {
    /// Both, as they are written.
    word: &'a [u8],
    /// The name.
    pub name: &'a [u8],
    /// The value after the `=`, without quotes.
    pub value: &'a [u8],
    /// The place of the name in the list of names; behind its end for any other name.
    pub place: usize,
}

impl<'a> Pair<'a> {
    /// What is said of a pair that is not in order.
    #[must_use]
    pub const fn flaw(&self) -> Flaw<'a> {
        Flaw::NoPair(self.word)
    }

    /// Puts the number of a pair into its place, if there is such a place; or says that the value is no number.
    #[inline(never)]
    pub fn put_number(&self, numbers: &mut [Option<Number>]) -> Option<Flaw<'a>> {
        let slot = numbers.get_mut(self.place)?;
        *slot = scientific(self.value);
        if slot.is_none() { Some(self.flaw()) } else { None }
    }
}

/// Shows each pair of a text to a function, and returns the first flaw: of a word that is no pair, or the function's.
#[inline(never)]
pub fn flaw_of_pairs<'a>(
    text: &'a [u8],
    names: &[&str],
    take: &mut dyn FnMut(&Pair<'a>) -> Option<Flaw<'a>>,
) -> Option<Flaw<'a>> {
    for word in words(text) {
        let Some((name, value)) = named_value(word) else { return Some(Flaw::NoPair(word)) };
        let place = names.iter().position(|known| is_word(name, known.as_bytes())).unwrap_or(names.len());
        let flaw = take(&Pair { word, name, value, place });
        if flaw.is_some() {
            return flaw;
        }
    }
    None
}

/// The words between blanks, up to a comment. A text in quotes belongs to its word, with its spaces.
fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let text = text.split(|byte| *byte == b';').next().unwrap_or_default();
    let mut is_quoted = false;
    let ends_word = move |byte: &u8| {
        is_quoted ^= *byte == b'"';
        is_blank(*byte) && !(is_quoted && *byte == b' ')
    };
    text.split(ends_word).filter(|word| !word.is_empty())
}

/// A name and the value after its `=`, which may stand in quotes.
fn named_value(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = word.iter().position(|byte| *byte == b'=').filter(|length| *length > 0)?;
    let value = match word.get(length + 1..)? {
        [b'"', inside @ .., b'"'] => inside,
        value => value,
    };
    Some((word.get(..length)?, value))
}

/// `number` times a power of ten, to the nearest (a tie away from zero).
#[must_use]
pub fn times_ten_to(number: Number, exponent: Number) -> Number {
    let (bits, exponent) = (number.value().to_bits(), exponent.to_int());
    // Beyond 10^18 no digit is left, or it is beyond all limits.
    let mut power = 1;
    for _ in 0..exponent.unsigned_abs().min(18) {
        power *= 10;
    }
    let bits = if exponent < 0 { (bits + bits.signum() * (power / 2)) / power } else { bits.saturating_mul(power) };
    Number::saturating(I32F32::from_bits(bits))
}

/// A number that may have an exponent, up to the end of the text.
fn scientific(text: &[u8]) -> Option<Number> {
    let (number, after) = Number::read(text)?;
    let (exponent, after) = match after {
        [b'e' | b'E', exponent @ ..] => Number::read(exponent)?,
        _ => (Number::ZERO, after),
    };
    after.is_empty().then(|| times_ten_to(number, exponent))
}
