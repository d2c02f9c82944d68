//! Heat that went in must be found again: in a thing that is warmer, or in what it loses because it is warm.
//!
//! A fixed rate (2 C in 20 s) is too strict for a bed that is warm already and too lax for a hotend. The balance holds at
//! every temperature: what the thing took up and lost by its model, as a part of what the heater gave.

use super::{Alarm, Episode, periods, periods_of_lags};
use crate::fault::Cause;
use crate::settings::{HeaterModel, HeaterSettings};
use crate::thermal::fixed_point::{Power, RATE, part_per_period, saturated, times};
use crate::thermal::room::ROOM;
use crate::units::{Celsius, JoulesPerKelvin, Ratio};
use fixed::types::{I0F32, I8F24};

/// A balance is struck over this many lags, so that what is on its way is a small part of it, ...
const LAGS: u32 = 6;

/// ... and over no less than this: the time after which Klipper and Marlin look at a hotend, in s.
const LEAST_S: u32 = 20;

/// A balance counts if the heat that was given would warm the thing by so much: less is noise.
const LEAST_RISE: Celsius = Celsius::const_from_int(6);

/// The guard that strikes the balance: an episode from the first power until all heat has arrived.
#[derive(Clone, Copy, Debug)]
pub struct HeatBalance {
    numbers: Numbers,
    balance: Episode<(), Balance>,
}

/// What the settings come to. They are summed up with the settings, for memory that fails.
#[derive(Clone, Copy, Debug, Hash)]
pub struct Numbers {
    /// The part that has to be found.
    least: Ratio,
    capacity: JoulesPerKelvin,
    loss: I8F24,
    fan_loss: I8F24,
    /// Control periods of a balance.
    length: u32,
    /// Parts a period by which heat arrives.
    arrival: I0F32,
}

/// What was seen in this balance.
#[derive(Clone, Copy, Debug)]
struct Balance {
    begun_at: Celsius,
    left: u32,
    /// The power that arrives.
    arriving: Power,
    /// Heat that has arrived and heat lost in this balance, in J times 50, with 20 fractional bits.
    given: i64,
    lost: i64,
}

impl Numbers {
    fn new(settings: &HeaterSettings) -> Self {
        let HeaterModel { capacity, loss, fan_loss, .. } = settings.model;
        let [loss, fan_loss] = [loss, fan_loss].map(|loss| I8F24::from_bits(saturated(loss.to_bits().into())));
        let length = periods(LEAST_S).max(periods_of_lags(LAGS, &settings.model));
        let arrival = part_per_period(settings.model.lag());
        Self { least: settings.guards.heating, capacity, loss, fan_loss, length, arrival }
    }
}

impl HeatBalance {
    /// The guard of a heater.
    #[must_use]
    pub fn new(settings: &HeaterSettings) -> Self {
        Self { numbers: Numbers::new(settings), balance: Episode::none() }
    }

    /// Other thresholds; the balance goes on.
    pub fn configure(&mut self, settings: &HeaterSettings) {
        self.numbers = Numbers::new(settings);
    }

    /// What the settings have come to.
    #[must_use]
    pub const fn numbers(&self) -> &Numbers {
        &self.numbers
    }

    /// Looks at a control period: whether heat is on its way, the temperature, the power that was given, the part fan, the
    /// filament in W/K.
    pub fn look(
        &mut self,
        is_heated: bool,
        measured: Celsius,
        power: Power,
        fan: Ratio,
        filament: I8F24,
    ) -> Option<Alarm> {
        let n = &self.numbers;
        let begin = || Balance { begun_at: measured, left: 0, arriving: Power::ZERO, given: 0, lost: 0 };
        let balance = self.balance.follow(is_heated.then_some(()), begin)?;
        if balance.left == 0 {
            (balance.begun_at, balance.left, balance.given, balance.lost) = (measured, n.length, 0, 0);
        }
        let fan = I8F24::from_bits(saturated(
            (i64::from(n.fan_loss.to_bits()) * i64::from(fan.to_bits())) >> Ratio::FRAC_NBITS,
        ));
        let leaving = n.loss.saturating_add(fan).saturating_add(filament);
        let lost = times(measured.saturating_sub(ROOM), leaving).max(Power::ZERO);
        let more = times(power.saturating_sub(balance.arriving), n.arrival);
        balance.arriving = balance.arriving.saturating_add(more);
        balance.given += i64::from(balance.arriving.to_bits());
        balance.lost += i64::from(lost.to_bits());
        balance.left = balance.left.min(n.length) - 1;
        if balance.left == 0 { balance.strike(n, measured) } else { None }
    }
}

impl Balance {
    fn strike(&self, numbers: &Numbers, measured: Celsius) -> Option<Alarm> {
        let rise = measured.saturating_sub(self.begun_at);
        // J times 50 with 20 fractional bits, as the others.
        let heat = |rise: Celsius| {
            (i64::from(rise.to_bits()) * i64::from(RATE)).saturating_mul(numbers.capacity.to_bits().into())
                >> JoulesPerKelvin::FRAC_NBITS
        };
        let wanted = (self.given >> 16).saturating_mul(numbers.least.to_bits().into());
        let found = heat(rise).saturating_add(self.lost);
        // Losses are known to half of them: a bed in a cold room that loses 1.4 times as much as its model says was taken for one that
        // does not heat. So heat that was given counts only where it is twice what is lost; the floor looks at the rest.
        if self.given < heat(LEAST_RISE).max(2 * self.lost) || found >= wanted {
            return None;
        }
        // What is missing, in degrees.
        let missing = wanted.saturating_sub(found) / heat(Celsius::ONE).max(1);
        let limit = rise.saturating_add(Celsius::saturating_from_num(missing));
        Some(Alarm { cause: Cause::HeatsTooSlowly, value: rise, limit })
    }
}
