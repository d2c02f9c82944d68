//! Power: which motors hold the tool, and the state that a motor finds when it gets power.

use crate::belt::printer::{plant, print, print_as, print_on};
use corehbot::settings::Settings;
use corehbot_sim::belt::accident::Accidents;

#[test]
fn motors_without_power_do_not_hold_the_tool_against_a_push() {
    let pushed = |lines: &[&str]| {
        let (_, mut plant) = print(Some([195.0, 208.8, 10.0]), Accidents::default(), lines);
        let before = plant.tool_mm()[0];
        plant.push([5.0, 0.0], 100);
        plant.tool_mm()[0] - before
    };
    let held = pushed(&["G1 X200 F6000", "M400", "G4 P200"]);
    // Up to 5 N over 251.2 N/mm, less friction, and the shift that friction had prevented.
    assert!((0.015..0.025).contains(&held), "{held}");
    // 4.5 N on 0.6 kg and four rotors of 0.134 kg: some 10 mm in 0.1 s.
    let free = pushed(&["G1 X200 F6000", "M400", "M84", "G4 P200"]);
    assert!((5.0..20.0).contains(&free), "{free}");
}

#[test]
fn power_up_strains_the_belt_within_bounds_and_is_no_skip() {
    let mut square = 0.0;
    for seed in 0..12 {
        let start = Some([195.0, 208.8, 10.0]);
        let mut plant = plant(start, Some(seed), Accidents::default());
        print_on(&mut plant, start, &["M17", "G4 P500"]);
        let figures = plant.unwrap().figures();
        assert!(figures.skips.is_empty(), "{seed}: {figures}");
        // Motors get power in turn, so only the last one strains the belt: by two full steps at most, and fields give
        // way.
        let residual = figures.residual_mm.unwrap();
        assert!(residual.abs() < 0.40, "{seed}: {figures}");
        // The firmware was not told that the tool moved.
        assert!((1e-3..0.4 * 1.5).contains(&figures.off_mm.unwrap()), "{seed}: {figures}");
        square += residual * residual;
    }
    // 0.18 mm RMS of many seeds; all at once 0.35.
    let rms = (square / 12.0_f64).sqrt();
    assert!((0.1..0.26).contains(&rms), "{rms}");
}

/// The same seeds without time between one motor and the next: the effect of the 100 ms.
#[test]
fn motors_that_settle_before_the_next_gets_power_strain_the_belt_half_as_much() {
    let rms = |settling_ms| {
        let mut settings = Settings::prototype();
        settings.belt.settling_ms = settling_ms;
        let residual = |seed| {
            let start = Some([195.0, 208.8, 10.0]);
            let mut plant = plant(start, Some(seed), Accidents::default());
            print_as(&settings, &mut plant, start, &["M17", "G4 P500"]);
            plant.unwrap().figures().residual_mm.unwrap()
        };
        let square: f64 = (0..30).map(|seed| residual(seed).powi(2)).sum();
        (square / 30.0).sqrt()
    };
    let (hurried, settled, longer) = (rms(0), rms(100), rms(300));
    assert!(settled < 0.6 * hurried, "{settled} {hurried}");
    assert!((settled - longer).abs() < 1e-3, "nothing is left to settle after 100 ms: {settled} {longer}");
}

/// M112 in mid-motion: the tool glides on, and nothing holds it.
#[test]
fn a_tool_whose_motors_lose_power_glides_on() {
    // More moves than the printer takes at once, so it is on its way when the last one is sent.
    let moves: Vec<String> = (0..300).map(|i| format!("G1 X{} F9000", 100.0 + f64::from(i) * 0.5)).collect();
    let lines: Vec<&str> = moves.iter().map(String::as_str).chain(["M112"]).collect();
    let (printed, mut plant) = print(Some([100.0, 208.8, 10.0]), Accidents::default(), &lines);
    assert!(printed.outcome.halted);
    plant.push([0.0; 2], 100);
    let ([x, y], [to_x, to_y]) = (plant.tool_mm(), plant.stepped_mm());
    assert!(x - to_x > 1.0 && (y - to_y).abs() < 0.05, "{x} {to_x}");
}
