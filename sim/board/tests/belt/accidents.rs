//! Accidents: a tool that runs into something, and a motor that rubs.

use crate::belt::printer::print;
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::figures::BeltFigures;

/// A skip of one electrical turn in the middle: dx, dy and residual in mm of motors 1, 4, 8 and 11, from an independent
/// computation. The residual allows for fields that give way.
const TABLE: [(&str, [f64; 3]); 4] = [
    ("m1", [-0.1995, 0.1995, 0.618]),
    ("m4", [-0.1995, -0.1995, -0.618]),
    ("m8", [0.1995, -0.1995, 0.618]),
    ("m11", [0.1995, 0.1995, -0.618]),
];

/// The middle of the reach, where every move here ends.
const MIDDLE: [&str; 3] = ["G1 X195 Y208.8 F6000", "M400", "G4 P500"];

fn after(start: [f64; 2], hits: &[&str], parts: &[&str]) -> BeltFigures {
    let hits = hits.iter().map(|hit| hit.parse().unwrap()).collect();
    let parts = parts.iter().map(|part| part.parse().unwrap()).collect();
    let (_, plant) = print(Some([start[0], start[1], 10.0]), Accidents { hits, parts }, &MIDDLE);
    plant.figures()
}

/// Difference of the tool and the residual from the table's values for these skips.
fn beside_the_table(figures: &BeltFigures) -> f64 {
    let mut meant = [0.0; 3];
    for skip in &figures.skips {
        let (_, one) = TABLE.iter().find(|(motor, _)| *motor == skip.motor.as_str()).unwrap();
        meant.iter_mut().zip(one).for_each(|(sum, part)| *sum += f64::from(skip.turns) * part);
    }
    let [x, y] = figures.off_xy_mm.unwrap();
    let found = [x, y, figures.residual_mm.unwrap()];
    found.iter().zip(meant).map(|(found, meant)| (found - meant).abs()).fold(0.0, f64::max)
}

#[test]
fn a_strong_hit_makes_motors_skip_as_the_slip_table_says() {
    // On a diagonal two motors drive alone: 126 N hold them, and 180 N are in the way.
    for (start, driving, hit) in
        [([175.0, 188.8], ["m4", "m11"], "190,203.8,180,14"), ([215.0, 188.8], ["m1", "m8"], "200,203.8,180,14")]
    {
        for rubbing in [&[][..], &["rub:m11:5N@0s", "rub:m1:5N@0s"]] {
            let figures = after(start, &[hit], rubbing);
            assert!(!figures.skips.is_empty(), "{figures}");
            for skip in &figures.skips {
                assert!(driving.contains(&skip.motor.as_str()) && skip.turns != 0, "{figures}");
                // It is at the place of the hit, some 0.2 s after the begin.
                let [x, y] = skip.at_mm;
                assert!((x - start[0]).abs() > 13.0 && (y - 203.8).abs() < 2.0, "{figures}");
                assert!((0.15..0.35).contains(&skip.time_s), "{figures}");
            }
            // Dry friction of guides, and of 5 N at two rotors, leaves some um.
            assert!(beside_the_table(&figures) < 0.015, "{figures}");
            assert_eq!(figures.missed_hits, 0);
        }
    }
    // Where one motor of the pair skips once more, belt is strained.
    let figures = after([175.0, 188.8], &["190,203.8,180,14"], &["rub:m11:5N@0s"]);
    assert!((figures.residual_mm.unwrap().abs() - 0.618).abs() < 0.015, "{figures}");
}

#[test]
fn a_weak_hit_makes_none_and_the_tool_catches_up() {
    let figures = after([175.0, 188.8], &["190,203.8,80,14"], &[]);
    assert!(figures.skips.is_empty() && figures.off_mm.unwrap() < 0.01, "{figures}");
    // It held the tool up: 80 N over 248 N/mm, and more, since the sine of a field gives way.
    assert!((0.32..0.6).contains(&figures.largest_off_mm), "{figures}");
    // A place that the tool never reaches is reported.
    assert_eq!(after([175.0, 188.8], &["10,10,500,14"], &[]).missed_hits, 1);
}

#[test]
fn a_motor_that_rubs_more_than_it_holds_skips_and_one_that_rubs_less_does_not() {
    // 0.40 N m are 63 N at the belt, and the other motors pull, too.
    let figures = after([175.0, 208.8], &[], &["rub:m8:200N@0.1s"]);
    assert!(figures.skips.iter().any(|skip| skip.motor.as_str() == "m8" && skip.turns < 0), "{figures}");
    assert!(figures.skips.iter().all(|skip| skip.time_s > 0.09), "{figures}");
    let figures = after([175.0, 208.8], &[], &["rub:m8:20N@0s"]);
    assert!(figures.skips.is_empty(), "{figures}");
    let shares: Vec<f64> = figures.motors.iter().map(|motor| motor.largest_torque_share).collect();
    assert!(shares[2] > shares[0] + 0.1 && shares[2] > shares[1] + 0.1, "{figures}");
}
