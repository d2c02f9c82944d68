//! The floor: the behaviour of every heater of a kind, whatever its model, its settings and the commands.
//!
//! The model's guards find a fault sooner, but a wrong model makes them blind: with `power = 1` or `M306 C200` a heater
//! without power looks right. So this guard is below them, and its numbers depend only on the kind of heater.
//!
//! A heater that can reach a target has spare power on the way. At a fraction p of the way from the room to the highest
//! temperature that its power allows, 1 - p of its power still warms it. A reachable target is no higher than that
//! temperature. So on the first 60 % of the way to it, at least 40 % of the power is left:
//!
//! | | power / capacity | 2 C at 60 % of the way | allowed |
//! |---|---|---|---|
//! | hotend of 25 W and 34 J/K, at 19 V | 0.46 K/s | 11 s | 20 s |
//! | bed of 220 W and 5500 J/K, at 21 V | 0.031 K/s | 163 s | 240 s |
//! | chamber of 300 W and 20,000 J/K | 0.015 K/s | 333 s | 600 s |
//!
//! Above that, a correct reading comes from a hot heater: there is only a limit of time. A hotend of 25 W and 34 J/K
//! that can reach 270 C needs more than 10 minutes for its last 2 C before 267 (`tests/faults/floor.rs`); it gets 30.
//!
//! On the first 60 % of the way a reading must not fall by 10 C either while there is more than half of the power. A
//! hotend that cools at 3 K/s when the power comes falls by 7 C in its lag. A sensor that slips falls as far in a
//! second. A cold plate on a bed takes heat out of it too. A plate of 0 C with half of the bed's heat capacity takes a
//! third of its temperature, and full power needs minutes for that. So a bed may fall by 35 % of what it read. A sensor
//! that slips into a room of 25 C falls by more from 39 C on.
//!
//! A command that waits for a heater ends its job before the guard halts the machine. From five sixths of the power on
//! the heater counts as slow, and only the last sixth, which begins then, ends in the alarm. So the words for a target
//! that is too far always come first, wherever the reading and the target have been before. There is one exception: a
//! hotend low on its way, and a bed or chamber that was never warm, may have no power or a sensor that has slipped.
//!
//! Time counts by the duty, and is forgotten four times as slowly without power. So neither a heater that is switched
//! off and on nor a target that changes all the time delays the alarm.

use super::{Alarm, periods};
use crate::connectors::Heater;
use crate::fault::Cause;
use crate::thermal::room::ROOM;
use crate::units::Celsius;

/// A rise that counts as a gain. Klipper's `heating_gain` (verify_heater) is 2 C too.
const GAIN: Celsius = Celsius::const_from_int(2);

/// On the rest of the way only full power counts, and only this far below the target. A controller without an integral
/// part stays below for ever, with less than full power.
const NEAR: Celsius = Celsius::const_from_int(2);

/// A fall of the reading that counts.
const FALL: Celsius = Celsius::const_from_int(10);

/// The part of its reading, in percent, that a cold plate may take from a bed: see above.
const COLD_PLATE: i32 = 35;

/// Full power in units of `given`.
const FULL: u32 = 255;

/// This part of the allowed power is left when a heater counts as slow.
const REST: u32 = 6;

/// A bed or a chamber that reads so much more than the room was warmed by its heater.
const WARM: Celsius = ROOM.saturating_add(Celsius::const_from_int(20));

/// Counted time is forgotten at this fraction of the time without power.
const FORGETS: u32 = 4;

/// Numbers of a kind of heater, whatever its settings.
#[derive(Debug)]
pub struct Floor {
    /// Periods at full power for each gain, on the first 60 % of the way.
    heating: u32,
    /// The same on the rest of the way.
    topping: u32,
    /// Periods for which it may read 10 C less than before at more than half of the power, on the first 60 % of the
    /// way.
    falling: u32,
    /// Whether cold plates are laid on it.
    takes_plates: bool,
    /// Periods for which a reading may stay constant after the power has changed, or while it must rise.
    pub still: u32,
    /// Periods between two marks of a reading (`frozen`).
    pub mark: u32,
    /// A rise from the oldest mark that cannot end at once: a heater follows its power no faster than its time
    /// constant.
    pub rises: Celsius,
    /// Whether a reading at the target may stay constant at any power. A unit of the converter is 0.02 C and more at a
    /// hotend's temperatures, so a hotend's valid reading moves; it is less at those of beds and chambers.
    pub holds_still: bool,
    /// Range of the number of periods within which heat under way arrives.
    pub settling: [u32; 2],
    /// Greatest permitted distance above a reached target.
    pub overshoot: Celsius,
    /// Whether its heat shows within seconds: only a hotend's does.
    pub is_quick: bool,
    /// Whether its power has a dither: a chamber's door changes more than that would.
    pub has_dither: bool,
}

