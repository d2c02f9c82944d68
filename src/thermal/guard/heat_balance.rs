//! Heat that went in must be found again: in the warmer mass, or in its losses.
//!
//! A fixed rate (2 C in 20 s) is too strict for a warm bed and too lax for a hotend. The balance holds at every
//! temperature. It compares the heat that the mass took up and lost, by its model, with the heat that the heater gave.
//! The room may be cold, so losses are those to the coldest room.

use super::{Alarm, Episode, Seen, periods, periods_of_lags};
use crate::fault::Cause;
use crate::settings::{HeaterModel, HeaterSettings};
use crate::thermal::fixed_point::{RATE, driven, duty, part_per_period, saturated, times};
use crate::thermal::room::COLDEST_ROOM;
use crate::units::{Celsius, JoulesPerKelvin, Power, Ratio};
use fixed::types::{I0F32, I8F24};

/// Lags in a balance, so that heat on its way is a small part of it, ...
const LAGS: u32 = 6;

/// ... and its least length: the time after which Klipper and Marlin check a hotend, in s.
const LEAST_S: u32 = 20;

/// A balance counts if the given heat would warm the mass by this much: less is noise.
const LEAST_RISE: Celsius = Celsius::const_from_int(6);

/// Heat does not disappear: it is in the mass, or lost at no more than twice the model's rate. If this much of the
/// found heat has disappeared, something cold was laid on, or the sensor has slipped. The balance then says nothing.
/// The floor has numbers for a slipped sensor.
const GONE: Celsius = Celsius::const_from_int(2);

/// Periods between two such checks: a check costs 64-bit products, and a second of delay does not matter.
const LOOKS: u32 = 50;

/// The guard: an episode from the first power until all heat has arrived, or something cold comes.
#[derive(Clone, Copy, Debug)]
pub struct HeatBalance {
    numbers: Numbers,
    balance: Episode<(), Balance>,
}

/// Numbers from the settings. They are part of the settings' sum, which finds failing memory. Guards of heat share
/// them.
#[derive(Clone, Copy, Debug, Hash)]
pub struct Numbers {
    /// The fraction of the heat that must be found.
    least: Ratio,
    capacity: JoulesPerKelvin,
    loss: I8F24,
    fan_loss: I8F24,
    /// Control periods of a balance.
    length: u32,
    /// Fraction of the heat that arrives in a period.
    pub(super) arrival: I0F32,
    /// The same from the heater to the block, and from there to the sensor.
    pub(super) element: I0F32,
    pub(super) sensor: I0F32,
    /// K in a period for each W.
    pub(super) warming: I0F32,
    /// The heater's power at its greatest permitted duty.
    pub(super) most: Power,
    /// The power of the dither, and its duty.
    pub(super) dither: Power,
    pub(super) dither_duty: u16,
}

/// The observations of this balance.
#[derive(Clone, Copy, Debug)]
struct Balance {
    begun_at: Celsius,
    left: u32,
    /// The power that arrives.
    arriving: Power,
    /// Heat that has arrived and heat lost in this balance, in J times 50, with 20 fractional bits.
    given: i64,
    lost: i64,
    /// The most heat that was in the mass or lost at twice the model's rate, in the same unit.
    most: i64,
}

impl Numbers {
    fn new(settings: &HeaterSettings, is_quick: bool) -> Self {
        let HeaterModel { capacity, loss, fan_loss, heater_lag, sensor_lag, ptc: _ } = settings.model;
        let [loss, fan_loss] = [loss, fan_loss].map(|loss| I8F24::from_bits(saturated(loss.to_bits().into())));
        let length = periods(LEAST_S).max(periods_of_lags(LAGS, &settings.model));
        let arrival = part_per_period(settings.model.lag());
        let joules = i64::from(capacity.to_bits()).max(1 << 14) * i64::from(RATE);
        let warming = I0F32::from_bits(saturated((1 << 48) / joules));
        let most = settings.power.part(settings.max_duty.min(Ratio::ONE));
        let [element, sensor] = [heater_lag, sensor_lag].map(part_per_period);
        // A K in so many seconds. Of 16 fractional bits, 20. A heater that is weak for its capacity gets less.
        let full = settings.power.part(Ratio::ONE);
        let heat_s = if is_quick { 16 } else { 160 };
        let dither = Power::from_bits(saturated((i64::from(capacity.to_bits()) << 4) / heat_s)).min(full / 16);
        let dither_duty = duty(dither, full);
        let least = settings.guards.heating;
        Self { least, capacity, loss, fan_loss, length, arrival, element, sensor, warming, most, dither, dither_duty }
    }

    /// Heat that leaves the mass for each K: to the room, to the part fan's air, and to the filament.
    pub fn leaving(&self, fan: Ratio, filament: I8F24) -> I8F24 {
        let fan = I8F24::from_bits(saturated(
            (i64::from(self.fan_loss.to_bits()) * i64::from(fan.to_bits())) >> Ratio::FRAC_NBITS,
        ));
        self.loss.saturating_add(fan).saturating_add(filament)
    }

    /// Those of heat: capacity, losses, lag and power.
    pub const fn of_heat(&self) -> (I0F32, I8F24, I8F24, I0F32, Power) {
        (self.warming, self.loss, self.fan_loss, self.arrival, self.most)
    }

