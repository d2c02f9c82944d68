//! Tuning (M303): the heater's model and PID gains, from the swings of the temperature around a target.
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
//! | lag | the sensor's rise after the cut (two lags in series cannot be separated: each gets half) |
//! | loss | mean power of whole swings, over the mean temperature above the room |
//! | loss to the part fan | the same with the fan at full speed, less that; only of a hotend, and last |
//! | capacity | heat of the way up less losses, over the rise between two points of the same slope |
//! | loss with a second mass | the last three windows of a minute (`rest`) |
//! | capacity with a second mass | the same, or all heat that was given, less losses, over the rise, if that is more |
//! | PTC | two parts of the way up (`ptc`); only of a hotend, others keep theirs |
//! | PID | relay experiment, below |
//!
//! The relay experiment with hysteresis h is K. Astrom's and T. Hagglund's: Ku = 4 d / (pi sqrt(a^2 - h^2)); P = 0.6
//! Ku, I = 2 P / Tu, D = P Tu / 8.
//!
//! Up to the cut (t = 0) the block rises by a slope r; from then on it falls by s, its losses over its capacity. Behind
//! two lags of a each, the sensor's slope is then -s + (r + s) (1 + x) e^-x with x = t / a. Where this is 0 the sensor
//! peaks; it has risen by a (r + s) k since the cut. k depends only on s / (r + s); [`RISE_AFTER_CUT`] tabulates it.
//!
//! A tuning begins in the cold half of the way from the room to the target; a hotter heater cools first. So there is a
//! way up to measure, and the slope half-way is the one of full power. No step uses the heater's model: cooling, rising
//! and swinging must continue, and the result must be possible for a heater of its kind and power ([`Bounds`]).
//!
//! With the part fan a weak heater may not reach the target. Then the swings without the fan count alone.
//!
//! All guards stay on except those of a lost target and of the model.

mod find;
mod ptc;
mod rest;
mod swings;

use super::fixed_point::RATE;
use super::room::ROOM;
use crate::connectors::Heater;
use crate::settings::{Bounds, HeaterSettings};
use crate::status::{Tuning, TuningFailure};
use crate::units::{Celsius, Power, Ratio};
use ptc::WayUp;
use rest::Rest;
use swings::Swings;

/// Swings that are skipped before those that count; the fan cools the block down first.
const FIRST: u8 = 1;
const FIRST_BLOWN: u8 = 2;

/// Swings with the fan that count.
const BLOWN: u8 = 3;

/// Longest swing, in periods: 20 minutes.
const LONGEST: u32 = 20 * 60 * RATE.unsigned_abs();

/// Distance from the target at which the relay switches: ten times a reading's noise.
const HYSTERESIS: Celsius = Celsius::const_from_int(1);

/// Half-way up, where the measured slope begins, in 256ths of the way.
const HALF_WAY: i64 = 128;

/// Cooling and rising must continue, by a kelvin in so many periods: 5 minutes. A bed of 5500 J/K with 220 W gains one
/// in 4 minutes when a tenth of its power is left.
const STALLED: u32 = 5 * 60 * RATE.unsigned_abs();

/// A bed that does not come to rest is taken as it is after this time: 18 minutes from the first power on.
const LONGEST_REST: u32 = 18 * 60 * RATE.unsigned_abs();

/// Peaks come from a reading that is smoothed over 1/2^4 of its history: 0.3 s.
const SMOOTHING: u32 = 4;

/// Phase of the tuning.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    /// Without power, until it is cold enough to begin.
    Cool,
    /// At full power, up to the target.
    Rise,
    /// Without power, until the sensor has peaked.
    Peak,
    /// Relay.
    Swing,
    /// Relay, with the part fan at full speed.
    Blown,
}

/// A running tuning.
#[derive(Clone, Copy, Debug)]
pub struct Tune {
    target: Celsius,
    cycles: u8,
    /// The part fan cools this heater.
    has_fan: bool,
    /// It has a second mass: the plate on a mat, the walls of a chamber.
    has_plate: bool,
    power: Power,
    /// The growth of its resistance, if it is not to be found, in bits of a [`Ratio`].
    ptc: Option<u32>,
    bounds: &'static Bounds,
    phase: Phase,
    /// The reading without its noise.
    smooth: Celsius,
    /// The farthest temperature of cooling or rising, and periods since then.
    farthest: Celsius,
    stalled: u32,
    is_on: bool,
    /// Periods of this phase or cycle.
    periods: u32,
    /// Temperature and period half-way up, and at the cut.
    half_way: Option<(Celsius, u32)>,
    begun_at: Celsius,
    cut_at: Celsius,
    /// Sum of the temperature above the room from half-way up on, in K periods with 8 fractional bits.
    warmth: i64,
    way_up: WayUp,
    /// Everything since the first power.
    all: Whole,
    rest: Rest,
    /// The current swing, and the swings that count without and with the fan.
    swing: Swing,
    still: Swings,
    blown: Swings,
    rise_periods: u32,
    /// Rise of the sensor after the cut, in bits.
    after_cut: i64,
    result: Option<Tuning>,
}

