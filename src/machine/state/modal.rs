//! Modal state: values that earlier lines set, and the resulting meaning of a number. Where a line leads with it:
//! [`commanded`](super::commanded).

use crate::gcode::{Number, Plane};
use crate::machine::numbers::to_thousandth;
use crate::settings::Range;
use crate::units::{Feed, Mm, part_of};
use fixed::types::I32F32;

/// Positions of all lines are kept within +-10 m: no machine is larger, and no sum overflows.
pub(in crate::machine) const FARTHEST: Range<Mm> =
    Range { least: Mm::const_from_int(-10_000), most: Mm::const_from_int(10_000) };

/// Overrides in percent (M220, M221): a tenth to ten times, as Marlin accepts them.
pub(in crate::machine) const PERCENT: Range<u16> = Range { least: 10, most: 999 };

/// The speed of moves before the first F: 50 mm/s suits any axis once its limit is applied.
const FIRST_FEED: Feed = Feed::const_from_int(50);

/// The distance within which two places of a program count as one. It is the last decimal that the program writes,
/// within two limits. A micrometre is the least, because binary numbers and G92 may cost as much; 10 are the most,
/// because a print can show that much.
const ROUNDING: Range<Mm> = Range { least: Mm::lit("0.001"), most: Mm::lit("0.01") };

/// Whether two places are far enough apart for a program to mean it: relative moves, G92 and inches leave less between
/// them.
pub(in crate::machine) fn are_apart(one: Mm, other: Mm) -> bool {
    one.saturating_sub(other).saturating_abs() >= ROUNDING.least
}

/// The last decimal, by the number of decimals.
const LAST_DECIMALS: [I32F32; 6] = [
    I32F32::ONE,
    I32F32::lit("0.1"),
    I32F32::lit("0.01"),
    I32F32::lit("0.001"),
    I32F32::lit("0.0001"),
    I32F32::lit("0.00001"),
];

/// Millimetres an inch, exactly 25.4, as the fraction 127/5.
const INCH: (u64, u64) = (127, 5);

/// The modes.
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
    pub feed: Feed,
    /// M220 B.
    pub kept_feed_percent: u16,
    /// M221.
    pub flow_percent: u16,
    /// M111 S8: everything moves but the filament.
    pub dry_run: bool,
}

impl Modal {
    /// As after a reset: absolute, millimetres.
    pub const fn new() -> Self {
        Self {
            absolute: true,
            absolute_extrusion: true,
            inches: false,
            plane: Plane::Xy,
            feed: FIRST_FEED,
            kept_feed_percent: 100,
            flow_percent: 100,
            dry_run: false,
        }
    }

    /// The modes of a program that continues where it was `before`, with the present overrides.
    pub const fn restored(&self, before: &Self) -> Self {
        let Self { kept_feed_percent, flow_percent, dry_run, .. } = *self;
        Self { kept_feed_percent, flow_percent, dry_run, ..*before }
    }

    /// A number of a line as a length.
    pub fn length(&self, number: Number) -> Mm {
        Mm::from_bits(self.unit(number.value()).to_bits())
    }

    /// A number of the units of lines as a number of mm.
    pub fn unit(&self, value: I32F32) -> I32F32 {
        if self.inches { I32F32::from_bits(part_of(value.to_bits(), INCH.0, INCH.1)) } else { value }
    }

    /// The largest distance of places that coordinates with this many decimals mean as one.
    pub fn rounding(&self, decimals: u8) -> Mm {
        let last = LAST_DECIMALS.get(usize::from(decimals)).copied().unwrap_or(I32F32::ZERO);
        ROUNDING.clamp(Mm::from_bits(self.unit(last).to_bits()))
    }

    /// A number of mm as lines give it, to a thousandth.
    pub fn in_words(&self, length: I32F32) -> I32F32 {
        if !self.inches {
            return length;
        }
        to_thousandth(I32F32::from_bits(part_of(length.to_bits(), INCH.1, INCH.0)))
    }
}
