//! Arithmetic of the thermal room: everything saturates, so that no input brings about nonsense.

use crate::units::Ratio;
use fixed::FixedI32;
use fixed::types::I12F20;
use fixed::types::extra::{LeEqU32, Unsigned};

/// A power in W with a sign, a millionth fine; +-2048.
pub type Power = I12F20;

/// Control periods a second.
pub const RATE: i32 = 50;

/// Milliseconds of a control period.
pub const PERIOD_MS: u32 = 1000 / RATE.unsigned_abs();

/// A value times a factor.
#[inline(always)]
pub fn times<F: Unsigned + LeEqU32>(value: I12F20, factor: FixedI32<F>) -> I12F20 {
    let product = i64::from(value.to_bits()) * i64::from(factor.to_bits());
    I12F20::from_bits(saturated(product >> F::U32))
}

/// A product or quotient in 32 bits.
#[inline(always)]
pub fn saturated(wide: i64) -> i32 {
    wide.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// A duty of 0 to 65,535 as a part of one.
#[inline(always)]
pub fn share(duty: u16) -> Ratio {
    Ratio::from_bits(u32::from(duty) + u32::from(duty >> 15))
}

/// The part that `value` is of `whole`, as a duty.
#[inline(always)]
pub fn duty(value: Power, whole: Power) -> u16 {
    if whole <= Power::ZERO {
        return 0;
    }
    let part = (i64::from(value.max(Power::ZERO).to_bits()) * 65_535) / i64::from(whole.to_bits());
    part.min(65_535) as u16
}
