//! Mechanisms of the field, as rows, and their settings.

use corehbot::kinematics::{Groups, Mechanism, Row};
use corehbot::motors::{MOTORS, MotorName, prototype};
use corehbot::settings::Settings;

pub const NONE: Row = [0; 4];
pub const Z: Row = [0, 0, 1, 0];
pub const E: Row = [0, 0, 0, 1];

/// Motors 1, 4, 8, 11, both of z, the extruder, and a third motor of z.
pub const MACHINES: [(&str, Mechanism); 11] = [
    ("corehbot", Mechanism::corehbot()),
    ("corexy", Mechanism::of(&[NONE, NONE, [1, -1, 0, 0], [1, 1, 0, 0], Z, NONE, E])),
    ("corexyz", COREXYZ),
    ("corexyz, three motors", COREXYZ_THREE),
    ("corexz", Mechanism::of(&[[0, 1, 0, 0], NONE, [1, 0, -1, 0], [1, 0, 1, 0], NONE, NONE, E])),
    ("cartesian", Mechanism::of(&[[1, 0, 0, 0], [0, 1, 0, 0], NONE, NONE, Z, Z, E])),
    ("dual y", Mechanism::of(&[[1, 0, 0, 0], [0, 1, 0, 0], [0, -1, 0, 0], NONE, Z, NONE, E])),
    // No belt runs like this, but its inverse is over three.
    ("skew", Mechanism::of(&[NONE, [1, 1, 1, 0], [-1, 1, 0, 0], [-1, 0, 1, 0], NONE, NONE, E])),
    ("awd corexy", Mechanism::of(&[[1, -1, 0, 0], [1, 1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], Z, NONE, E])),
    ("corehbot, two drivers", Mechanism::of(&[[-1, 1, 0, 0], [-1, -1, 0, 0], NONE, NONE, Z, Z, E])),
    (
        "corehbot, three screws",
        Mechanism::of(&[[-1, 1, 0, 0], [-1, -1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], Z, Z, E, Z]),
    ),
];

/// A CoreXY with a pulley of 20 teeth on motor 11 and one of 16 on motor 8. Equation 8 of the CoreH-bot paper divides
/// each row by the radius of its motor's pulley, which leaves 4 and 5 steps for one of the axes.
pub const UNEQUAL: Mechanism = Mechanism::of(&[NONE, NONE, [5, -5, 0, 0], [4, 4, 0, 0], Z, NONE, E]);

/// All of these, and one with pulleys of different sizes, with motors that each step for themselves.
pub fn all() -> impl Iterator<Item = (&'static str, Mechanism)> {
    MACHINES.into_iter().chain([("unequal pulleys", UNEQUAL)])
}

/// Carlyle's table: A in slot 11, B in 8, C in 4, D in 1.
pub const COREXYZ: Mechanism =
    Mechanism::of(&[[-1, 1, 1, 0], [-1, -1, 1, 0], [1, -1, 1, 0], [1, 1, 1, 0], NONE, NONE, E]);
pub const COREXYZ_THREE: Mechanism = Mechanism::of(&[NONE, [-1, -1, 1, 0], [1, -1, 1, 0], [1, 1, 1, 0], NONE, NONE, E]);

/// Machines with a closed belt that can run round.
pub const ROUND: [&str; 2] = ["corehbot", "corehbot, three screws"];

/// The settings of a machine with axes that share a resolution.
pub fn settings(mechanism: Mechanism) -> Settings {
    let mut s = Settings { mechanism, ..Settings::prototype() };
    s.motor_names[prototype::COUNT] = MotorName::lit("z3");
    s.belt.is_closed &= mechanism.can_circulate();
    if mechanism.share(0, 2) || mechanism.share(1, 2) {
        s.axes.z = s.axes.x;
    }
    s.check_machine().unwrap();
    s
}

/// The sum of counts that no position changes; 0 where there is none.
pub fn strain(groups: &Groups, counts: &[i64; MOTORS]) -> i64 {
    let constraint = groups.constraint().unwrap_or_default();
    groups.iter().zip(constraint).map(|(group, times)| i64::from(times) * counts[group.lead.index()]).sum()
}
