//! Modal state: what earlier lines said that still holds, and what a line therefore means.

use crate::gcode::{AxisWords, Number, Plane};
use crate::machine::numbers::to_thousandth;
use crate::settings::{Range, Settings};
use crate::units::{Mm, MmPerSec, part_of};

/// Positions are kept within +-10 m, whatever a line says: no machine is larger, and no sum overflows.
pub(in crate::machine) const FARTHEST: Range<Mm> =
    Range { least: Mm::const_from_int(-10_000), most: Mm::const_from_int(10_000) };

/// Overrides in percent (M220, M221): a tenth to ten times, as Marlin accepts them.
pub(in crate::machine) const PERCENT: Range<u16> = Range { least: 10, most: 999 };

/// The speed of moves before the first F: 50 mm/s suits any axis once its limit is applied.
const FIRST_FEED: MmPerSec = MmPerSec::const_from_int(50);

/// Millimetres an inch, exactly 25.4, as the fraction 127/5.
const INCH: (u64, u64) = (127, 5);

/// What still holds.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Modal {
    /// G90; cleared by G91.
    pub absolute: bool,
    /// M82; cleared by M83. E is relative if either this or `absolute` is cleared.
    pub absolute_extrusion: bool,
    /// G20; cleared by G21.
    pub inches: bool,
    /// G17, G18, G19.
    pub plane: Plane,
    /// F, before the override.
    pub feed: MmPerSec,
    /// M220 B.
    pub kept_feed_percent: u16,
    /// M221.
    pub flow_percent: u16,
    /// M111 S8: everything moves but the filament.
    pub dry_run: bool,
    /// Where the machine is commanded to: x, y, z as machine coordinates, e as filament really asked for.
    pub position: [Mm; 4],
    /// What a program calls 0, as machine coordinates (G92).
    pub origin: [Mm; 3],
    /// E as the program counts it.
    pub extrusion: Mm,
}

/// What a line of motion asks for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Wanted {
    /// Target in machine coordinates.
    pub position: [Mm; 4],
    /// E as the program will count it then.
    pub extrusion: Mm,
    /// Whether filament was asked for that must not move.
    pub is_held_back: bool,
    /// Whether the filament asked for in one move was more than there may be; it is left out then.
    pub too_much: bool,
    /// Whether the target was farther away than any machine reaches, and lies at the farthest place now.
    pub is_too_far: bool,
}

impl Modal {
    /// As after a reset: absolute, millimetres, at `position`.
    pub const fn new(position: [Mm; 3]) -> Self {
        let [x, y, z] = position;
        Self {
            absolute: true,
            absolute_extrusion: true,
            inches: false,
            plane: Plane::Xy,
            feed: FIRST_FEED,
            kept_feed_percent: 100,
            flow_percent: 100,
            dry_run: false,
            position: [x, y, z, Mm::ZERO],
            origin: [Mm::ZERO; 3],
            extrusion: Mm::ZERO,
        }
    }

    /// A number of a line as a length.
    pub fn length(&self, number: Number) -> Mm {
        let value = number.value();
        if self.inches { Mm::from_bits(part_of(value.to_bits(), INCH.0, INCH.1)) } else { value }
    }

    /// A length as lines give it, to a thousandth.
    pub fn in_words(&self, length: Mm) -> Mm {
        if !self.inches {
            return length;
        }
        to_thousandth(Mm::from_bits(part_of(length.to_bits(), INCH.1, INCH.0)))
    }

    /// Where the words of a line lead. No filament moves if it `is_cold`; the program counts it all the same.
    pub fn target(&self, words: &AxisWords, settings: &Settings, is_cold: bool) -> Wanted {
        let mut is_too_far = false;
        let mut axis = |word: Option<Number>, at: Mm, origin: Mm| match word.map(|n| self.length(n)) {
            None => at,
            Some(v) => {
                let target = if self.absolute { origin.saturating_add(v) } else { at.saturating_add(v) };
                is_too_far |= !FARTHEST.holds(target);
                FARTHEST.clamp(target)
            }
        };
        let [x, y, z, e] = self.position;
        let [ox, oy, oz] = self.origin;
        let extrusion = match words.e.map(|n| self.length(n)) {
            None => self.extrusion,
            Some(v) if self.absolute && self.absolute_extrusion => v,
            Some(v) => self.extrusion.saturating_add(v),
        };
        let asked = extrusion.saturating_sub(self.extrusion);
        let flow_percent = if self.dry_run || is_cold { 0 } else { self.flow_percent };
        let flow = Mm::from_bits(part_of(asked.to_bits(), u64::from(flow_percent), 100));
        let too_much = flow.saturating_abs() > settings.axes.e.length;
        Wanted {
            position: [
                axis(words.x, x, ox),
                axis(words.y, y, oy),
                axis(words.z, z, oz),
                if too_much { e } else { e.wrapping_add(flow) },
            ],
            extrusion,
            is_held_back: is_cold && asked != Mm::ZERO,
            too_much,
            is_too_far,
        }
    }

