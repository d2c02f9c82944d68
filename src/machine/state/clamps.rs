//! Values out of range: the old value stays and the host gets a message, or the value is set to the edge of its range.
//!
//! A line sets all of its values or none: with one out of range nothing of the line is done. A value from another
//! firmware has another unit or another meaning there. So the nearest legal value would be as wrong, and the old one is
//! the machine's own. A clamp is right only if the sender meant the edge; [`RULES`] lists these words, each with its
//! reason. A value that may have been intended (`M203 X300` in mm/min) is obeyed.

use crate::gcode::Number;
use crate::machine::numbers::{nearest, shortest, shortest_with, to_thousandth};
use crate::machine::state::modal::Modal;
use crate::settings::rows::Legal;
use crate::settings::{Range, plain, ranges};
use crate::text::Packed;
use crate::units::{Feed, MmPerSec, Quantity};
use core::fmt;
use fixed::types::I32F32;
use heapless::Vec;

/// A word as messages name it: the command, and the letter or name of the value.
pub(in crate::machine) type Word = [&'static str; 2];

/// The treatment of a value beyond an end of its range.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Beyond {
    /// The old value stays, and so do all other values of the line.
    Kept,
    /// It becomes the end of the range.
    Edge,
}

/// How the values of some words of a command are treated when they are out of range.
struct Rule {
    code: &'static str,
    /// Letters or names; none for all of the command.
    words: &'static [&'static str],
    below: Beyond,
    above: Beyond,
    /// The likely meaning of a value above the range.
    hint: Option<Packed>,
}

const fn edge(code: &'static str) -> Rule {
    Rule { code, words: &[], below: Beyond::Edge, above: Beyond::Edge, hint: None }
}

const fn off_below(code: &'static str) -> Rule {
    Rule { below: Beyond::Edge, above: Beyond::Kept, ..edge(code) }
}

const fn hinted(code: &'static str, hint: Packed) -> Rule {
    Rule { below: Beyond::Kept, above: Beyond::Kept, hint: Some(hint), ..edge(code) }
}

/// The likely meaning of a K too large for seconds: 20 to 200 in profiles of Linear Advance 1.0, 0 to 2 in profiles of
/// 1.5.
const SECONDS: Packed =
    packed!("K is in seconds (Linear Advance 1.5); a profile for Linear Advance 1.0 means another unit");

/// All words with a rule other than keeping the old value, or with a hint.
const RULES: [Rule; 17] = [
    // F: axes have limits anyway, so the fastest speed fulfils a faster F, the slowest a slower F. F0 and less mean no
    // motion at all, so the feed stays (`feed`).
    edge(""),
    // A fan runs between still and full speed, and slicers round to 256 or count in other units.
    edge("M106"),
    Rule { words: &["S"], ..edge("M710") },
    // Seconds between messages: a smaller interval becomes the smallest possible; Marlin does the same (M113.cpp,
    // M155.cpp).
    edge("M113"),
    edge("M123"),
    edge("M154"),
    edge("M155"),
    // A step of a host's buttons.
    edge("M290"),
    // A slider of a host: slower than the slowest is the slowest, and the limits of the axes bound the fastest.
    edge("M220"),
    // Below 0 a heater is off: -273 is how another firmware writes it (RepRapFirmware, M140).
    off_below("M104"),
    off_below("M109"),
    off_below("M140"),
    off_below("M141"),
    off_below("M190"),
    off_below("M191"),
    hinted("M900", SECONDS),
    hinted("M203", packed!("speeds are in mm/s")),
];

impl Rule {
    /// The rule for a word; `None` keeps.
    fn of([code, name]: Word) -> Option<&'static Self> {
        RULES.iter().find(|rule| rule.code == code && (rule.words.is_empty() || rule.words.contains(&name)))
    }
}

/// The fate of a value out of range.
#[derive(Clone, Copy)]
enum Outcome {
    /// It became that.
    Set(Number),
    /// It stays that.
    Stays(Number),
    /// The line is not carried out, and the value stays as it is, if there is one.
    Refused(Option<Number>),
}

/// A word of a command with a value out of range, as in `M203 X99999`.
#[derive(Clone, Copy)]
pub(in crate::machine) struct Clamp {
    word: Word,
    asked: Number,
    /// The legal range.
    legal: [Number; 2],
    outcome: Outcome,
}

impl fmt::Display for Clamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { word: [code, name], asked, legal: [least, most], outcome } = self;
        let gap = if code.is_empty() { "" } else { " " };
        match outcome {
            Outcome::Set(set) => put!(f, "{code}{gap}{name}{asked} is out of range, set to {set}"),
            Outcome::Stays(old) => put!(f, "{code}{gap}{name}{asked} is out of range, stays {old}"),
            Outcome::Refused(old) => {
                put!(f, "{code} ignored: {name}{asked} is out of range ({least} to {most})")?;
                if let Some(old) = old {
                    put!(f, ", stays {old}")?;
                }
                match Rule::of(self.word) {
                    Some(Rule { hint: Some(hint), .. }) if asked > most => write!(f, "; {hint}"),
                    _ => Ok(()),
                }
            }
        }
    }
}

