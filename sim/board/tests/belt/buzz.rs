//! STEPPER_BUZZ on the plant: whichever motor moves and whichever turns freely, the belt is not strained.

use crate::belt::printer::print;
use corehbot_sim::belt::accident::Accidents;

const MOTORS: [&str; 4] = ["m1", "m4", "m8", "m11"];

const MIDDLE: Option<[f64; 3]> = Some([195.0, 208.8, 10.0]);

/// A motor that strains the belt by a millimetre bears 0.22 Nm of its 0.4 (docs/research/twin.md, skips). What remains
/// here is the start from rest, and the free motor that is dragged.
#[test]
fn a_motor_alone_strains_nothing_and_comes_back() {
    for motor in MOTORS {
        for free in MOTORS.into_iter().filter(|free| *free != motor) {
            let line = format!("STEPPER_BUZZ STEPPER={motor} FREE={free}");
            let (printed, plant) = print(MIDDLE, Accidents::default(), &["M17 X Y", &line, "M400"]);
            let figures = plant.figures();
            assert!(printed.heard.iter().any(|line| line.contains("moved 1.000 mm to and fro")), "{:?}", printed.heard);
            assert!(figures.skips.is_empty(), "{line}: {figures}");
            for motor in &figures.motors {
                assert!(motor.largest_torque_share < 0.35, "{line}: {figures}");
            }
            assert_eq!(printed.outcome.counts, [0; corehbot::motors::MOTORS], "{line}");
            assert!(printed.drivers.enabled().is_empty(), "{line}");
        }
    }
}

/// 80 steps there and 80 back, five times, of one motor and no other.
#[test]
fn it_moves_one_motor_by_a_millimetre() {
    let (printed, _) = print(MIDDLE, Accidents::default(), &["STEPPER_BUZZ STEPPER=m4"]);
    assert_eq!(printed.events.len(), 800);
    let (mut at, mut seen) = (0_i32, 0);
    for (_, steps, forward) in printed.events {
        assert_eq!(steps, 0b10);
        at += if forward == 0 { -1 } else { 1 };
        assert!((0..=80).contains(&at));
        seen = seen.max(at);
    }
    assert_eq!((at, seen), (0, 80));
}

/// M410 in the middle: no motor keeps power without the others of its belt, and the axes have lost their homes.
#[test]
fn homes_are_lost_and_the_next_move_has_all_its_motors() {
    let lines = ["STEPPER_BUZZ STEPPER=m1", "M211", "G28 X Y", "G1 X100 F3000", "M400"];
    let (printed, _) = print(MIDDLE, Accidents::default(), &lines);
    assert_eq!(printed.drivers.enabled().0 & 0b1111, 0b1111);
    assert!(!printed.heard.iter().any(|line| line.starts_with("Error")), "{:?}", printed.heard);
}
