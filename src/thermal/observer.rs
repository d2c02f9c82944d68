//! The observer: values of a heater's model that its sensor does not show yet.
//!
//! ```text
//!   power ──▶ element ──▶ block ──▶ sensor
//!             heater_lag    │       sensor_lag
//!                           └──▶ room, part fan, filament
//! ```
//!
//! The model runs in parallel with the heater, with the same power. If the sensor disagrees, block and sensor of the
//! model are corrected, and the model's error is learned. While the heater is free, this is an additional power
//! (`drift`). At full power it is the ratio of the real power to the model's (`gain`): a weak supply, a worn cartridge,
//! a heavier block. It is a Luenberger observer with all three poles at the same place (K. Astrom and R. Murray,
//! Feedback Systems, section 8.2).

use super::fixed_point::{RATE, driven, kelvin, over, part_per_period, rise, saturated, times};
use super::lag_watch::Seen;
use super::room::ROOM;
use crate::settings::{HeaterModel, HeaterSettings};
use crate::units::{Celsius, Power, Ratio, Seconds};
use fixed::types::{I0F32, I2F30, I8F24, I12F20};

/// Limits of the gain: 18 V at a supply of 24 V are 0.56, 26 V 1.17, a block may be a third lighter or heavier.
const GAIN: [I8F24; 2] = [I8F24::lit("0.4"), I8F24::lit("1.8")];

/// The shortest time constant for an observer with a period of 20 ms.
const SHORTEST_LAG: Seconds = Seconds::lit("0.125");

/// A past control period.
#[derive(Clone, Copy, Debug)]
pub struct Past {
    /// The heater's power.
    pub power: Power,
    /// Whether the heater could have taken more, and less, power.
    pub is_free: bool,
    /// The part fan's duty, of 1.
    pub fan: Ratio,
    /// Heat that the filament takes away for each K, in W/K.
    pub filament: I8F24,
    /// The sensor's reading, if it is not doubtful.
    pub measured: Option<Celsius>,
}

/// The model's numbers, ready for a control period.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Coefficients {
    /// K per period and W.
    warming: I0F32,
    /// Fractions per period by which the block's heat follows the power, and the sensor the block.
    element: I0F32,
    sensor: I0F32,
    /// W/K.
    loss: I8F24,
    fan_loss: I8F24,
    /// s.
    heater_lag: I12F20,
    /// W per K of missing temperature: the heat is made up for within `heater_lag`.
    pub grip: I12F20,
    /// Corrections of the sensor, the block and the drift per K of innovation.
    sensor_step: I0F32,
    block_step: I0F32,
    drift_step: I12F20,
    /// The same for the gain, as a fraction per K.
    gain_step: I2F30,
}

impl Coefficients {
    /// The numbers of a heater.
    #[must_use]
    pub fn new(settings: &HeaterSettings) -> Self {
        let HeaterModel { capacity, loss, fan_loss, heater_lag, sensor_lag, ptc: _ } = settings.model;
        let [element, sensor] = [heater_lag, sensor_lag].map(|lag| lag.max(SHORTEST_LAG));
        // Lags in s with 24 fractional bits, the capacity in J/K with 16.
        let [heater_lag, sensor_lag] = [element, sensor].map(|lag| i64::from(lag.to_bits()));
        let capacity = i64::from(capacity.to_bits()).max(1 << 14);
        let rate = i64::from(RATE);
        // Place w of the poles, in rad/s with 24 fractional bits: one over the mean of the lags. With the sensor's lag
        // t, errors obey `s^3 + (1/t + l) s^2 + m/t s + n/(C t)`. That is (s + w)^3 for the corrections
        // l = 3 w - 1/t of the sensor, m = 3 w^2 t of the block, and n = C w^3 t of the drift.
        let pole = (1 << 49) / (heater_lag + sensor_lag);
        let pole2 = (pole * pole) >> 24;
        let pole3 = (pole2 * pole) >> 24;
        let per_period = |value: i64| I0F32::from_bits(saturated((value << 8) / rate));
        // Correction of the drift in a period, in W/K. Of 16 and 24 fractional bits 20 are left.
        let drift_step = (capacity.saturating_mul((pole3 * sensor_lag) >> 24) / rate) >> 20;
        let most = i64::from(settings.power.to_bits()).max(1 << 16);
        Self {
            warming: I0F32::from_bits(saturated((1 << 48) / (rate * capacity))),
            element: part_per_period(element),
            sensor: part_per_period(sensor),
            loss: I8F24::from_bits(saturated(loss.to_bits().into())),
            fan_loss: I8F24::from_bits(saturated(fan_loss.to_bits().into())),
            heater_lag: I12F20::from_bits(saturated(heater_lag >> 4)),
            grip: I12F20::from_bits(saturated((capacity << 28) / heater_lag)),
            // A sensor quicker than a third of 1/w needs no correction of its own.
            sensor_step: per_period((3 * pole - (1 << 48) / sensor_lag).max(0)),
            block_step: per_period(3 * ((pole2 * sensor_lag) >> 24)),
            drift_step: I12F20::from_bits(saturated(drift_step)),
            gain_step: I2F30::from_bits(saturated((drift_step << 26) / most)),
        }
    }
}

/// A heater's model in parallel with the heater.
#[derive(Clone, Copy, Debug)]
pub struct Observer {
    numbers: Coefficients,
    /// Power that reaches the block.
    arriving: Power,
    block: Celsius,
    sensor: Celsius,
    drift: Power,
    gain: I8F24,
    /// Heat from the block to the room and to the part fan's air, in W/K.
    to_room: I8F24,
    /// Heat from the block to the filament, in W/K.
    to_filament: I8F24,
}

