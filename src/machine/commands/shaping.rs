//! Shaping: input shapers and pressure advance as lines set them, and what the step generator is told of them.

use super::clamps::Clamps;
use super::settings::shown::Setting;
use crate::gcode::{AxisFlags, Number};
use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::reports::answer::Answer;
use crate::motion::{Work, stiffenings, taps};
use crate::port::Pend;
use crate::settings::{Shaper, ShaperKind, ranges};
use crate::units::{Hertz, Ratio, Seconds};
use fixed::traits::Fixed;
use fixed::types::I32F32;

/// The shapers that M593 T chooses from, by their numbers (Prusa-Firmware-Buddy).
const KINDS: [ShaperKind; 5] =
    [ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Mzv, ShaperKind::Ei, ShaperKind::TwoHumpEi];

/// What M593 says of a shaper.
#[derive(Clone, Copy)]
pub(in crate::machine) struct ShaperWords {
    pub axes: AxisFlags,
    pub frequency: Option<Number>,
    pub damping: Option<Number>,
    pub kind: Option<Number>,
}

/// The value nearest to a number.
pub(in crate::machine) fn nearest<T: Fixed>(number: Number) -> T {
    let half = I32F32::from_bits(1 << 31 >> T::FRAC_NBITS);
    T::saturating_from_num(number.value().saturating_add(half))
}

/// The number with the fewest decimals that is read as `value`. `fixed` can print that too, in 3 KiB of flash.
pub(in crate::machine) fn shortest<T: Fixed + Into<I32F32>>(value: T) -> Number {
    let (bits, half) = (value.into().to_bits(), 1u64 << 31 >> T::FRAC_NBITS);
    let fraction = bits as u64 & 0xFFFF_FFFF;
    let mut power = 1u64;
    let mut short = bits;
    for _ in 0..=9 {
        let decimals = (fraction * power + (1 << 31)) >> 32;
        let candidate = ((decimals << 32) + power / 2) / power;
        if candidate.abs_diff(fraction) < half {
            short = bits - fraction as i64 + candidate as i64;
            break;
        }
        power *= 10;
    }
    Number::saturating(I32F32::from_bits(short))
}

/// The number of a shaper in M593 T.
fn number_of(kind: ShaperKind) -> Option<usize> {
    KINDS.iter().position(|other| *other == kind)
}

fn kind_of(number: Number) -> Option<ShaperKind> {
    KINDS.into_iter().zip(0..).find(|(_, other)| Number::from(*other) == number).map(|(kind, _)| kind)
}

impl ShaperWords {
    /// These words with values in range.
    fn legal(&self, clamps: &mut Clamps) -> LegalWords {
        // 0 is off.
        let frequency = self
            .frequency
            .map(|number| (number > Number::ZERO).then(|| clamps.near(["M593", "F"], number, ranges::FREQUENCY)));
        let damping = self.damping.map(|number| clamps.near(["M593", "D"], number, ranges::DAMPING));
        LegalWords { frequency, damping }
    }
}

/// [`ShaperWords`] as values.
struct LegalWords {
    frequency: Option<Option<Hertz>>,
    damping: Option<Ratio>,
}

impl LegalWords {
    /// `shaper` as these words, which choose `kind` if any, want it.
    fn change(&self, shaper: Shaper, kind: Option<ShaperKind>) -> Shaper {
        let mut wanted = Shaper { kind: kind.unwrap_or(shaper.kind), ..shaper };
        wanted.damping = self.damping.unwrap_or(wanted.damping);
        match self.frequency {
            Some(Some(frequency)) => {
                wanted.frequency = frequency;
                if wanted.kind == ShaperKind::None {
                    wanted.kind = ShaperKind::Zv;
                }
            }
            Some(None) => wanted.kind = ShaperKind::None,
            None => {}
        }
        wanted
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M593. Motion comes to rest before a shaper changes.
    pub(in crate::machine) async fn set_shapers(&mut self, words: &ShaperWords) -> Result<Answer<'static>, Interrupt> {
        if words.frequency.or(words.damping).or(words.kind).is_none() {
            return Ok(Setting::Shapers.answer());
        }
        let kind = words.kind.and_then(kind_of);
        if words.kind.is_some() && kind.is_none() {
            return Ok(Answer::Line(
                "echo:M593 ignored: T is 0 (ZV), 1 (ZVD), 2 (MZV), 3 (EI) or 4 (2HUMP_EI), or P one of these names",
            ));
        }
        let words_in_range = words.legal(&mut self.clamps);
        let mut wanted = self.settings;
        let are_both = !words.axes.x && !words.axes.y;
        for (shaper, is_named) in [(&mut wanted.shapers.x, words.axes.x), (&mut wanted.shapers.y, words.axes.y)] {
            if is_named || are_both {
                *shaper = words_in_range.change(*shaper, kind);
            }
        }
        if wanted.shapers != self.settings.shapers {
            self.finish().await?;
            self.use_settings(wanted).await?;
        }
        Ok(Answer::Nothing)
    }

