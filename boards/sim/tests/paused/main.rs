//! Prints that are paused, held, cancelled and resumed: the clock runs, and motion is counted.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod ends;
mod filament_change;
mod heat;
mod held;
mod hosts;
#[path = "../common/life.rs"]
mod life;
mod parking;
mod program;
#[path = "../../../../tests/support/mod.rs"]
mod support;

use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use corehbot::units::Watts;
use life::Life;

const MINUTE: u64 = 60_000;

/// A machine with a hotend and a bed that are warm before anything else.
fn heated() -> Settings {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    // A small one, which warms within seconds.
    settings.thermal.heaters.bed.power = Watts::from_num(1000);
    settings
}

/// Warms the machine up and prints a line; the tool ends at X150 Y100 Z50, E5.
fn print(life: &mut Life<'_>) {
    for line in ["M190 S40", "M109 S200", "G1 X150 E5 F6000", "M400"] {
        life.say(line);
    }
}

/// Where the tool is, and how much filament the extruder has moved, in mm.
fn place(life: &mut Life<'_>) -> [f64; 4] {
    let told = life.ask("M114 R", "X:");
    let number = |letter: &str| {
        let (_, rest) = told.split_once(letter).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    [number("X:"), number("Y:"), number("Z:"), f64::from(life.extruder_steps()) / 400.0]
}