impl Floor {
    /// The numbers of this heater.
    #[must_use]
    pub const fn of(heater: Heater) -> &'static Self {
        /// Klipper's `check_gain_time` of a hotend is 20 s. The lags of a hotend are 1 to 6 s together.
        const HOTEND: Floor = Floor {
            heating: periods(20),
            topping: periods(1800),
            falling: periods(2),
            takes_plates: false,
            still: periods(30),
            mark: periods(3),
            rises: Celsius::const_from_int(2),
            holds_still: false,
            settling: [periods(1), periods(30)],
            overshoot: Celsius::const_from_int(15),
            is_quick: true,
            has_dither: true,
        };
        /// A mat under a thick plate lags by 10 to 60 s.
        const BED: Floor = Floor {
            heating: periods(240),
            topping: periods(3600),
            falling: periods(20),
            takes_plates: true,
            still: periods(60),
            mark: periods(15),
            rises: Celsius::lit("0.65"),
            holds_still: true,
            settling: [periods(10), periods(300)],
            overshoot: Celsius::const_from_int(15),
            is_quick: false,
            has_dither: true,
        };
        /// Air, and walls that warm behind it.
        const CHAMBER: Floor = Floor {
            heating: periods(600),
            topping: periods(7200),
            // Its door may be opened.
            falling: periods(600),
            takes_plates: false,
            still: periods(120),
            mark: periods(30),
            rises: Celsius::ONE,
            holds_still: true,
            settling: [periods(20), periods(600)],
            overshoot: Celsius::const_from_int(15),
            is_quick: false,
            has_dither: false,
        };
        match heater {
            Heater::Hotend => &HOTEND,
            Heater::Bed => &BED,
            Heater::Chamber => &CHAMBER,
        }
    }
}

/// Whether a reading is on the first 60 % of the way from the room to the target. A pulse of a self-test has none.
pub fn is_low(measured: Celsius, target: Option<Celsius>) -> bool {
    let way = target.unwrap_or(Celsius::MAX).saturating_sub(ROOM) / 5;
    // Sixty parts of a hundred are three fifths.
    measured < ROOM.saturating_add(way.saturating_mul_int(3))
}

/// The guard: power without a gain.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// The coldest since the last gain.
    from: Celsius,
    /// Power since then, in periods of full power times 255: two hours of them are 92 million.
    given: u32,
    /// The parts of it since the heater counts as slow: on the rest of the way, and low on it.
    late: [u32; 2],
    /// Whether a command that waits for the heater waits in vain.
    is_slow: bool,
    /// The warmest reading since there is more than half of the power, and the periods with a reading far below it.
    warmest: Celsius,
    fallen: u32,
}

impl Default for Gain {
    fn default() -> Self {
        Self::new()
    }
}

