//! Figures that were computed independently (two solvers, closed forms), each asked on the command line and within 1 %:
//! pushes, a jump of speed.

use super::{ask, complaint, json, near};

/// One per cent.
const PART: f64 = 0.01;

#[test]
fn a_push_moves_the_tool_by_force_over_stiffness() {
    let push = json("push --force 5,-4 --at 150,180");
    assert!(near(&push["dx_mm"], 5.0 / 300.010, PART) && near(&push["dy_mm"], -4.0 / 282.963, PART), "{push}");
    // Spans of 659.6 + 5 and 1009.6 - 5 mm at x = 150 share the force in the inverse of their lengths.
    let (right, left) = (1004.6, 664.6);
    let part = left / (left + right);
    assert!(near(&push["tension_change_N"]["R"], -2.5 * part, PART), "{push}");
    assert!(near(&push["tension_change_N"]["L"], 2.5 * (1.0 - part), PART), "{push}");
}

#[test]
fn forces_that_cannot_be_are_refused() {
    assert_eq!(ask("push --force 1e300,0").status.code(), Some(2));
}

/// `v / w`, and the figures with idlers of an independent computation.
#[test]
fn a_jump_of_speed_rings_by_speed_over_angular_frequency() {
    for (model, x, y) in [("reduced", (144.45, 110.182), (254.29, 62.587)), ("full", (146.9, 109.535), (262.2, 61.832))]
    {
        for (speed, axis, (amplitude, frequency)) in [("100,0", "x", x), ("0,100", "y", y)] {
            let told = json(&format!("jump --speed {speed} --undamped --model {model} --at 235,235"));
            let found = &told[axis];
            assert!(
                near(&found["amplitude_um"], amplitude, PART) && near(&found["frequency_Hz"], frequency, PART),
                "{told}"
            );
            let other = &told[if axis == "x" { "y" } else { "x" }];
            assert!(other["frequency_Hz"].is_null() && near(&other["amplitude_um"], 0.0, 1e-3), "{told}");
        }
    }
    // Friction holds the tool back: 1 N of dry friction and 0.004 N s/mm against 278.4 N/mm.
    let told = json("jump --speed 0,100 --model reduced --at 235,235");
    let help = String::from_utf8(ask("jump --help").stdout).unwrap();
    assert!(help.contains("of a single mode (--model reduced)") && help.contains("lag at constant speed"), "{help}");
    assert!(near(&told["y"]["rest_um"], -1000.0 * 1.4 / 278.358, 0.02), "{told}");
    assert!(complaint("jump --speed 3000,0").contains("the path takes"));
}
