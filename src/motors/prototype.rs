//! Motors of the prototype, the machine of the CoreH-bot paper. Only the default machine and tests name them.
//!
//! Belt motors carry the number of their pulley in figure 5 of the paper.

use super::{MOTORS, Motor, MotorName, MotorSet};

/// Pulley 1, lower left.
pub const M1: Motor = Motor(0);
/// Pulley 4, lower right.
pub const M4: Motor = Motor(1);
/// Pulley 8, upper right.
pub const M8: Motor = Motor(2);
/// Pulley 11, upper left.
pub const M11: Motor = Motor(3);
/// Left ball screw.
pub const Z1: Motor = Motor(4);
/// Right ball screw.
pub const Z2: Motor = Motor(5);
/// Extruder.
pub const E0: Motor = Motor(6);

/// The name of each.
pub const NAMES: [MotorName; MOTORS] = names(&["m1", "m4", "m8", "m11", "z1", "z2", "e0"]);

/// These names, then none.
const fn names(texts: &[&str]) -> [MotorName; MOTORS] {
    let mut names = [MotorName::NONE; MOTORS];
    let (mut from, mut to): (_, &mut [MotorName]) = (texts, &mut names);
    while let ([text, texts @ ..], [name, names @ ..]) = (from, to) {
        *name = MotorName::lit(text);
        (from, to) = (texts, names);
    }
    names
}

/// The four belt motors.
pub const BELT: MotorSet = MotorSet(0x0F);
/// Both ball screws.
pub const Z: MotorSet = MotorSet(0x30);
/// The extruder.
pub const E: MotorSet = MotorSet(0x40);
