//! The heat that goes into a heater, leaves it and shows, as sums that forget.
//!
//! | sum | the rise of the block by |
//! |---|---|
//! | given | the arriving power, by the model |
//! | moved | what the reading shows |
//! | lost | the model's losses, which the reading does not show |
//!
//! All forget alike, so they can be compared. By the model, what is given has moved the reading or is lost.

use super::heat_balance::Numbers;
use super::{Seen, periods};
use crate::thermal::fixed_point::{driven, rise, times};
use crate::thermal::room::ROOM;
use crate::units::{Celsius, Power};
use fixed::types::I8F24;

/// Time within which a hotend's sums forget, in s, and a bed's.
const QUICK_S: u32 = 3;
const SLOW_S: u32 = 30;

/// The sums of a heater.
#[derive(Clone, Copy, Debug)]
pub struct HeatSums {
    /// The reading of the period before, if there was one.
    before: Option<Celsius>,
    /// Power that arrives in the block, and power that arrives where the sensor shows it.
    arriving: Power,
    shown: Power,
    /// Heat that leaves for each K, as late as the sensor shows it.
    leaving: I8F24,
    /// The sums.
    pub(super) given: Celsius,
    pub(super) moved: Celsius,
    pub(super) lost: Celsius,
}

impl Default for HeatSums {
    fn default() -> Self {
        Self::new()
    }
}

impl HeatSums {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        let (arriving, shown, leaving) = (Power::ZERO, Power::ZERO, I8F24::ZERO);
        let (given, moved, lost) = (Celsius::ZERO, Celsius::ZERO, Celsius::ZERO);
        Self { before: None, arriving, shown, leaving, given, moved, lost }
    }

    /// Periods within which the sums of a heater forget.
    #[must_use]
    pub const fn memory(is_quick: bool) -> i32 {
        periods(if is_quick { QUICK_S } else { SLOW_S }).cast_signed()
    }

    /// The heat that was found again: it has moved the reading, or is lost.
    #[must_use]
    pub fn found(&self) -> Celsius {
        self.moved.saturating_add(self.lost)
    }

    /// Follows a control period: the readings, the given power, and the heat that leaves for each K.
    pub fn follow(&mut self, n: &Numbers, is_quick: bool, seen: &Seen, power: Power, leaving: I8F24) {
        let before = self.before.replace(seen.smooth).unwrap_or_else(|| {
            self.leaving = leaving;
            seen.smooth
        });
        self.arriving = self.arriving.saturating_add(times(power.saturating_sub(self.arriving), n.element));
        self.shown = self.shown.saturating_add(times(self.arriving.saturating_sub(self.shown), n.sensor));
        let more = i64::from(leaving.saturating_sub(self.leaving).to_bits()) * i64::from(n.sensor.to_bits());
        self.leaving = self.leaving.saturating_add(I8F24::from_bits((more >> 32) as i32));
        let lost = rise(driven(seen.smooth.saturating_sub(ROOM), self.leaving), n.warming);
        let memory = Self::memory(is_quick);
        let add = |sum: &mut Celsius, more: Celsius| {
            *sum = sum.saturating_sub(Celsius::from_bits(sum.to_bits() / memory)).saturating_add(more);
        };
        add(&mut self.given, rise(self.shown, n.warming));
        add(&mut self.moved, seen.smooth.saturating_sub(before));
        add(&mut self.lost, lost);
    }
}
