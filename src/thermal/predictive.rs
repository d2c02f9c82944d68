//! Control that predicts: as much power as the target will need when it arrives, and what the model says is missing.
//!
//! The power is the losses at the target, with the filament that will run when this power has reached the block, plus what
//! brings block and heat on its way to the target within the heater's lag. The observer knows which power was really given,
//! so nothing winds up while the heater is at its limit, and its drift is the integral part.

use super::fixed_point::{Power, times};
use super::observer::Observer;
use crate::units::Celsius;
use fixed::types::I8F24;

/// What the look-ahead knows of the filament.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Ahead {
    /// Heat that the filament of the coming heater lag takes for each K, in J/K.
    pub coming: I8F24,
    /// Heat that it takes at the end of that time, in W/K.
    pub then: I8F24,
}

/// The power that brings `target` about; the caller limits it to what the heater has.
#[must_use]
pub fn power(observer: &Observer, target: Celsius, ahead: Ahead) -> Power {
    let excess = observer.excess(target, ahead.coming);
    let missing = times(observer.numbers().grip, Celsius::ZERO.saturating_sub(excess));
    observer.power(target, ahead.then, missing)
}
