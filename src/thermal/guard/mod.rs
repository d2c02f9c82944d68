//! Guards: each detects one way in which a heater can go wrong, and none can be switched off.
//!
//! | guard | finds | when |
//! |---|---|---|
//! | [`Window`] | readings that no working machine has; some only refuse to heat | always |
//! | [`Gain`] | a heater or sensor that is loose or open, whatever the settings | while it heats |
//! | [`HeatBalance`] | the same, sooner, and a heater that is too weak for its model | while it heats |
//! | [`MissingHeat`] | a hotend's heat that no longer shows: its sensor or its cartridge has come loose | it heats hard |
//! | [`AtTarget`] | a reached temperature that is lost, or overshot without power | with a target |
//! | [`WhileOff`] | a switch that does not switch off | without power |
//! | [`Leak`] | a hotend's switch that leaks | without power, and warm |
//! | [`Frozen`] | a reading that does not change | power has changed, or it must go on to rise |
//! | [`Swapped`] | sensors or heaters that are swapped | while one of them heats |
//! | [`FanTurns`] | a driven fan that does not turn | its connector has a tachometer; none yet (`fan_turns`) |
//! | [`Reference`] | a converter with a wrong reference or order of channels | always |
//! | [`LowReading`] | a sensor that reads low, a heater of less power; a bed's is only told | it holds a target |
//! | [`Cold`] | a sensor of another kind than set; only refuses to heat | both are cold |
//!
//! A guard is fed once in a control period and returns a cause and two numbers, or nothing. Guards do not read the
//! controller or its observer: a mistake in them must not hide a fault from a guard.
//!
//! **Two layers.** The [`Floor`] has numbers by the kind of heater alone; no model, setting or command changes them.
//! Above it, thresholds of `settings::Guards` and of the heater's model find more, sooner. Their ranges are safe.
//!
//! **Episodes.** A guard begins, follows and ends. Its observations are in an [`Episode`], which drops them at the end.
//!
//! | guard | begins with | ends with |
//! |---|---|---|
//! | [`Window`] | a reading beyond it | readings within it |
//! | [`Frozen`] | a reading | a reading that moves; a sensor that is broken while off |
//! | [`Gain`] | power | a gain of 2 C; power that is off for four times as long |
//! | [`HeatBalance`] | power | the arrival of all heat; something cold; M303 and self-test, which ignore the model |
//! | [`MissingHeat`] | a reading | never; what a heating has shown counts until another model comes |
//! | [`LowReading`] | a target | another target, off, M303, a self-test, a fault, no reading; its baseline stays |
//! | [`AtTarget`] | a target | another target, off, M303, a self-test, a fault |
//! | [`WhileOff`], [`Leak`] | the arrival of all heat | power |
//! | [`Swapped`] | power from the cold, or alone | less than half of the power |
//! | [`Cold`] | no power for hotend and bed | power of one, or no reading |
//!
//! `Gain` and `HeatBalance` survive a new target: otherwise a target that changes all the time would delay them. Only
//! [`UnderWay`] knows how long heat is under way after the last power, and all guards ask it (`Seen::is_settled`).
//!
//! A new guard needs
//!
//! - a file here and a row in both tables above;
//! - a field of `HeaterGuards` and a line where the others are fed (`thermal/heater_guards.rs`), or in
//!   `thermal/control.rs` if it does not belong to one heater;
//! - its numbers from the settings, if any, in the sum of `HeaterGuards::numbers`;
//! - a [`Cause`] (`fault/cause.rs`);
//! - its measurement, in `port::ThermalPort` (`chips/stm32f446/src/board_heat.rs`, `sim/rig/src/thermal_plant.rs`,
//!   `tests/support/printer.rs` and `tests/support/wild_heat.rs` implement it, `emulator/src/wiring.rs` has the pins);
//! - its threshold, if any, in `settings::Guards`;
//! - a fault of the plant that it finds (`sim/rig/src/plant/faults.rs`, tested in `sim/rig/src/plant/tests/broken.rs`);
//! - a test in `tests/faults`, and a row in both tables of docs/explanation/safety.md.

mod at_target;
mod baseline;
mod cold;
mod dither;
mod episode;
mod fan_turns;
mod floor;
mod frozen;
mod heat_balance;
mod heat_sums;
mod held_power;
mod leak;
mod low_reading;
mod missing_heat;
mod reference;
mod response;
mod swapped;
mod under_way;
mod while_off;
mod window;

pub use at_target::AtTarget;
pub use baseline::{baseline_subject, has_own_model};
pub use cold::Cold;
pub use dither::Dither;
pub use episode::Episode;
pub use fan_turns::{FanTurns, turns_a_minute};
pub use floor::{Floor, Gain};
pub use frozen::Frozen;
pub use heat_balance::{HeatBalance, Numbers};
pub use heat_sums::HeatSums;
pub use leak::Leak;
pub use low_reading::{LowReading, Subject, hidden, is_alike};
pub use missing_heat::MissingHeat;
pub use reference::Reference;
pub use response::Response;
pub use swapped::Swapped;
pub use under_way::UnderWay;
pub use while_off::WhileOff;
pub use window::{LEAST, Window};

use crate::fault::Cause;
use crate::settings::HeaterModel;
use crate::units::{Celsius, periods_in};

/// A heater in a control period, for its guards.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The raw reading.
    pub measured: Celsius,
    /// The reading without its noise.
    pub smooth: Celsius,
    /// Its duty, of 65,535.
    pub duty: u16,
    /// All its heat has arrived: it has been without power for long enough.
    pub is_settled: bool,
    /// Temperature up to which another heater may warm it: a bed warms its chamber, and a hotend that is off.
    pub warmed_to: Celsius,
    /// It gets no power for now, whatever its target: a touch of the probe is awaited.
    pub rests: bool,
}

impl Seen {
    /// A heater without power, with its last heat still under way.
    #[must_use]
    pub const fn quiet(measured: Celsius) -> Self {
        Self { measured, smooth: measured, duty: 0, is_settled: false, warmed_to: Celsius::MIN, rests: false }
    }

    /// Whether it has any power.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.duty > 0
    }
}

/// An alarm of a guard: the cause, the value and its limit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Alarm {
    /// The cause.
    pub cause: Cause,
    /// The measured value.
    pub value: Celsius,
    /// Its limit.
    pub limit: Celsius,
}

/// Control periods in `lags` of a heater's lags: element to block and block to sensor.
const fn periods_of_lags(lags: u32, model: &HeaterModel) -> u32 {
    periods_in(lags, model.lag(), super::fixed_point::RATE.unsigned_abs())
}

/// Control periods in `seconds`.
const fn periods(seconds: u32) -> u32 {
    seconds * super::fixed_point::RATE.unsigned_abs()
}
