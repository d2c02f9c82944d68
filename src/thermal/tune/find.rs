//! Results of a tuning from its observations.

use super::ptc::power_left;
use super::swings::Swings;
use super::{HYSTERESIS, Tune, above_room};
use crate::status::{Tuned, TuningFailure};
use crate::thermal::fixed_point::RATE;
use crate::units::{JoulesPerKelvin, Seconds, Watts, whole_root};

/// The k for s / (r + s) of 0/16 to 16/16, times 4096: -x s/(r+s) + 2 - (2 + x) e^-x, where (1 + x) e^-x is s/(r+s).
const RISE_AFTER_CUT: [i64; 17] =
    [8192, 6744, 5722, 4870, 4133, 3485, 2910, 2398, 1942, 1537, 1180, 868, 601, 376, 197, 66, 0];

impl Tune {
    /// The results.
    ///
    /// # Errors
    /// No heater of this kind and power can have them.
    pub fn find(&self) -> Result<Tuned, TuningFailure> {
        let found = self.figures().ok_or(TuningFailure::Impossible)?;
        let power = Watts::from_bits(self.power.to_bits().cast_unsigned() >> 4);
        let is_within = self.bounds.capacity(power).holds(JoulesPerKelvin::from_bits(found.capacity))
            && self.bounds.lag.holds(Seconds::from_bits(found.lag));
        if is_within { Ok(found) } else { Err(TuningFailure::Impossible) }
    }

    /// The figures, unchecked.
    fn figures(&self) -> Option<Tuned> {
        let nominal = i64::from(self.power.to_bits());
        let ptc = match self.ptc {
            Some(known) => known.into(),
            None => self.way_up.ptc(nominal, &self.still)?,
        };
        // The power at so many K above the room.
        let power_at = |above| (nominal * power_left(ptc, above)) >> 16;
        let of_swings = self.still.loss(power_at(self.still.above_room()))?;
        let of_rest = || self.rest.loss(power_at(self.still.above_room())).unwrap_or(of_swings);
        let loss = if self.has_plate { of_rest() } else { of_swings };
        // The noise of both means may make a weak fan seem to warm the block.
        let blown = |swings: &Swings| Some((swings.loss(power_at(swings.above_room()))? - loss).max(0));
        let fan_loss = if self.has_fan { blown(&self.blown)? } else { 0 };
        let (from, _) = self.half_way?;
        let rise = i64::from(self.cut_at.saturating_sub(from).to_bits()).max(1);
        // J with 20 fractional bits: given, and lost on the way.
        let rate = i64::from(RATE);
        let periods = i64::from(self.rise_periods);
        let given = power_at(self.warmth / periods.max(1)) * periods / rate;
        // 24 and 8 fractional bits, less 12, are 20.
        let lost = (loss * (self.warmth / rate)) >> 12;
        // 20 fractional bits and 16 over 20: those of a capacity.
        let of_way_up = (given.saturating_sub(lost) << 16) / rise;
        let capacity = if self.has_plate { of_way_up.max(self.of_all(loss, power_at)) } else { of_way_up };
        // Slopes after and before the cut, in K/s with 20 fractional bits: losses, and power less losses, over the
        // capacity.
        let losses = (loss * above_room(self.cut_at)) >> 12;
        let power = power_at(above_room(self.cut_at));
        let [fall, rise] = [losses, power - losses].map(|watts| (watts.max(0) << 16) / capacity.max(1));
        let both = (fall + rise).max(1);
        // 56 fractional bits over 20 and 12 are 24. Twice, because there are two lags of a.
        let lag = (self.after_cut << 36) / (both * rise_after_cut((fall << 16) / both)).max(1) * 2;
        // A sensor in a mat has hardly any.
        let lag = if self.has_plate { lag.max(self.bounds.lag.least.to_bits().into()) } else { lag };
        // PID in duty of 255: d = 127.5, so Ku = 4 * 127.5 / (pi a) = 162.34 / a.
        let amplitude = self.still.amplitude();
        let hysteresis = i64::from(HYSTERESIS.to_bits());
        // At least a quarter of the hysteresis: an amplitude that is hardly greater would make an endless gain.
        let beyond = (amplitude * amplitude - hysteresis * hysteresis).max(hysteresis * hysteresis / 16);
        let ku = ((162.34 * 65_536.0) as i64) * (1 << 20) / (whole_root(beyond.cast_unsigned()) as i64).max(1);
        // All three with 16 fractional bits: I = 2 P / Tu, and D = P Tu / 8 (see the head of `tune`).
        let period = self.still.period(rate);
        let p = ku * 3 / 5;
        let i = (p << 17) / period.max(1);
        let d = (p * period) >> 19;
        let bits = |value: i64| u32::try_from(value).ok().filter(|bits| *bits > 0);
        Some(Tuned {
            capacity: bits(capacity)?,
            loss: bits(loss)?,
            fan_loss: u32::try_from(fan_loss).ok()?,
            lag: bits(lag)?,
            p: bits(p)?,
            i: bits(i)?,
            d: bits(d)?,
            ptc: u32::try_from(ptc).ok()?,
        })
    }
}

impl Tune {
    /// The heat capacity by all heat since the begin, in J/K with 16 fractional bits: both ends are at rest. It is less
    /// than the true one by what a plate is colder than its mat at the end.
    fn of_all(&self, loss: i64, power_at: impl Fn(i64) -> i64) -> i64 {
        let rate = i64::from(RATE);
        let given = power_at(self.all.warmth / i64::from(self.all.periods).max(1)) * i64::from(self.all.on) / rate;
        let lost = (loss * (self.all.warmth / rate)) >> 12;
        let rise = (self.still.above_room() - above_room(self.begun_at)) << 12;
        (given.saturating_sub(lost) << 16) / rise.max(1 << 20)
    }
}

/// k of the head for a part with 16 fractional bits; with 12.
fn rise_after_cut(part: i64) -> i64 {
    let place = part.clamp(0, 65_535);
    let [below, above] = [0, 1].map(|more| RISE_AFTER_CUT.get((place >> 12) as usize + more).copied().unwrap_or(0));
    below + (((above - below) * (place & 4095)) >> 12)
}
