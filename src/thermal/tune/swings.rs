//! Swings: sums over the swings that count.

use super::Swing;

/// Sums over swings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swings {
    /// Finished swings, with those that do not count.
    pub done: u8,
    count: i64,
    periods: i64,
    on: i64,
    amplitude: i64,
    warmth: i64,
}

impl Swings {
    /// Adds a swing that counts, of so many periods.
    pub fn add(&mut self, swing: &Swing, periods: u32) {
        self.count += 1;
        self.periods += i64::from(periods);
        self.on += i64::from(swing.on);
        self.amplitude += i64::from(swing.most.saturating_sub(swing.least).to_bits()) / 2;
        self.warmth += swing.warmth;
    }

    /// The losses: mean power over mean temperature above the room, in W/K with 24 fractional bits. `power` is the
    /// heater's, in W with 20.
    pub fn loss(&self, power: i64) -> Option<i64> {
        let warmth = (self.warmth / self.periods.max(1)).max(1);
        Some(power.checked_mul(self.on)?.checked_div(self.periods)?.checked_mul(1 << 12)? / warmth)
    }

    /// The mean temperature above the room, in K with 8 fractional bits.
    pub fn above_room(&self) -> i64 {
        self.warmth / self.periods.max(1)
    }

    /// The mean amplitude, in bits of a [`crate::units::Celsius`].
    pub fn amplitude(&self) -> i64 {
        (self.amplitude / self.count.max(1)).max(1)
    }

    /// The mean period, in s with 16 fractional bits.
    pub fn period(&self, rate: i64) -> i64 {
        self.periods * 65_536 / self.count.max(1) / rate
    }
}