impl Gain {
    /// No power was given yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { from: Celsius::MAX, given: 0, late: [0; 2], is_slow: false, warmest: Celsius::MIN, fallen: 0 }
    }

    /// Whether a command that waits for the heater waits in vain.
    #[must_use]
    pub const fn is_slow(&self) -> bool {
        self.is_slow
    }

    /// Follows a control period of a heater with this duty of 65,535, and its greatest permitted duty. A pulse of a
    /// self-test has no target.
    pub fn look(
        &mut self,
        floor: &Floor,
        target: Option<Celsius>,
        measured: Celsius,
        (duty, most): (u16, u16),
    ) -> Option<Alarm> {
        self.from = self.from.min(measured);
        if measured.saturating_sub(self.from) >= GAIN {
            (self.from, self.given, self.late) = (measured, 0, [0; 2]);
        }
        self.is_slow = false;
        let is_full = duty >= most;
        // With less power it may cool by itself, so a fall counts from a later reading.
        self.warmest = if duty > most / 2 { self.warmest.max(measured) } else { Celsius::MIN };
        // Time is not forgotten at once: otherwise a heater that is switched off and on would never come to its alarm.
        if duty == 0 {
            self.fallen = 0;
            self.given = self.given.saturating_sub(FULL / FORGETS);
            return None;
        }
        let (goal, is_low) = (target.unwrap_or(Celsius::MAX), is_low(measured, target));
        let counts = is_low || is_full && goal.saturating_sub(measured) >= NEAR;
        if !counts {
            return None;
        }
        // Of 255, so that two hours at full power fit into `given`.
        let power = u32::from(duty >> 8);
        self.given += power;
        // Divided first: a Celsius ends at 2048, and 35 times a hot bed's would not.
        let part = self.warmest.max(Celsius::ZERO) / 100;
        let by_plate = if floor.takes_plates { part.saturating_mul_int(COLD_PLATE) } else { Celsius::ZERO };
        let fall = FALL.max(by_plate);
        let has_fallen = is_low && self.warmest.saturating_sub(measured) > fall;
        self.fallen = if has_fallen { self.fallen + 1 } else { 0 };
        if self.fallen >= floor.falling {
            let (value, limit) = (measured, self.warmest.saturating_sub(fall));
            return Some(Alarm { cause: Cause::TemperatureLost, value, limit });
        }
        let most = if is_low { floor.heating } else { floor.topping } * FULL;
        let rest = most / REST;
        // Counted for each kind of way by itself, so that a heater was slow for a sixth of this kind's time before the
        // alarm.
        let is_late = self.given > most - rest;
        let late = &mut self.late[usize::from(is_low)];
        *late = if is_late { *late + power } else { 0 };
        let is_over = *late >= rest;
        self.is_slow = is_late && (!is_low || floor.holds_still && measured >= WARM);
        let value = measured.saturating_sub(self.from);
        is_over.then_some(Alarm { cause: Cause::HeatsTooSlowly, value, limit: GAIN })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Full power at readings and targets that come and go: a heater is slow for a sixth of the time before the alarm.
    #[test]
    fn a_heater_that_was_warm_is_slow_long_before_the_alarm() {
        let floor = Floor::of(Heater::Bed);
        let mut seed = 7_u32;
        let mut random = |below: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % below
        };
        for _ in 0..20 {
            let (mut gain, mut slow, mut low) = (Gain::new(), 0, false);
            let (mut at, mut target) = (Celsius::from_num(70 + random(8)), Celsius::from_num(90));
            let alarm = (0..floor.topping * 20).find_map(|period| {
                if period % 500 == 0 && random(40) == 0 {
                    target = Celsius::from_num([88, 100, 112, 120][random(4) as usize]);
                }
                at = at.saturating_add(Celsius::from_bits(random(3) as i32 - 1));
                // Each kind of way has a time of its own.
                if is_low(at, Some(target)) != low {
                    (low, slow) = (!low, 0);
                }
                slow += u32::from(gain.is_slow());
                gain.look(floor, Some(target), at, (u16::MAX, u16::MAX))
            });
            assert_eq!(alarm.map(|alarm| alarm.cause), Some(Cause::HeatsTooSlowly));
            assert!(slow >= floor.heating / REST - 1, "slow for {slow} periods before the alarm");
        }
    }

    /// Of these, the alarm comes first: they may have no power.
    #[test]
    fn a_hotend_low_on_its_way_and_a_bed_that_was_never_warm_are_not_slow() {
        for (heater, at) in [(Heater::Hotend, 100), (Heater::Bed, 44)] {
            let (floor, mut gain) = (Floor::of(heater), Gain::new());
            let target = Some(Celsius::from_num(220));
            let alarm = (0..=floor.heating).find_map(|period| {
                assert!(!gain.is_slow(), "{heater:?}");
                Some((period, gain.look(floor, target, Celsius::from_num(at), (u16::MAX, u16::MAX))?))
            });
            assert!(alarm.is_some_and(|(period, _)| period.abs_diff(floor.heating) <= 1), "{alarm:?}");
        }
    }
}
