//! Tuning (M303): what the heater's model and a PID for it are, from how the temperature swings around a target.
//!
//! ```text
//!  temperature      cut ___ peak                 relay: full power below the target, none above
//!                    /      \__/\__/\__/\__
//!                   /  slope r            \ Tu, amplitude a, mean power
//!   start _________/
//! ```
//!
//! | found | from |
//! |---|---|
//! | lag | how far the sensor goes on rising after the cut (two lags in series are told apart by nobody: each gets half) |
//! | loss | mean power of whole swings, over the mean temperature above the room |
//! | capacity | heat that went in on the way up less losses, over the rise between two points of the same slope |
//! | PID | K. Astrom and T. Hagglund's relay experiment with hysteresis h: Ku = 4 d / (pi sqrt(a^2 - h^2)); P = 0.6 Ku, I = 2 P / Tu, D = P Tu / 8 |
//!
//! Up to the cut (t = 0) the block rises by a slope r; from then on it falls by s, its losses over its capacity. Behind two lags of
//! a each, the sensor's slope is then -s + (r + s) (1 + x) e^-x with x = t / a. Where this is 0 the sensor peaks; it has risen by
//! a (r + s) k since the cut. k depends only on s / (r + s); [`RISE_AFTER_CUT`] tabulates it.
//!
//! All guards but the one for a lost target stay on.

use super::fixed_point::{Power, RATE, saturated};
use super::room::ROOM;
use crate::settings::HeaterSettings;
use crate::status::{Tuned, Tuning};
use crate::units::Celsius;

/// Cycles that are thrown away before those that count.
const FIRST: u8 = 1;

/// Nothing swings more slowly than this, in periods: 20 minutes.
const LONGEST: u32 = 20 * 60 * RATE.unsigned_abs();

/// The relay switches so far from the target: ten times a reading's noise.
const HYSTERESIS: Celsius = Celsius::const_from_int(1);

/// k for s / (r + s) of 0/16 to 16/16, times 4096: -x s/(r+s) + 2 - (2 + x) e^-x, where (1 + x) e^-x is s/(r+s).
const RISE_AFTER_CUT: [i64; 17] =
    [8192, 6744, 5722, 4870, 4133, 3485, 2910, 2398, 1942, 1537, 1180, 868, 601, 376, 197, 66, 0];

/// Half-way up, from where the slope counts: the parts of the way that are done, in 256ths.
const HALF_WAY: i64 = 128;

/// Where the tuning stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    /// At full power, up to the target.
    Rise,
    /// Without power, until the sensor has peaked.
    Peak,
    /// Relay.
    Swing,
}

/// A tuning that goes on.
#[derive(Clone, Copy, Debug)]
pub struct Tune {
    target: Celsius,
    cycles: u8,
    power: Power,
    phase: Phase,
    is_on: bool,
    /// Periods of this phase or cycle.
    periods: u32,
    /// Temperature and period at the half of the way, and at the cut.
    half_way: Option<(Celsius, u32)>,
    begun_at: Celsius,
    cut_at: Celsius,
    /// Sum of the temperature above the room from the half of the way on, in K periods with 8 fractional bits.
    warmth: i64,
    /// Extremes of this swing.
    most: Celsius,
    least: Celsius,
    done: u8,
    /// Over the swings that count: periods, periods with power, amplitude in bits, temperature above the room in K with 8 bits.
    sum_periods: i64,
    sum_on: i64,
    sum_amplitude: i64,
    sum_warmth: i64,
    on: u32,
    swing_warmth: i64,
    rise_periods: u32,
    /// By how much the sensor rose after the cut, in bits.
    after_cut: i64,
    result: Option<Tuning>,
}

impl Tune {
    /// A tuning around `target` with so many swings that count, of a heater that is at `measured`.
    #[must_use]
    pub fn new(settings: &HeaterSettings, target: Celsius, cycles: u8, measured: Celsius) -> Self {
        let power = Power::from_bits(saturated(i64::from(settings.power.to_bits()) << 4));
        Self {
            target,
            cycles: cycles.clamp(3, 20),
            power,
            phase: Phase::Rise,
            is_on: true,
            periods: 0,
            half_way: None,
            begun_at: measured,
            cut_at: Celsius::ZERO,
            warmth: 0,
            most: Celsius::MIN,
            least: Celsius::MAX,
            done: 0,
            sum_periods: 0,
            sum_on: 0,
            sum_amplitude: 0,
            sum_warmth: 0,
            on: 0,
            swing_warmth: 0,
            rise_periods: 0,
            after_cut: 0,
            result: None,
        }
    }

    /// How far it has come.
    #[must_use]
    pub fn state(&self) -> Tuning {
        self.result.unwrap_or(Tuning::Cycle(self.done))
    }

    /// The duty for the next control period, of 65,535.
    pub fn duty(&mut self, measured: Celsius, most: u16) -> u16 {
        if self.result.is_some() {
            return 0;
        }
        self.periods += 1;
        if self.periods > LONGEST {
            self.result = Some(Tuning::Failed);
            return 0;
        }
        match self.phase {
            Phase::Rise => self.rise(measured),
            Phase::Peak => self.peak(measured),
            Phase::Swing => self.swing(measured),
        }
        if self.is_on && self.result.is_none() { most } else { 0 }
    }

