//! The dither: a little more power for half of each cycle, and as much less for the other half. So a heater's answer
//! can be measured ([`Response`](super::Response)) while it holds a target.
//!
//! ```text
//!   power    ______        ____      + C / 16 s for 8 s, - C / 16 s for 8 s (a bed: C / 160 s for 48 s)
//!                  |______|
//!   reading    /\      /\            0.25 K up and down (a bed: 0.15 K), whatever the heater's capacity C
//!                 \  /     \
//! ```
//!
//! The control is told: it sees the reading without the answer that the model expects, and the power without the
//! dither. So it does not work against the dither, and needs no time to make up for it. What the model expects and
//! the heater does not do is the control's, as ever.
//!
//! A heater near its full power, with hardly any power, or below its target, gets what it wants.

use super::heat_balance::Numbers;
use super::periods;
use crate::thermal::fixed_point::{rise, times};
use crate::units::{Celsius, Power};

/// Below the target by more than this, there is no dither.
const BELOW: Celsius = Celsius::ONE;

/// Above this part of the greatest duty, in percent, there is none either.
const MOST: u32 = 90;

/// The expected answer is forgotten within two cycles. So it swings around 0 wherever it began.
const FORGETS: i32 = 2;

/// The dither of a heater.
#[derive(Clone, Copy, Debug)]
pub struct Dither {
    /// Control periods since the begin of the cycle.
    phase: u16,
    /// Those of them that had a dither.
    dithered: u16,
    /// The power that it gave last.
    given: Power,
    /// The answer that the model expects: power that arrives, block and sensor.
    arriving: Power,
    block: Celsius,
    sensor: Celsius,
}

/// A control period of a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Phase {
    /// The quarter, 0 to 3.
    pub quarter: u8,
    /// It was the last one of the cycle.
    pub is_last: bool,
    /// Most of the cycle had a dither.
    pub is_dithered: bool,
}

impl Default for Dither {
    fn default() -> Self {
        Self::new()
    }
}

impl Dither {
    /// At the begin of a cycle.
    #[must_use]
    pub const fn new() -> Self {
        let (given, arriving) = (Power::ZERO, Power::ZERO);
        Self { phase: 0, dithered: 0, given, arriving, block: Celsius::ZERO, sensor: Celsius::ZERO }
    }

    /// A new hold begins. What is on its way still arrives.
    pub const fn begin(&mut self) {
        (self.phase, self.dithered) = (0, 0);
    }

    /// Control periods of a cycle: 16 s, a bed's 96 s.
    pub(super) const fn cycle(is_quick: bool) -> u16 {
        periods(if is_quick { 16 } else { 96 }) as u16
    }

    /// The power of the last control period, and the answer that the reading has of all of it.
    #[must_use]
    pub const fn told(&self) -> (Power, Celsius) {
        (self.given, self.sensor)
    }

    /// The duty that a wanted duty becomes, for a reading that is so far below the target.
    pub fn apply(&mut self, n: &Numbers, is_quick: bool, wanted: u16, most: u16, below: Celsius) -> u16 {
        let is_near_full = u32::from(wanted) * 100 > u32::from(most) * MOST;
        if below > BELOW || is_near_full || wanted < 2 * n.dither_duty {
            return wanted;
        }
        if self.phase < Self::cycle(is_quick) / 2 {
            self.given = n.dither;
            wanted + n.dither_duty
        } else {
            self.given = Power::ZERO.saturating_sub(n.dither);
            wanted - n.dither_duty
        }
    }

    /// The next control period, which sees what the last duty has done.
    pub fn follow(&mut self, n: &Numbers, is_quick: bool) -> Phase {
        let cycle = Self::cycle(is_quick);
        let quarter = (self.phase / (cycle / 4)) as u8;
        self.dithered += u16::from(self.given != Power::ZERO);
        self.phase += 1;
        let is_last = self.phase >= cycle;
        let is_dithered = self.dithered >= cycle / 4 * 3;
        if is_last {
            (self.phase, self.dithered) = (0, 0);
        }
        self.answer(n, is_quick);
        Phase { quarter, is_last, is_dithered }
    }

    /// The model's answer in a control period.
    fn answer(&mut self, n: &Numbers, is_quick: bool) {
        let given = core::mem::replace(&mut self.given, Power::ZERO);
        self.arriving = self.arriving.saturating_add(times(given.saturating_sub(self.arriving), n.element));
        let forgotten = self.block.to_bits() / (FORGETS * i32::from(Self::cycle(is_quick)));
        let block = self.block.saturating_add(rise(self.arriving, n.warming));
        self.block = block.saturating_sub(Celsius::from_bits(forgotten));
        self.sensor = self.sensor.saturating_add(times(self.block.saturating_sub(self.sensor), n.sensor));
    }
}