    /// From now on the present position is called what the words say (G92).
    pub fn rename(&mut self, words: &AxisWords) {
        let names = [words.x, words.y, words.z].map(|word| word.map(|n| FARTHEST.clamp(self.length(n))));
        for ((origin, at), name) in self.origin.iter_mut().zip(self.position).zip(names) {
            if let Some(name) = name {
                *origin = at.saturating_sub(name);
            }
        }
        if let Some(e) = words.e {
            self.extrusion = self.length(e);
        }
    }

    /// The axis carries the machine's own zero again (G28).
    pub fn forget_origin(&mut self, axis: usize) {
        if let Some(origin) = self.origin.get_mut(axis) {
            *origin = Mm::ZERO;
        }
    }

    /// Where the program believes to be.
    pub fn named_position(&self, position: [Mm; 4]) -> [Mm; 4] {
        let [x, y, z, e] = position;
        let [ox, oy, oz] = self.origin;
        // Filament that was commanded and not yet moved, as the program counts it.
        let missing = self.position[3].wrapping_sub(e);
        [x - ox, y - oy, z - oz, self.extrusion.saturating_sub(missing)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(n, _)| n)
    }

    fn modal() -> (Modal, Settings) {
        (Modal::new([Mm::from_num(10), Mm::from_num(20), Mm::from_num(5)]), Settings::prototype())
    }

    fn words(x: &str, e: &str) -> AxisWords {
        AxisWords { x: number(x), e: number(e), ..AxisWords::default() }
    }

    #[test]
    fn relative_extrusion_needs_only_one_of_its_two_switches() {
        let (mut m, s) = modal();
        m.extrusion = Mm::from_num(7);
        assert_eq!(m.target(&words("1", "8"), &s, false).extrusion, Mm::from_num(8));
        m.absolute_extrusion = false;
        assert_eq!(m.target(&words("1", "8"), &s, false).extrusion, Mm::from_num(15));
        m.absolute_extrusion = true;
        m.absolute = false;
        assert_eq!(m.target(&words("1", "8"), &s, false).extrusion, Mm::from_num(15));
        assert_eq!(m.target(&words("1", "8"), &s, false).position[0], Mm::from_num(11));
    }

    #[test]
    fn flow_stretches_the_filament_but_not_the_program_count() {
        let (mut m, s) = modal();
        m.flow_percent = 150;
        let w = m.target(&words("1", "2"), &s, false);
        assert_eq!((w.extrusion, w.position[3]), (Mm::from_num(2), Mm::from_num(3)));
    }

    #[test]
    fn a_new_name_moves_nothing() {
        let (mut m, s) = modal();
        m.rename(&words("0", "0"));
        assert_eq!(m.position[0], Mm::from_num(10));
        assert_eq!(m.target(&words("5", ""), &s, false).position[0], Mm::from_num(15));
        assert_eq!(m.named_position(m.position)[0], Mm::ZERO);
    }

    #[test]
    fn inches_are_exact_and_huge_numbers_end_at_the_farthest_place() {
        let (mut m, s) = modal();
        m.inches = true;
        assert_eq!(m.target(&words("5", ""), &s, false).position[0], Mm::from_num(127));
        assert_eq!(m.target(&words("999999999999", ""), &s, false).position[0], Mm::from_num(10_000));
        assert!(m.target(&words("999999999999", ""), &s, false).is_too_far);
        assert!(m.target(&words("1", "99999"), &s, false).too_much);
        assert!(!m.target(&words("1", "99999"), &s, false).is_too_far);
    }
}
