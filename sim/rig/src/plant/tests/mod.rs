//! The plant against physics by hand: energy, steady states, an independent inversion, and each kind of fault.

// For the checks' own logarithms.
extern crate std;

mod broken;
mod heat;
mod readings;

use super::*;

/// The prototype's plant.
fn prototype() -> Plant {
    Plant::new(&PlantConstants::prototype())
}

/// Seconds of `drive`, in steps of 20 ms as a controller takes them.
fn run(plant: &mut Plant, drive: &Drive, seconds: u32) {
    for _ in 0..seconds * 50 {
        plant.step(drive, 0.02);
    }
}

/// The prototype with its hotend at `celsius`, and its bed at the room's temperature.
fn hot(celsius: f64) -> Plant {
    Plant::hot(&PlantConstants::prototype(), celsius, 25.0)
}

#[track_caller]
fn assert_near(is: f64, should: f64, within: f64) {
    assert!((is - should).abs() <= within, "{is} is not {should} +- {within}");
}