/// The out-of-range values of a line.
#[derive(Default)]
pub(in crate::machine) struct Clamps {
    /// No command has more words with a range (M306 has seven).
    list: Vec<Clamp, 8>,
    refuses: bool,
}

/// A value of a line, and its form in messages.
struct Asked {
    word: Word,
    number: Number,
    /// The number in the unit of the value, before the limits of its type.
    value: I32F32,
    /// The number as far as the type can hold it.
    wanted: I32F32,
    /// Bits that the type has after the point.
    bits: u32,
}

impl Asked {
    fn new<T: Quantity>(word: Word, number: Number, value: I32F32, wanted: T) -> Self {
        Self { word, number, value, wanted: wanted.into(), bits: T::FRAC_NBITS }
    }
}

impl Clamps {
    pub const fn new() -> Self {
        Self { list: Vec::new(), refuses: false }
    }

    /// A value was out of range. Inlined, it would be repeated in every function for a type.
    #[inline(never)]
    fn note(&mut self, word: Word, asked: Number, legal: [Number; 2], outcome: Outcome) {
        self.refuses |= matches!(outcome, Outcome::Refused(_));
        let _ = self.list.push(Clamp { word, asked, legal, outcome });
    }

    /// Whether the line has no effect, because one of its values was refused.
    pub const fn refuses_line(&self) -> bool {
        self.refuses
    }

    /// Starts a line without clamps.
    pub fn clear(&mut self) {
        self.list.clear();
        self.refuses = false;
    }

    /// The clamp at this place, counted from 0: for a refused line only the reason.
    pub fn get(&self, place: usize) -> Option<Clamp> {
        let is_told = |clamp: &&Clamp| !self.refuses || matches!(clamp.outcome, Outcome::Refused(_));
        self.list.iter().filter(is_told).nth(place).copied()
    }

    /// The value if it is legal, or its fate. If the type holds a value far from the number, the type has cut it off.
    /// Messages show all values as `scale` converts them; `old` is the present one.
    #[inline(never)]
    fn judge(
        &mut self,
        asked: &Asked,
        range: Range<I32F32>,
        old: Option<I32F32>,
        scale: &dyn Fn(I32F32) -> I32F32,
    ) -> Option<I32F32> {
        let Asked { word, number, value, wanted, bits } = *asked;
        let legal = range.clamp(wanted);
        let is_cut = value.saturating_sub(wanted).saturating_abs() > I32F32::from_bits(1 << 32 >> bits);
        if legal == wanted && !is_cut {
            return Some(legal);
        }
        let told = |value| Number::saturating(scale(shortest_with(value, bits).value()));
        let ends = [told(range.least), told(range.most)];
        let is_below = value < range.least;
        let rule = Rule::of(word).map_or(Beyond::Kept, |rule| if is_below { rule.below } else { rule.above });
        match rule {
            Beyond::Edge => {
                self.note(word, number, ends, Outcome::Set(told(legal)));
                Some(legal)
            }
            Beyond::Kept => {
                self.note(word, number, ends, Outcome::Refused(old.map(told)));
                None
            }
        }
    }

    /// The same for a type.
    fn judge_typed<T: Quantity>(
        &mut self,
        asked: &Asked,
        range: Range<T>,
        old: Option<T>,
        scale: &dyn Fn(I32F32) -> I32F32,
    ) -> Option<T> {
        let range = Range { least: range.least.into(), most: range.most.into() };
        self.judge(asked, range, old.map(Into::into), scale).map(T::saturating_from)
    }

    /// The bits of a plain setting. `None` if it is refused. An exact one is cut off where its type ends, as positions
    /// are; a whole number at the point.
    pub fn setting(
        &mut self,
        modal: &Modal,
        word: plain::Word,
        asked: Number,
        legal: Legal,
        old: Option<i64>,
    ) -> Option<i64> {
        let line = word.line;
        let shift = 32 - line.bits;
        let fixed = |bits: i64| I32F32::from_bits(bits << shift);
        let value = match line.bits {
            _ if line.is_length => modal.unit(asked.value()),
            0 => Number::from(asked.to_int()).value(),
            _ => asked.value(),
        };
        let half = if line.is_exact { 0 } else { 1 << shift >> 1 };
        let wanted = value.to_bits().saturating_add(half) >> shift;
        // A type with a point and no sign: what is less than a unit below 0 is 0 to it.
        let wanted = fixed(if line.bits > 0 && legal.least >= 0 { wanted.max(0) } else { wanted });
        let asked = Asked { word: [line.code, word.letter()], number: asked, value, wanted, bits: line.bits };
        let range = Range { least: fixed(legal.least), most: fixed(legal.most) };
        let scale = |told| if line.is_length { modal.in_words(told) } else { told };
        self.judge(&asked, range, old.map(fixed), &scale).map(|legal| legal.to_bits() >> shift)
    }