/// Everything since the first power.
#[derive(Clone, Copy, Debug, Default)]
struct Whole {
    periods: u32,
    /// Periods with power.
    on: u32,
    /// Sum of the temperature above the room, in K periods with 8 fractional bits.
    warmth: i64,
}

/// A swing: from one return of the power to the next.
#[derive(Clone, Copy, Debug)]
struct Swing {
    most: Celsius,
    least: Celsius,
    /// Periods with power.
    on: u32,
    /// Sum of the temperature above the room, in K periods with 8 fractional bits.
    warmth: i64,
}

impl Swing {
    const NEW: Self = Self { most: Celsius::MIN, least: Celsius::MAX, on: 0, warmth: 0 };
}

impl Tune {
    /// A tuning around `target` with so many swings that count, for a heater at `measured`.
    #[must_use]
    pub fn new(
        (heater, settings): (Heater, &HeaterSettings),
        target: Celsius,
        cycles: u8,
        has_fan: bool,
        measured: Celsius,
    ) -> Self {
        let bounds = Bounds::of(heater);
        let power = settings.power.part(settings.max_duty.min(Ratio::ONE));
        let phase = if measured > cold_enough(target) { Phase::Cool } else { Phase::Rise };
        Self {
            target,
            cycles: cycles.clamp(3, 20),
            has_fan,
            has_plate: heater != Heater::Hotend,
            power,
            // Beds rise by too little, and their plates follow too late, to show it.
            ptc: (heater != Heater::Hotend).then_some(settings.model.ptc.to_bits()),
            bounds,
            phase,
            smooth: measured,
            farthest: measured,
            stalled: 0,
            is_on: phase == Phase::Rise,
            periods: 0,
            half_way: None,
            begun_at: measured,
            cut_at: Celsius::ZERO,
            warmth: 0,
            way_up: WayUp::default(),
            all: Whole::default(),
            rest: Rest::default(),
            swing: Swing::NEW,
            still: Swings::default(),
            blown: Swings::default(),
            rise_periods: 0,
            after_cut: 0,
            result: None,
        }
    }

    /// Its progress.
    #[must_use]
    pub fn state(&self) -> Tuning {
        let going_on = match self.phase {
            Phase::Cool => Tuning::Cooling,
            Phase::Rise | Phase::Peak | Phase::Swing | Phase::Blown => {
                // A bed may need more of them than were asked for.
                Tuning::Cycle(self.still.done.min(FIRST + self.cycles) + self.blown.done)
            }
        };
        self.result.unwrap_or(going_on)
    }

    /// Whether the part fan runs at full speed or stops; `None` after the tuning.
    #[must_use]
    pub fn fan(&self) -> Option<bool> {
        (self.has_fan && self.result.is_none()).then_some(matches!(self.phase, Phase::Cool | Phase::Blown))
    }

    /// The duty for the next control period, of 65,535.
    pub fn duty(&mut self, measured: Celsius, most: u16) -> u16 {
        if self.result.is_some() {
            return 0;
        }
        self.periods += 1;
        self.smooth = self.smooth.saturating_add(measured.saturating_sub(self.smooth) >> SMOOTHING);
        if self.phase != Phase::Cool {
            self.all.periods += 1;
            self.all.on += u32::from(self.is_on);
            self.all.warmth += above_room(measured);
        }
        match self.phase {
            Phase::Cool => self.cool(measured),
            Phase::Rise => self.rise(measured),
            Phase::Peak => self.peak(),
            Phase::Swing | Phase::Blown => self.swing(measured),
        }
        if self.is_on && self.result.is_none() { most } else { 0 }
    }

