//! The lag watch: a loose sensor lags far behind the block. If heating stopped only when the sensor shows the target,
//! the block would be far too hot.
//!
//! At full power, the heat given by the heater rises with time. The heat found by the sensor's reading (stored plus
//! lost so far) rises by the same slope, but later: by the lag.
//!
//! ```text
//!   heat    given /    / found
//!                /    /
//!               /<-->/   lag = time - found / slope
//!              /   _/
//! ```

use super::fixed_point::{RATE, driven, kelvin, saturated};
use super::room::ROOM;
use crate::settings::HeaterModel;
use crate::units::{Celsius, Power};
use fixed::types::{I8F24, I12F20};

/// Time over which the slope is measured, in s, and in periods.
const SLOPE_S: i32 = 8;
const SLOPE: u32 = SLOPE_S.unsigned_abs() * RATE.unsigned_abs();

/// Only a heating from below counts: the losses of a hot block are no better known than its model. A block of 70 W that
/// is heated again two minutes after a print is below.
const COLD: Celsius = Celsius::const_from_int(120);

/// With losses above a quarter of the power, the result depends more on the losses than on the lag.
const LOSSES: i32 = 4;

/// A lag that exceeds this many times the model's, and this many seconds more, replaces the model's.
const TIMES: i64 = 2;
const MORE_S: i64 = 2;

/// The measured lag and slope.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Seen {
    /// From the heater to the sensor, in s with 24 fractional bits.
    pub lag: i64,
    /// K/s.
    pub slope: I12F20,
}

/// Numbers from the model: J/K with 16 fractional bits, W/K, and its lags in s with 24 fractional bits.
#[derive(Clone, Copy, Debug, Hash)]
pub struct LagNumbers {
    capacity: i64,
    loss: I8F24,
    lag: i64,
}

/// Watches a heating from the cold.
#[derive(Clone, Copy, Debug)]
pub struct LagWatch {
    numbers: LagNumbers,
    /// Temperature at the beginning, if there is one.
    begun_at: Option<Celsius>,
    periods: u32,
    /// Heat lost since, in J times 50 with 20 fractional bits.
    lost: i64,
    /// Heat found at the begin of the current slope, in J with 20 fractional bits, and the temperature.
    before: (i64, Celsius),
}

impl LagWatch {
    /// No heating yet.
    #[must_use]
    pub fn new(model: &HeaterModel) -> Self {
        Self {
            numbers: LagNumbers {
                capacity: model.capacity.to_bits().into(),
                loss: I8F24::from_bits(saturated(model.loss.to_bits().into())),
                lag: i64::from(model.heater_lag.to_bits()) + i64::from(model.sensor_lag.to_bits()),
            },
            begun_at: None,
            periods: 0,
            lost: 0,
            before: (0, Celsius::ZERO),
        }
    }

    /// The numbers from the model.
    pub const fn numbers(&self) -> &LagNumbers {
        &self.numbers
    }

    /// Follows a control period; `is_full` if the heater is at its limit, `is_warming` if heat was under way before it.
    pub fn look(&mut self, measured: Celsius, power: Power, is_full: bool, is_warming: bool) -> Option<Seen> {
        let LagNumbers { capacity, loss, lag: model_lag } = self.numbers;
        let losses = driven(measured.saturating_sub(ROOM), loss).max(Power::ZERO);
        let is_known = losses <= power / LOSSES;
        if !is_full || !is_known {
            self.begun_at = None;
            // From the cold only, not in the middle of a heating, and without heat under way.
            self.periods = if power == Power::ZERO && !is_warming && measured < COLD { 0 } else { u32::MAX };
            return None;
        }
        if self.periods == u32::MAX {
            return None;
        }
        let begun_at = *self.begun_at.get_or_insert(measured);
        if self.periods == 0 {
            (self.lost, self.before) = (0, (0, measured));
        }
        self.periods += 1;
        self.lost += i64::from(losses.to_bits());
        if !self.periods.is_multiple_of(SLOPE) {
            return None;
        }
        let rise = i64::from(measured.saturating_sub(begun_at).to_bits());
        // Both with 20 fractional bits: a capacity has 16.
        let found = ((rise.saturating_mul(capacity)) >> 16) + self.lost / i64::from(RATE);
        let (found_before, measured_before) = core::mem::replace(&mut self.before, (found, measured));
        // J/s with 20 fractional bits; s with 24.
        let slope = (found - found_before) * i64::from(RATE) / i64::from(SLOPE);
        let time = (i64::from(self.periods) << 24) / i64::from(RATE);
        // 36 fractional bits over 12 are 24. A slope of 0 or less tells no lag (`is_other`), but must not divide by 0.
        let lag = time - (found << 16) / (slope >> 8).max(1);
        let is_other = slope > 0 && lag > TIMES * model_lag + (MORE_S << 24);
        let slope = kelvin(measured.saturating_sub(measured_before)) / SLOPE_S;
        is_other.then_some(Seen { lag, slope })
    }
}
