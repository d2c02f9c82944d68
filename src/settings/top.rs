//! Rows of [`Settings`] itself.

use super::rows::{Field, Kind, Spec, Value, rows};
use super::{CornerRule, MachineName, Mm, MmPerSec, Settings, ranges};

/// Junction deviation as a field.
struct Deviation<'a>(&'a mut CornerRule);

impl Field for Deviation<'_> {
    fn get(&self) -> Value {
        if let CornerRule::JunctionDeviation(deviation) = &*self.0 { deviation.get() } else { Value::Absent }
    }

    fn set(&mut self, value: &Value) -> bool {
        let mut deviation = Mm::ZERO;
        let is_one = deviation.set(value);
        if is_one {
            *self.0 = CornerRule::JunctionDeviation(deviation);
        }
        is_one
    }
}

/// Square-corner velocity as a field.
struct SquareCorner<'a>(&'a mut CornerRule);

impl Field for SquareCorner<'_> {
    fn get(&self) -> Value {
        if let CornerRule::SquareCorner(speed) = &*self.0 { speed.get() } else { Value::Absent }
    }

    fn set(&mut self, value: &Value) -> bool {
        let mut speed = MmPerSec::ZERO;
        let is_one = speed.set(value);
        if is_one {
            *self.0 = CornerRule::SquareCorner(speed);
        }
        is_one
    }
}

fn parts(s: &mut Settings) -> [&mut Settings; 1] {
    [s]
}

rows! {
    for machine in parts, named &[""];

    /// The name that hosts, screens and reports show: up to 24 letters, digits, blanks and + - . , / ( ) & # '.
    1 "name" = machine.name, "", [Spec::text(MachineName::LONGEST, Kind::Name)];
    /// Speed limit of one belt motor, in mm of belt. A diagonal asks 1.41 times the tool's speed of two motors.
    2 "motor_max_speed" = machine.motor_max_speed, "mm/s", [ranges::SPEED.spec()];
    /// Acceleration limit of one belt motor, in mm of belt.
    3 "motor_max_acceleration" = machine.motor_max_acceleration, "mm/s2", [ranges::ACCELERATION.spec()];
    /// Acceleration of moves that print.
    4 "print_acceleration" = machine.print_acceleration, "mm/s2", [ranges::ACCELERATION.spec()], "M204" "P/S";
    /// Acceleration of moves of the extruder alone.
    5 "retract_acceleration" = machine.retract_acceleration, "mm/s2", [ranges::ACCELERATION.spec()], "M204" "R";
    /// Acceleration of moves that do not print.
    6 "travel_acceleration" = machine.travel_acceleration, "mm/s2", [ranges::ACCELERATION.spec()], "M204" "T/S";
    /// The part of a move over which its speed holds at least, unless it accelerates or brakes all along
    /// (SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO).
    7 "minimum_cruise_ratio" = machine.minimum_cruise_ratio, "", [ranges::CRUISE_RATIO.spec()];
    /// The jump in the extruder's speed that a corner may ask for (M205 E).
    8 "extruder_jerk" = machine.extruder_jerk, "mm/s", [ranges::SPEED.spec()];
    /// Least commanded speed of printing moves; 0 is none (M205 S).
    9 "min_feed" = machine.min_feed, "mm/s", [ranges::SPEED.spec().from_zero()];
    /// Least commanded speed of other moves; 0 is none (M205 T).
    10 "min_travel" = machine.min_travel, "mm/s", [ranges::SPEED.spec().from_zero()];
    /// Whether moves are kept inside the reachable space (M211).
    11 "soft_endstops" = machine.soft_endstops, "", [Spec::SWITCH];
    /// Whether moves of an axis that was not homed are refused. Otherwise the host is told of them once.
    12 "require_homing" = machine.require_homing, "", [Spec::SWITCH];
    /// How far the chords of an arc may lie inside it.
    13 "arc_tolerance" = machine.arc_tolerance, "mm", [ranges::TOLERANCE.spec()];
    /// Time between two busy messages; 0 is none.
    14 "keepalive_s" = machine.keepalive_s, "s", [ranges::KEEPALIVE_S.spec()], "M113" "S";
    /// Silence in the middle of numbered lines after which the host is asked to go on; 0 is never.
    15 "patience_ms" = machine.patience_ms, "ms", [ranges::PATIENCE_MS.spec().or_zero()];
    /// Motion at nominal speed that waits in the look-ahead before a line is answered.
    16 "lookahead_time" = machine.lookahead_time, "s", [ranges::LOOKAHEAD_TIME.spec()];
    /// Whether ok tells the line number, free moves and free lines (ok N12 P100 B9), as Marlin's ADVANCED_OK.
    17 "advanced_ok" = machine.advanced_ok, "", [Spec::SWITCH];
    /// Rate of the serial lines on the board's headers; USB has none. It counts after a reset.
    18 "baud" = machine.baud, "baud", [ranges::BAUD.spec()];
    /// Speed in corners by junction deviation: how far an arc that rounds the corner may leave it (M205 J).
    19 "corner.junction_deviation" = Deviation(&mut machine.corner), "mm", [ranges::TOLERANCE.spec()];
    /// Speed in corners by the speed through a right angle (M205 X).
    99 "corner.square_corner" = SquareCorner(&mut machine.corner), "mm/s", [ranges::SPEED.spec()];
}
