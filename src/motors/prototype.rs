//! Motors of the prototype, the machine of the CoreH-bot paper. Only the default machine and tests name them.
//!
//! Belt motors carry the number of their pulley in figure 5 of the paper.

use super::{MOTORS, Motor, MotorName, MotorSet, per_motor};

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

/// Their names.
const LISTED: [MotorName; 7] = MotorName::all(["m1", "m4", "m8", "m11", "z1", "z2", "e0"]);

/// How many it has: the first ones of all motors.
pub const COUNT: usize = LISTED.len();

/// The name of each.
pub const NAMES: [MotorName; MOTORS] = per_motor(&LISTED, MotorName::NONE);

/// The four belt motors.
pub const BELT: MotorSet = MotorSet(0x0F);
/// Both ball screws.
pub const Z: MotorSet = MotorSet(0x30);
/// The extruder.
pub const E: MotorSet = MotorSet(0x40);
/// All of them.
pub const ALL: MotorSet = BELT.with(Z).with(E);
