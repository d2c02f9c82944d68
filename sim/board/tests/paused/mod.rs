//! Prints that are paused, held, cancelled and resumed: the clock runs, and motion is counted.

mod ends;
mod filament_change;
mod heat;
mod held;
mod hosts;
mod motors_off;
mod parking;
mod program;
mod stream;

use crate::common::heated::heated;
use crate::common::life::Life;

const MINUTE: u64 = 60_000;

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