    /// A length, or a length per second. `None` if it is refused.
    pub fn length_of<T: Quantity>(
        &mut self,
        modal: &Modal,
        word: Word,
        asked: Number,
        range: Range<T>,
        old: Option<T>,
    ) -> Option<T> {
        let value = modal.unit(asked.value());
        let asked = Asked::new(word, asked, value, T::saturating_from(value));
        self.judge_typed(&asked, range, old, &|told| modal.in_words(told))
    }

    /// The same, put into its place if it is not refused.
    pub fn length<T: Quantity>(&mut self, modal: &Modal, word: Word, asked: Number, range: Range<T>, place: &mut T) {
        *place = self.length_of(modal, word, asked, range, Some(*place)).unwrap_or(*place);
    }

    /// A length a minute, as the nearest speed.
    fn speed_of(&mut self, modal: &Modal, word: Word, asked: Number, old: Feed) -> Option<Feed> {
        const SHIFT: u32 = I32F32::FRAC_NBITS - Feed::FRAC_NBITS;
        const HALF: I32F32 = I32F32::from_bits(1 << SHIFT >> 1);
        let value = modal.unit(asked.value()) / 60;
        let wanted = I32F32::from_bits(value.saturating_add(HALF).to_bits() >> SHIFT << SHIFT);
        let asked = Asked { word, number: asked, value, wanted, bits: Feed::FRAC_NBITS };
        let range = Range { least: ranges::SPEED.least.into(), most: ranges::SPEED.most.into() };
        let scale = |told: I32F32| to_thousandth(modal.in_words(told.saturating_mul_int(60)));
        let legal = self.judge(&asked, range, Some(old.into()), &scale)?;
        Some(Feed::from_bits((legal.to_bits() >> SHIFT) as u32))
    }

    /// The same, put into its place if it is not refused.
    pub fn speed_a_minute(&mut self, modal: &Modal, word: Word, asked: Number, place: &mut MmPerSec) {
        let speed = self.speed_of(modal, word, asked, (*place).into());
        *place = speed.map_or(*place, MmPerSec::from);
    }

    /// F, in units a minute. `None` without it; 0 and less leave the feed as it is, and the line is carried out.
    pub fn feed(&mut self, modal: &Modal, asked: Option<Number>) -> Option<Feed> {
        const F: Word = ["", "F"];
        let asked = asked?;
        if asked > Number::ZERO {
            return self.speed_of(modal, F, asked, modal.feed);
        }
        let minute = shortest(modal.feed).value().saturating_mul_int(60);
        let stays = Number::saturating(to_thousandth(modal.in_words(minute)));
        self.note(F, asked, [stays; 2], Outcome::Stays(stays));
        None
    }

    /// Any other number, cut off where its type ends. `None` if it is refused.
    pub fn plain_of<T: Quantity>(&mut self, word: Word, asked: Number, range: Range<T>, old: Option<T>) -> Option<T> {
        let value = asked.value();
        let asked = Asked::new(word, asked, value, T::saturating_from(value));
        self.judge_typed(&asked, range, old, &|told| told)
    }

    /// The same, put into its place if it is not refused.
    pub fn plain<T: Quantity>(&mut self, word: Word, asked: Number, range: Range<T>, place: &mut T) {
        *place = self.plain_of(word, asked, range, Some(*place)).unwrap_or(*place);
    }

    /// Any other number, as the nearest value of its type. `None` if it is refused.
    pub fn near_of<T: Quantity>(&mut self, word: Word, asked: Number, range: Range<T>, old: Option<T>) -> Option<T> {
        let asked = Asked::new(word, asked, asked.value(), nearest::<T>(asked));
        self.judge_typed(&asked, range, old, &|told| told)
    }

    /// The same, put into its place if it is not refused. Inlined, it would be in a dozen places.
    #[inline(never)]
    pub fn near<T: Quantity>(&mut self, word: Word, asked: Number, range: Range<T>, place: &mut T) {
        *place = self.near_of(word, asked, range, Some(*place)).unwrap_or(*place);
    }

    /// A whole number; decimals are cut off. `None` if it is refused.
    pub fn whole_of(&mut self, word: Word, asked: Number, range: Range<u16>, old: Option<u16>) -> Option<u16> {
        let wanted = Number::from(asked.to_int()).value();
        let [least, most] = [range.least, range.most].map(I32F32::from);
        let old = old.map(I32F32::from);
        let asked = Asked::new(word, asked, wanted, wanted);
        self.judge(&asked, Range { least, most }, old, &|told| told).map(|legal| (legal.to_bits() >> 32) as u16)
    }

    /// The same, put into its place if it is not refused.
    pub fn whole(&mut self, word: Word, asked: Number, range: Range<u16>, place: &mut u16) {
        *place = self.whole_of(word, asked, range, Some(*place)).unwrap_or(*place);
    }
}

#[cfg(test)]
mod tests;