    fn cool(&mut self, measured: Celsius) {
        self.go_on(self.farthest.saturating_sub(self.smooth), TuningFailure::StaysHot);
        if self.smooth <= cold_enough(self.target) {
            (self.phase, self.is_on, self.periods) = (Phase::Rise, true, 0);
            (self.begun_at, self.farthest, self.stalled) = (measured, measured, 0);
        }
    }

    /// Notes another kelvin of progress; fails if that takes too long.
    fn go_on(&mut self, farther: Celsius, failure: TuningFailure) {
        self.stalled += 1;
        if farther >= Celsius::ONE {
            (self.farthest, self.stalled) = (self.smooth, 0);
        } else if self.stalled > STALLED {
            self.fail(failure);
        }
    }

    const fn fail(&mut self, failure: TuningFailure) {
        self.result = Some(Tuning::Failed(failure));
    }

    fn rise(&mut self, measured: Celsius) {
        self.go_on(self.smooth.saturating_sub(self.farthest), TuningFailure::OutOfReach);
        let way = i64::from(self.target.saturating_sub(self.begun_at).to_bits());
        let gone = i64::from(measured.saturating_sub(self.begun_at).to_bits());
        self.way_up.follow(measured, gone, way);
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
        // The smooth reading lags behind a rise. The rise after the cut is counted from the reading itself.
        (self.cut_at, self.smooth) = (measured, measured);
        (self.phase, self.is_on, self.periods, self.swing.most) = (Phase::Peak, false, 0, measured);
    }

    fn peak(&mut self) {
        self.swing.most = self.swing.most.max(self.smooth);
        if self.swing.most.saturating_sub(self.smooth) < const { Celsius::lit("0.5") } {
            if self.periods > LONGEST {
                self.fail(TuningFailure::NoSwing);
            }
            return;
        }
        self.after_cut = i64::from(self.swing.most.saturating_sub(self.cut_at).to_bits());
        (self.phase, self.periods, self.swing) = (Phase::Swing, 0, Swing::NEW);
    }

    fn swing(&mut self, measured: Celsius) {
        let swing = &mut self.swing;
        (swing.least, swing.most) = (swing.least.min(self.smooth), swing.most.max(self.smooth));
        swing.on += u32::from(self.is_on);
        swing.warmth += above_room(measured);
        if self.is_on && measured > self.target.saturating_add(HYSTERESIS) {
            self.is_on = false;
        } else if !self.is_on && measured < self.target.saturating_sub(HYSTERESIS) {
            // A swing ends where the power comes back.
            self.is_on = true;
            (self.farthest, self.stalled) = (self.smooth, 0);
            self.end_swing();
        } else if self.phase == Phase::Blown && self.is_on && self.is_out_of_reach() {
            self.has_fan = false;
            self.result = Some(self.find().map_or_else(Tuning::Failed, |_| Tuning::DoneWithoutFan));
        } else if self.periods > LONGEST {
            self.fail(TuningFailure::NoSwing);
        }
    }

    /// Whether full power has brought no further kelvin for too long.
    fn is_out_of_reach(&mut self) -> bool {
        self.stalled += 1;
        if self.smooth.saturating_sub(self.farthest) >= Celsius::ONE {
            (self.farthest, self.stalled) = (self.smooth, 0);
        }
        self.stalled > STALLED
    }

    fn end_swing(&mut self) {
        let is_blown = self.phase == Phase::Blown;
        let (swings, first, wanted) =
            if is_blown { (&mut self.blown, FIRST_BLOWN, BLOWN) } else { (&mut self.still, FIRST, self.cycles) };
        swings.done = swings.done.saturating_add(1);
        if swings.done > first {
            swings.add(&self.swing, self.periods);
        }
        let is_done = swings.done >= first + wanted;
        self.rest.add(&self.swing, self.periods);
        (self.periods, self.swing) = (0, Swing::NEW);
        let follows = self.has_plate && !self.rest.is_reached() && self.all.periods < LONGEST_REST;
        if !is_done || follows {
            return;
        }
        if self.has_fan && !is_blown {
            self.phase = Phase::Blown;
        } else {
            self.result = Some(self.find().map_or_else(Tuning::Failed, |_| Tuning::Done));
        }
    }
}

/// The hottest temperature at which a tuning around `target` may begin: half-way from the room.
fn cold_enough(target: Celsius) -> Celsius {
    ROOM.saturating_add(target.saturating_sub(ROOM) / 2)
}

/// K above the room, with 8 fractional bits.
fn above_room(measured: Celsius) -> i64 {
    i64::from(measured.saturating_sub(ROOM).to_bits()) >> 12
}
