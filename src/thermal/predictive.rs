//! Predictive control: the power that the target will need when it arrives, and the power for the missing heat.
//!
//! The power is the losses at the target, with the filament that will run when this power has reached the block. To
//! this it adds the power that brings block and heat on its way to the target within the heater's lag. The observer
//! knows the power that was really given, so nothing winds up while the heater is at its limit, and its drift is the
//! integral part.

use super::fixed_point::driven;
use super::observer::Observer;
use crate::units::{Celsius, Power};
use fixed::types::I8F24;

/// The look-ahead's knowledge of the filament.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Ahead {
    /// Heat that the filament takes within the coming heater lag, in J/K.
    pub coming: I8F24,
    /// Heat that it takes at the end of that time, in W/K.
    pub then: I8F24,
}

/// The power that brings the block to `target`; the caller limits it to the heater's power.
#[must_use]
pub fn power(observer: &Observer, target: Celsius, ahead: Ahead) -> Power {
    let excess = observer.excess(target, ahead.coming);
    let missing = driven(Celsius::ZERO.saturating_sub(excess), observer.numbers().grip);
    observer.power(target, ahead.then, missing)
}