impl Observer {
    /// A heater at `measured`, without power.
    #[must_use]
    pub const fn new(numbers: Coefficients, measured: Celsius) -> Self {
        let (arriving, drift) = (Power::ZERO, Power::ZERO);
        let (gain, to_room, to_filament) = (I8F24::const_from_int(1), numbers.loss, I8F24::ZERO);
        Self { numbers, arriving, block: measured, sensor: measured, drift, gain, to_room, to_filament }
    }

    /// Follows a control period.
    pub fn follow(&mut self, past: &Past) {
        let n = &self.numbers;
        self.to_room = n.loss.saturating_add(times_ratio(n.fan_loss, past.fan));
        self.to_filament = past.filament;
        self.arriving = self.arriving.saturating_add(times(past.power.saturating_sub(self.arriving), n.element));
        // Both changes are from the state before this period; then the reading corrects the new one.
        let net = self.heat().saturating_sub(self.losses(self.block, self.to_filament));
        let sensor_rise = times(self.block.saturating_sub(self.sensor), n.sensor);
        self.block = self.block.saturating_add(rise(net, n.warming));
        self.sensor = self.sensor.saturating_add(sensor_rise);
        let Some(measured) = past.measured else { return };
        let innovation = measured.saturating_sub(self.sensor);
        self.sensor = self.sensor.saturating_add(times(innovation, n.sensor_step));
        self.block = self.block.saturating_add(times(innovation, n.block_step));
        if past.is_free {
            self.drift = self.drift.saturating_add(driven(innovation, n.drift_step));
        } else if past.power > Power::ZERO {
            let step = I8F24::saturating_from_num(kelvin(innovation).wide_mul(n.gain_step));
            self.gain = self.gain.saturating_add(step).clamp(GAIN[0], GAIN[1]);
        }
    }

    /// Corrects the state for a sensor with a longer lag than the model's: `seen` has the lag and the block's slope.
    pub fn take_lag(&mut self, settings: &HeaterSettings, seen: Seen, measured: Celsius) {
        let heater_lag = i64::from(settings.model.heater_lag.to_bits());
        let lag = u32::try_from(seen.lag - heater_lag).unwrap_or(u32::MAX).max(settings.model.sensor_lag.to_bits());
        let model = HeaterModel { sensor_lag: Seconds::from_bits(lag), ..settings.model };
        self.numbers = Coefficients::new(&HeaterSettings { model, ..*settings });
        // At a steady slope a sensor shows what the block was one lag ago.
        let behind = (i64::from(seen.slope.to_bits()) * i64::from(lag)) >> Seconds::FRAC_NBITS;
        self.block = measured.saturating_add(Celsius::from_bits(saturated(behind)));
        self.sensor = measured;
        // W per W: the power that warms the block at this slope, plus its losses.
        let warming = (i64::from(seen.slope.to_bits()) << I0F32::FRAC_NBITS)
            / (i64::from(self.numbers.warming.to_bits()) * i64::from(RATE)).max(1);
        let needed = Power::from_bits(saturated(warming)).saturating_add(self.losses(self.block, self.to_filament));
        let gain = (i64::from(needed.to_bits()) << I8F24::FRAC_NBITS) / i64::from(self.arriving.to_bits()).max(1);
        self.gain = I8F24::from_bits(saturated(gain)).clamp(GAIN[0], GAIN[1]);
    }

    /// Heat that reaches the block.
    fn heat(&self) -> Power {
        times(self.arriving, self.gain).saturating_add(self.drift)
    }

    /// Losses of a block at this temperature, with `filament` in W/K.
    fn losses(&self, block: Celsius, filament: I8F24) -> Power {
        driven(block.saturating_sub(ROOM), self.to_room.saturating_add(filament))
    }

    /// The block's future excess temperature in K, if the heater gives the power for `target` from now on. It is the
    /// present excess, plus the heat on its way, less the additional heat that filament will take. `coming` is the heat
    /// that filament takes within the heater's lag, in J/K.
    #[must_use]
    pub fn excess(&self, target: Celsius, coming: I8F24) -> Celsius {
        let n = &self.numbers;
        let surplus = self.heat().saturating_sub(self.losses(self.block, I8F24::ZERO));
        let promised = driven(target.saturating_sub(ROOM), coming);
        let on_its_way = times(surplus, n.heater_lag).saturating_sub(promised);
        // J times K a period for each W, times periods a second: K.
        let on_its_way = rise(on_its_way, n.warming).saturating_mul_int(RATE);
        self.block.saturating_sub(target).saturating_add(on_its_way)
    }

    /// The heater's power that holds `target`, with `filament` in W/K, plus `extra`.
    #[must_use]
    pub fn power(&self, target: Celsius, filament: I8F24, extra: Power) -> Power {
        let wanted = self.losses(target, filament).saturating_sub(self.drift).saturating_add(extra);
        over(wanted, self.gain)
    }

    /// The heater's numbers.
    #[must_use]
    pub const fn numbers(&self) -> &Coefficients {
        &self.numbers
    }
}

fn times_ratio(value: I8F24, ratio: Ratio) -> I8F24 {
    let product = i64::from(value.to_bits()) * i64::from(ratio.to_bits());
    I8F24::from_bits(saturated(product >> Ratio::FRAC_NBITS))
}
