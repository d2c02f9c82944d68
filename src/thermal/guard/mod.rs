//! Guards: each looks for one way in which a heater can go wrong, and none can be switched off.
//!
//! | guard | finds | when |
//! |---|---|---|
//! | [`Window`] | readings that no working machine has | always |
//! | [`Gain`] | a heater or sensor that is loose or open, whatever the settings say | while it heats |
//! | [`HeatBalance`] | the same, sooner, and a heater that is too weak for its model | while it heats |
//! | [`AtTarget`] | a temperature that was reached and is lost, or overshot without power | with a target |
//! | [`WhileOff`] | a switch that does not switch off | without power |
//! | [`Frozen`] | a reading that stands still | power has changed |
//! | [`Swapped`] | sensors or heaters that are swapped | while one of them heats |
//! | [`FanTurns`] | a fan that is driven and stands still | its connector has a tachometer, which no board has yet (see `fan_turns`) |
//! | [`Reference`] | a converter whose reference, or whose order of channels, is wrong | always |
//!
//! A guard is fed once in a control period and answers with a cause and two numbers, or with nothing. Guards do not look at
//! the controller or its observer: a mistake in them must not hide a fault from a guard.
//!
//! **Two layers.** The [`Floor`] has numbers by the kind of heater alone; no model, setting or command touches them. Above
//! it, thresholds of `settings::Guards` and of the heater's model find more, sooner. Their ranges keep them guards.
//!
//! **Episodes.** A guard begins, follows and ends. What it has seen is in an [`Episode`], which forgets it at the end by itself.
//!
//! | guard | begins with | ends with |
//! |---|---|---|
//! | [`Window`], [`Frozen`] | a reading | a sensor that is broken while off; for `Frozen` a reading that moves |
//! | [`Gain`] | power | a gain of 2 C; power that is off for four times as long |
//! | [`HeatBalance`] | power | the arrival of all heat; something cold that is laid on; M303 and self-test, which do not believe the model |
//! | [`AtTarget`] | a target | another target, off, M303, a self-test, a fault |
//! | [`WhileOff`] | the arrival of all heat | power |
//! | [`Swapped`] | power from the cold, or alone | less than half of the power |
//!
//! `Gain` and `HeatBalance` outlive a new target: a target that changes all the time would hold them up. How long heat is under way
//! after the last power is known to [`UnderWay`] alone, and all guards ask it (`Seen::is_settled`).
//!
//! A new guard: a file here and a row in both tables above; a field of `HeaterGuards` and a line where the others are fed
//! (`thermal/heater_guards.rs`), or in `thermal/control.rs` if it is not of one heater. If it keeps numbers that come from the settings, they
//! go into the sum of `HeaterGuards::numbers`. A [`Cause`] (`fault/cause.rs`); what it measures, in `port::ThermalPort`
//! (`chips/stm32f446/src/heat.rs`, `rig/src/heat.rs`, `tests/thermal/printer.rs` and `tests/support/wild_heat.rs` implement it,
//! `emulator/src/wiring.rs` has the pins); its threshold, if it has one, in `settings::Guards`. Then a fault of the plant that it
//! finds (`rig/src/plant/faults.rs`, tested in `rig/src/plant/tests/broken.rs`), a test in `tests/faults`, and a row in both tables
//! of docs/safety.md.

mod at_target;
mod episode;
mod fan_turns;
mod floor;
mod frozen;
mod heat_balance;
mod reference;
mod swapped;
mod under_way;
mod while_off;
mod window;

pub use at_target::AtTarget;
pub use episode::Episode;
pub use fan_turns::FanTurns;
pub use floor::{Floor, Gain};
pub use frozen::Frozen;
pub use heat_balance::{HeatBalance, Numbers};
pub use reference::Reference;
pub use swapped::Swapped;
pub use under_way::UnderWay;
pub use while_off::WhileOff;
pub use window::{LEAST, Window};

use crate::fault::Cause;
use crate::settings::HeaterModel;
use crate::units::{Celsius, periods_in};

/// What guards see of a heater in a control period.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The reading, as it comes.
    pub measured: Celsius,
    /// The reading without its noise.
    pub smooth: Celsius,
    /// The duty that it gets, of 65,535.
    pub duty: u16,
    /// All its heat has arrived: it has been without power for long enough.
    pub is_settled: bool,
    /// Up to here another heater warms it, rightly: a bed warms its chamber, and a hotend that is off.
    pub warmed_to: Celsius,
}

impl Seen {
    /// A heater without power, whose last heat is still under way.
    #[must_use]
    pub const fn quiet(measured: Celsius) -> Self {
        Self { measured, smooth: measured, duty: 0, is_settled: false, warmed_to: Celsius::MIN }
    }

    /// Whether it has any power.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.duty > 0
    }
}

/// What a guard has found: the cause, what is, and what may be.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Alarm {
    /// Why.
    pub cause: Cause,
    /// What is.
    pub value: Celsius,
    /// What may be.
    pub limit: Celsius,
}

/// Control periods of so many of a heater's lags: element to block and block to sensor.
const fn periods_of_lags(lags: u32, model: &HeaterModel) -> u32 {
    periods_in(lags, model.lag(), super::fixed_point::RATE.unsigned_abs())
}

/// Control periods of so many seconds.
const fn periods(seconds: u32) -> u32 {
    seconds * super::fixed_point::RATE.unsigned_abs()
}
