//! Loads: the drivers' measurements of their motors.

use crate::belt::printer::{plant, print_on};
use corehbot::motors::{Motor, prototype};
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::tmc2209::SG_RESULT;

const MOTORS: [Motor; 4] = [prototype::M1, prototype::M4, prototype::M8, prototype::M11];

fn measured(lines: &[&str], rubbing: &[&str], on_belt: bool) -> [u32; 4] {
    let start = Some([150.0, 208.8, 10.0]);
    let parts = rubbing.iter().map(|part| part.parse().unwrap()).collect();
    let accidents = Accidents { parts, ..Accidents::default() };
    let mut plant = if on_belt { plant(start, None, accidents) } else { None };
    let printed = print_on(&mut plant, start, lines);
    MOTORS.map(|motor| printed.drivers.chip(motor).register(SG_RESULT))
}

#[test]
fn a_motor_that_rubs_reads_as_more_load_in_stealth_chop_alone() {
    let moves = ["M569 S1 X Y", "G1 X230 F6000", "M400", "G4 P2000"];
    let [m1, m4, m8, m11] = measured(&moves, &["rub:m8:20N@0s"], true);
    // 20 N of 63 are 32 % of 400: 128 less. The others bear friction, braking, and a little of that.
    for other in [m1, m4, m11] {
        assert!(other > m8 + 60 && other > 280, "{m1} {m4} {m8} {m11}");
    }
    assert!((200..320).contains(&m8) && m8 % 2 == 0, "{m8}");
    assert_eq!(measured(&["G1 X230 F6000", "M400"], &["rub:m8:20N@0s"], true), [0; 4]);
    assert_eq!(measured(&moves, &[], false), [0; 4]);
}