    /// M900, M572. The advance counts for the moves behind it. Motion comes to rest only before its window changes, and
    /// before the generator follows it for the first time: all axes are later from then on.
    pub(in crate::machine) async fn set_advance(
        &mut self,
        time: Option<Number>,
        window: Option<Number>,
    ) -> Result<Answer<'static>, Interrupt> {
        if time.or(window).is_none() {
            return Ok(Answer::Advance);
        }
        let mut wanted = self.settings;
        if let Some(time) = time {
            wanted.advance.time = self.clamps.near(["M900", "K"], time, ranges::ADVANCE);
        }
        if let Some(window) = window {
            wanted.advance.window = self.clamps.near(["M572", "W"], window, ranges::WINDOW);
        }
        let is_first = !self.has_advance && wanted.advance.time > Seconds::ZERO;
        if is_first || wanted.advance.window != self.settings.advance.window {
            self.finish().await?;
            self.use_settings(wanted).await?;
        } else {
            self.settings = wanted;
        }
        Ok(Answer::Nothing)
    }

    /// Tells the generator what each axis follows. Motion rests.
    pub(in crate::machine) async fn follow(&mut self) -> Result<(), Interrupt> {
        self.has_advance |= self.settings.advance.time > Seconds::ZERO;
        let window = self.has_advance.then_some(self.settings.advance.window);
        for (axis, stiffening) in stiffenings(&self.settings).into_iter().enumerate() {
            self.until(|c| c.link.has_room()).await?;
            self.link.send(Work::Stiffen(axis as u8, stiffening));
        }
        for (axis, taps) in taps(&self.settings.shapers, window).into_iter().enumerate() {
            self.until(|c| c.link.has_room()).await?;
            self.link.send(Work::Follow(axis as u8, taps));
        }
        Ok(())
    }

    /// M503, a line of M593.
    pub(in crate::machine) fn say_shaper(&mut self, axis: char, shaper: Shaper) {
        let (frequency, damping) = (shortest(shaper.frequency), shortest(shaper.damping));
        match number_of(shaper.kind) {
            Some(number) => self.say(format_args!("echo:  M593 {axis} F{frequency} D{damping} T{number}")),
            None => self.say(format_args!("echo:  M593 {axis} F0")),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::{String, ToString};

    /// What is printed of a number that was read.
    fn printed<T: Fixed + Into<I32F32>>(text: &str) -> String {
        let (number, _) = Number::read(text.as_bytes()).unwrap();
        shortest(nearest::<T>(number)).to_string()
    }

    #[test]
    fn values_are_printed_as_they_were_read() {
        for text in ["0", "0.05", "0.04", "0.00001", "0.1234567", "4", "0.9999999"] {
            assert_eq!(printed::<Seconds>(text), text);
        }
        for text in ["60", "61.1", "107.5", "499.99", "10.001", "0.055"] {
            assert_eq!(printed::<Hertz>(text), text);
        }
    }

    #[test]
    fn every_value_reads_back() {
        for bits in (0..1 << 26).step_by(997) {
            let value = Seconds::from_bits(bits);
            assert_eq!(nearest::<Seconds>(shortest(value)), value);
        }
        for bits in (0..500 << 16).step_by(13) {
            let value = Hertz::from_bits(bits);
            assert_eq!(nearest::<Hertz>(shortest(value)), value);
        }
    }
}