    /// Heat for such a rise, in J times 50 with 20 fractional bits.
    fn heat(&self, rise: Celsius) -> i64 {
        (i64::from(rise.to_bits()) * i64::from(RATE)).saturating_mul(self.capacity.to_bits().into())
            >> JoulesPerKelvin::FRAC_NBITS
    }
}

impl HeatBalance {
    /// The guard of a heater whose heat shows within seconds, or does not.
    #[must_use]
    pub fn new(settings: &HeaterSettings, is_quick: bool) -> Self {
        Self { numbers: Numbers::new(settings, is_quick), balance: Episode::none() }
    }

    /// Sets other thresholds; the balance continues.
    pub fn configure(&mut self, settings: &HeaterSettings, is_quick: bool) {
        self.numbers = Numbers::new(settings, is_quick);
    }

    /// The numbers from the settings.
    #[must_use]
    pub const fn numbers(&self) -> &Numbers {
        &self.numbers
    }

    /// Follows a control period: whether heat is on its way, the readings, the given power, and the heat that leaves
    /// for each K ([`Numbers::leaving`]).
    pub fn look(&mut self, is_heated: bool, seen: &Seen, power: Power, leaving: I8F24) -> Option<Alarm> {
        let (n, measured) = (&self.numbers, seen.measured);
        let begin = || Balance { begun_at: measured, left: 0, arriving: Power::ZERO, given: 0, lost: 0, most: 0 };
        let balance = self.balance.follow(is_heated.then_some(()), begin)?;
        if balance.left == 0 {
            // The heat on its way goes on from the last balance: it was given there, and is found here.
            *balance = Balance { left: n.length, arriving: balance.arriving, ..begin() };
        }
        let lost = driven(measured.saturating_sub(COLDEST_ROOM), leaving).max(Power::ZERO);
        let more = times(power.saturating_sub(balance.arriving), n.arrival);
        balance.arriving = balance.arriving.saturating_add(more);
        balance.given += i64::from(balance.arriving.to_bits());
        balance.lost += i64::from(lost.to_bits());
        // A model that was set meanwhile may have made it shorter.
        balance.left = balance.left.min(n.length) - 1;
        // Before the balance is struck: with heat that has gone it would alarm.
        if balance.left.is_multiple_of(LOOKS) && balance.has_gone(n, seen.smooth) {
            self.balance = Episode::none();
            return None;
        }
        if balance.left == 0 { balance.strike(n, measured) } else { None }
    }
}

impl Balance {
    /// Whether found heat has disappeared.
    fn has_gone(&mut self, numbers: &Numbers, smooth: Celsius) -> bool {
        let there = numbers.heat(smooth.saturating_sub(self.begun_at)).saturating_add(2 * self.lost);
        self.most = self.most.max(there);
        there < self.most - numbers.heat(GONE)
    }

    fn strike(&self, numbers: &Numbers, measured: Celsius) -> Option<Alarm> {
        let rise = measured.saturating_sub(self.begun_at);
        let wanted = (self.given >> 16).saturating_mul(numbers.least.to_bits().into());
        let found = numbers.heat(rise).saturating_add(self.lost);
        // Losses are known to within half of them: a bed in a cold room that lost 1.4 times as much as its model
        // counted as one that does not heat. So given heat counts only where it is twice the losses; the floor covers
        // the rest.
        if self.given < numbers.heat(LEAST_RISE).max(2 * self.lost) || found >= wanted {
            return None;
        }
        // The missing heat, in degrees.
        let missing = wanted.saturating_sub(found) / numbers.heat(Celsius::ONE).max(1);
        let limit = rise.saturating_add(Celsius::saturating_from_num(missing));
        Some(Alarm { cause: Cause::HeatsTooSlowly, value: rise, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::{Output, Sensor};
    use crate::units::{Seconds, Watts, WattsPerKelvin};

    /// Reproducer: a hotend of 30 W in a room of 7 C, over a cold bed, was held at 37 C. It needed 3.8 times the power
    /// of its model, its reading hardly rose, and it counted as a heater that does not heat.
    #[test]
    fn a_low_target_in_a_cold_room_is_in_balance() {
        let mut settings = HeaterSettings::hotend(Output::He0, Sensor::Hotend0);
        settings.power = Watts::from_num(30);
        settings.model.capacity = JoulesPerKelvin::from_num(13.4);
        settings.model.loss = WattsPerKelvin::from_num(0.0968);
        (settings.model.heater_lag, settings.model.sensor_lag) = (Seconds::from_num(0.95), Seconds::from_num(1.65));
        let mut guard = HeatBalance::new(&settings, true);
        let (mut block, mut reading, mut arriving) = (36.2_f64, 36.8_f64, 0.0_f64);
        for n in 0..3000 {
            // 0.05 W/K of its losses go to the bed.
            let watt = 4.6;
            arriving += (watt - arriving) / (0.95 * 50.0);
            block += (arriving - 0.147 * (block - 7.0)) / (13.4 * 50.0);
            reading += (block - reading) / (1.65 * 50.0);
            let seen = Seen { duty: 1, ..Seen::quiet(Celsius::from_num(reading)) };
            let leaving = guard.numbers().leaving(Ratio::ZERO, I8F24::ZERO);
            let found = guard.look(true, &seen, Power::from_num(watt), leaving);
            assert_eq!(found, None, "after {n} periods, at {reading:.1} C");
        }
    }
}