    fn rise(&mut self, measured: Celsius) {
        let way = i64::from(self.target.saturating_sub(self.begun_at).to_bits());
        let gone = i64::from(measured.saturating_sub(self.begun_at).to_bits());
        if self.half_way.is_none() && gone * 256 >= way * HALF_WAY {
            self.half_way = Some((measured, self.periods));
        }
        if self.half_way.is_some() {
            self.warmth += above_room(measured);
        }
        if measured < self.target {
            return;
        }
        let Some((_, since)) = self.half_way else { return };
        self.rise_periods = self.periods - since;
        self.cut_at = measured;
        if self.rise_periods == 0 {
            // It was there already: cool down and begin from the first swing without model.
            self.result = Some(Tuning::Failed);
            return;
        }
        (self.phase, self.is_on, self.periods, self.most) = (Phase::Peak, false, 0, measured);
    }

    fn peak(&mut self, measured: Celsius) {
        self.most = self.most.max(measured);
        if self.most.saturating_sub(measured) < Celsius::lit("0.5") {
            return;
        }
        self.after_cut = i64::from(self.most.saturating_sub(self.cut_at).to_bits());
        (self.phase, self.periods) = (Phase::Swing, 0);
        (self.least, self.most) = (measured, measured);
    }

    fn swing(&mut self, measured: Celsius) {
        (self.least, self.most) = (self.least.min(measured), self.most.max(measured));
        self.on += u32::from(self.is_on);
        self.swing_warmth += above_room(measured);
        if self.is_on && measured > self.target.saturating_add(HYSTERESIS) {
            self.is_on = false;
        } else if !self.is_on && measured < self.target.saturating_sub(HYSTERESIS) {
            // A swing ends where the power comes back.
            self.is_on = true;
            self.end_swing();
        }
    }

    fn end_swing(&mut self) {
        if self.done >= FIRST {
            self.sum_periods += i64::from(self.periods);
            self.sum_on += i64::from(self.on);
            self.sum_amplitude += i64::from(self.most.saturating_sub(self.least).to_bits()) / 2;
            self.sum_warmth += self.swing_warmth;
        }
        self.done += 1;
        (self.periods, self.on, self.swing_warmth) = (0, 0, 0);
        (self.least, self.most) = (Celsius::MAX, Celsius::MIN);
        if self.done == FIRST + self.cycles {
            self.result = Some(if self.find().is_some() { Tuning::Done } else { Tuning::Failed });
        }
    }

    /// What was found.
    #[must_use]
    pub fn find(&self) -> Option<Tuned> {
        let swings = i64::from(self.cycles);
        let power = i64::from(self.power.to_bits());
        let warmth = (self.sum_warmth / self.sum_periods.max(1)).max(1);
        // W/K with 24 fractional bits, from W with 20 and K with 8.
        let loss = power.checked_mul(self.sum_on)?.checked_div(self.sum_periods)?.checked_mul(1 << 12)? / warmth;
        let (from, _) = self.half_way?;
        let rise = i64::from(self.cut_at.saturating_sub(from).to_bits()).max(1);
        // J with 20 fractional bits: given, and lost on the way.
        let rate = i64::from(RATE);
        let given = power * i64::from(self.rise_periods) / rate;
        let lost = (loss * (self.warmth / rate)) >> 12;
        let capacity = (given.saturating_sub(lost) << 16) / rise;
        // Slopes after and before the cut, in K/s with 20 fractional bits: losses, and power less losses, over the capacity.
        let losses = (loss * above_room(self.cut_at)) >> 12;
        let [fall, rise] = [losses, power - losses].map(|watts| (watts.max(0) << 16) / capacity.max(1));
        let both = (fall + rise).max(1);
        let lag = (self.after_cut << 36) / (both * rise_after_cut((fall << 16) / both)).max(1) * 2;
        // PID in duty of 255: d = 127.5, so Ku = 4 * 127.5 / (pi a) = 162.34 / a.
        let amplitude = (self.sum_amplitude / swings).max(1);
        let hysteresis = i64::from(HYSTERESIS.to_bits());
        let beyond = (amplitude * amplitude - hysteresis * hysteresis).max(hysteresis * hysteresis / 16);
        let ku = ((162.34 * 65_536.0) as i64) * (1 << 20) / (beyond.cast_unsigned().isqrt() as i64).max(1);
        let period = self.sum_periods * 65_536 / swings / rate;
        let p = ku * 3 / 5;
        let i = (p << 17) / period.max(1);
        let d = (p * period) >> 19;
        let bits = |value: i64| u32::try_from(value).ok().filter(|bits| *bits > 0);
        Some(Tuned {
            capacity: bits(capacity)?,
            loss: bits(loss)?,
            fan_loss: 0,
            lag: bits(lag)?,
            p: bits(p)?,
            i: bits(i)?,
            d: bits(d)?,
        })
    }
}

/// k of the head for a part with 16 fractional bits; with 12.
fn rise_after_cut(part: i64) -> i64 {
    let place = part.clamp(0, 65_535);
    let [below, above] = [0, 1].map(|more| RISE_AFTER_CUT.get((place >> 12) as usize + more).copied().unwrap_or(0));
    below + (((above - below) * (place & 4095)) >> 12)
}

/// K above the room, with 8 fractional bits.
fn above_room(measured: Celsius) -> i64 {
    i64::from(measured.saturating_sub(ROOM).to_bits()) >> 12
}
