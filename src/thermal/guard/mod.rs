//! Guards: each looks for one way in which a heater can go wrong, and none can be switched off.
//!
//! | guard | finds | when |
//! |---|---|---|
//! | [`Window`] | readings that no working machine has | always |
//! | [`HeatBalance`] | a heater or sensor that is loose, open, or too weak | while it heats |
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
//! A new guard: a file here and a row above; a field of `HeaterGuards`, in `configure` too if it has a threshold, and a line where the others are fed (`thermal/heater.rs`),
//! or in `thermal/control.rs` if it is not of one heater; a [`Cause`] (`fault/cause.rs`); what it measures, in `port::ThermalPort`
//! (`chips/stm32f446/src/heat.rs`, `rig/src/heat.rs`, `tests/thermal/printer.rs` and `tests/support/wild_heat.rs` implement it,
//! `emulator/src/wiring.rs` has the pins); its threshold, if it has one,
//! in `settings::Guards`. Then a fault of the plant that it finds (`rig/src/plant/faults.rs`, tested in `rig/src/plant/tests/broken.rs`), a test in `tests/faults`, and a row
//! in both tables of docs/safety.md.

mod at_target;
mod fan_turns;
mod frozen;
mod heat_balance;
mod reference;
mod swapped;
mod while_off;
mod window;

pub use at_target::AtTarget;
pub use fan_turns::FanTurns;
pub use frozen::Frozen;
pub use heat_balance::HeatBalance;
pub use reference::Reference;
pub use swapped::Swapped;
pub use while_off::WhileOff;
pub use window::{LEAST, Window};

use crate::fault::Cause;
use crate::settings::HeaterModel;
use crate::units::{Celsius, periods_in};

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
