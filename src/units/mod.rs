//! Units: the type of a number carries its unit, and conversions live here alone.
//!
//! Everything is integer or fixed point, so that every platform computes the same bits. The widths are
//! chosen so that the largest machine we drive leaves headroom: see the range beside each type.
//!
//! A length is a number of millimetres, and nothing else:
//!
//! ```
//! use corehbot::units::{Mm, Steps};
//! let sum = Mm::ONE + Mm::ONE;
//! ```
//!
//! So steps are no millimetres, and this does not compile:
//!
//! ```compile_fail,E0308
//! use corehbot::units::{Mm, Steps};
//! let sum = Mm::ONE + Steps::ONE;
//! ```
//!
//! Nor is a length a position, which has a sign:
//!
//! ```compile_fail,E0308
//! use corehbot::units::{Length, Mm};
//! let is_long = Length::of(Mm::ONE) > Mm::ONE;
//! ```
//!
//! Nor is a temperature a power:
//!
//! ```compile_fail,E0308
//! use corehbot::units::{Celsius, Power};
//! let sum = Power::ONE + Celsius::ONE;
//! ```
//!
//! A speed is no rate of steps without a resolution:
//!
//! ```
//! use corehbot::units::{MmPerSec, StepRate, StepsPerMm};
//! let is_legal = MmPerSec::ONE * StepsPerMm::ONE < StepRate::of_whole(500_000);
//! ```
//!
//! ```compile_fail,E0308
//! use corehbot::units::{MmPerSec, StepRate};
//! let is_legal = MmPerSec::ONE < StepRate::of_whole(500_000);
//! ```
//!
//! | file | for |
//! |---|---|
//! | `mod` | the quantities, one type for each unit |
//! | `quantity` | the operations that all quantities have |
//! | `plain` | from and to numbers without a unit |
//! | `length` | lengths of paths |
//! | `resolution` | between millimetres and steps, and their rates |
//! | `speed_sq` | squares of speeds, for ramps and corners |
//! | `ticks` | time in ticks |
//! | `lags` | lags of the first order in periods of a control loop |
//! | `wide` | integer arithmetic with all the bits in between |

mod lags;
mod length;
mod plain;
mod quantity;
mod resolution;
mod speed_sq;
mod ticks;
mod wide;

pub use lags::{part_per_period, periods_in};
pub use length::Length;
pub use plain::PlainNumber;
pub use quantity::Quantity;
pub use resolution::StepRate;
pub use speed_sq::SpeedSq;
pub use ticks::{Instant, SubTicks, TICKS_PER_MS, TICKS_PER_SECOND, Tick};
pub use wide::{mul_div, part_of, root, whole_root, wide_root};

use fixed::types::{I12F20, I32F32, U8F24, U12F20, U16F16, U24F8};
use quantity::{quantity, signed, wrapping};

quantity! {
    /// A length or position in millimetres; resolution 0.23 nm, range +-2.1e9 mm.
    Mm(I32F32, i64)
}
signed!(Mm);
wrapping!(Mm);

quantity! {
    /// A position of one motor or axis in (micro)steps, with the fraction that lies between two steps;
    /// range +-2.1e9 steps. Arithmetic on absolute positions wraps (an extruder never comes back), so
    /// differences are taken with `wrapping_sub`.
    Steps(I32F32, i64)
}
signed!(Steps);
wrapping!(Steps);

impl Mm {
    /// Whole micrometres, rounded down; the count wraps.
    #[must_use]
    pub const fn wrapping_um(self) -> i64 {
        self.to_bits().wrapping_mul(1000) >> Self::FRAC_NBITS
    }
}

impl Steps {
    /// So many whole steps; the count wraps.
    #[must_use]
    #[inline(always)]
    pub fn wrapping_from_num(count: i64) -> Self {
        Self::from_bits(count << Self::FRAC_NBITS)
    }

    /// The opposite, which wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// The magnitude, which wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_abs(self) -> Self {
        Self(self.0.wrapping_abs())
    }

    /// So many times as far; wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_mul_int(self, times: i64) -> Self {
        Self(self.0.wrapping_mul_int(times))
    }

    /// The nearest whole step, a half away from zero; wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_round(self) -> Self {
        Self(self.0.wrapping_round())
    }
}

quantity! {
    /// A speed in mm/s; resolution 15 um/s, range 65 m/s.
    MmPerSec(U16F16, u32)
}

quantity! {
    /// The commanded speed of a move in mm/s; resolution 1 um/s, range 4 m/s. A slow feed has few of these bits, and
    /// all the time of the move. An error of 0.002 % at 0.6 mm/min would be 0.05 % with the bits of [`MmPerSec`].
    Feed(U12F20, u32)
}

/// A speed that settings may have (`ranges::SPEED`).
impl From<MmPerSec> for Feed {
    #[inline(always)]
    fn from(speed: MmPerSec) -> Self {
        Self::from_bits(speed.to_bits() << (Self::FRAC_NBITS - MmPerSec::FRAC_NBITS))
    }
}

/// Cut off.
impl From<Feed> for MmPerSec {
    #[inline(always)]
    fn from(feed: Feed) -> Self {
        Self::from_bits(feed.to_bits() >> (Feed::FRAC_NBITS - Self::FRAC_NBITS))
    }
}

quantity! {
    /// An acceleration in mm/s2; resolution 0.004 mm/s2, range 16.7 km/s2.
    MmPerSec2(U24F8, u32)
}

quantity! {
    /// A motor's resolution in (micro)steps a millimetre.
    StepsPerMm(U16F16, u32)
}

quantity! {
    /// A frequency; resolution 15 uHz.
    Hertz(U16F16, u32)
}

quantity! {
    /// A short time in s; resolution 0.06 us, range 256 s.
    Seconds(U8F24, u32)
}

quantity! {
    /// A ratio; resolution 15 millionths.
    Ratio(U16F16, u32)
}

quantity! {
    /// A temperature in degrees Celsius, or a difference in K; resolution a millionth, range +-2048.
    Celsius(I12F20, i32)
}
signed!(Celsius);

quantity! {
    /// A power in W; resolution 15 uW, range 65 kW.
    Watts(U16F16, u32)
}

quantity! {
    /// A flow of heat or power in W, with a sign, as models reckon with it; resolution a millionth, range +-2048 W.
    Power(I12F20, i32)
}
signed!(Power);

impl Watts {
    /// This part of it, within the range.
    #[must_use]
    pub fn part(self, part: Ratio) -> Power {
        const SHIFT: u32 = Watts::FRAC_NBITS + Ratio::FRAC_NBITS - Power::FRAC_NBITS;
        let bits = (u64::from(self.to_bits()) * u64::from(part.to_bits())) >> SHIFT;
        Power::from_bits(i32::try_from(bits).unwrap_or(i32::MAX))
    }
}

quantity! {
    /// A heat capacity in J/K; resolution 15 millionths, range 65 kJ/K.
    JoulesPerKelvin(U16F16, u32)
}

quantity! {
    /// Heat that flows for each K of difference, in W/K, or that a mm of filament takes, in J/(K mm); range 256.
    WattsPerKelvin(U8F24, u32)
}
