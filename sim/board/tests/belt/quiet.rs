//! Nothing happens: the firmware does as it does on a rigid machine, and the tool is where it should be.

use crate::belt::printer::{plant, print, print_on};
use corehbot_sim::belt::accident::Accidents;

/// Begins at the middle of the reach.
const PRINT: [&str; 11] = [
    "M204 P3000 T3000",
    "G1 X180 Y190 F9000",
    "G1 X210 Y190 E1 F6000",
    "G1 X210 Y220 E2",
    "G3 X190 Y220 I-10 J0 E3",
    "G1 X180 Y200 E4",
    "G1 Z11",
    "G1 X200 Y200 F9000",
    "G4 P300",
    "M400",
    "M114",
];

#[test]
fn a_print_makes_the_same_steps_and_ends_where_it_should() {
    let start = Some([195.0, 208.8, 10.0]);
    let rigid = print_on(&mut None, start, &PRINT);
    let (printed, plant) = print(start, Accidents::default(), &PRINT);
    assert!(rigid.events.len() > 10_000);
    assert!(printed.events == rigid.events && printed.heard == rigid.heard && printed.outcome == rigid.outcome);
    let figures = plant.figures();
    assert!(figures.skips.is_empty(), "{figures}");
    // Dry friction of 0.5 and 1 N over some 250 N/mm.
    assert!(figures.off_mm.unwrap() < 0.008 && figures.residual_mm.unwrap().abs() < 0.005, "{figures}");
    // Corners are taken at speed, and ramps begin at once: it rings by some tens of um.
    assert!((0.02..0.12).contains(&figures.largest_off_mm), "{figures}");
    assert!(figures.motors.iter().all(|m| (0.1..0.5).contains(&m.largest_torque_share)), "{figures}");
    let [x, y] = plant.tool_mm();
    assert!((x - 200.0).abs() < 0.008 && (y - 200.0).abs() < 0.008, "{x} {y}");
}

#[test]
fn homing_finds_switches_where_the_tool_meets_them() {
    let mut lines = vec!["G28", "G1 Z5 F900"];
    lines.extend(PRINT);
    let rigid = print_on(&mut None, None, &lines);
    let mut belt = plant(None, Some(5), Accidents::default());
    let printed = print_on(&mut belt, None, &lines);
    let tool = belt.as_ref().unwrap().tool_mm();
    let figures = belt.unwrap().figures();
    // Phases at power-up took the tool aside, and homing took that away: it is where the commands say.
    // A switch is met within a step of 12.5 um, by a tool that trembles and drags by some um.
    assert!((tool[0] - 200.0).abs() < 0.03 && (tool[1] - 200.0).abs() < 0.03, "{tool:?}");
    assert!(figures.off_mm.unwrap() < 0.03 && figures.residual_mm.unwrap().abs() > 0.05, "{figures}");
    // Ways to the switches differ for two reasons: the phases' shift, 0.4 mm at most, and the tool's ringing as it
    // meets the switches.
    for (on_belt, on_rig) in printed.outcome.counts.iter().zip(rigid.outcome.counts) {
        assert!(on_belt.abs_diff(on_rig) <= 64, "{on_belt} {on_rig}");
    }
    // After homing everything is the same: the last steps, counted from the last one.
    let tail = |events: &[(u64, u8, u8)]| {
        let end = events.last().unwrap().0;
        let last = &events[events.len() - 10_000..];
        last.iter().map(|(tick, steps, forward)| (end - tick, *steps, *forward)).collect::<Vec<_>>()
    };
    assert!(tail(&printed.events) == tail(&rigid.events));
}

/// The third degree of freedom: whatever strain there is goes round with it.
#[test]
fn a_belt_that_runs_round_leaves_the_tool_where_it_is() {
    let mut belt = plant(None, Some(3), Accidents::default());
    let home = ["G28", "G1 Z5 F900", "G1 X200 Y200 F6000", "G4 P500"];
    print_on(&mut belt, None, &home);
    let mut ran = plant(None, Some(3), Accidents::default());
    print_on(
        &mut ran,
        None,
        &[&home[..], &["G1 C40.05 F6000", "G1 X160 Y170 C-7", "G1 X200 Y200 C13", "M400"]].concat(),
    );
    let [before, after] = [belt, ran].map(|plant| {
        let mut plant = plant.unwrap();
        // It comes to rest.
        plant.push([0.0; 2], 500);
        assert!(plant.figures().skips.is_empty());
        plant.tool_mm()
    });
    for (before, after) in before.into_iter().zip(after) {
        assert!((before - after).abs() < 0.003, "{before} {after}");
    }
}

#[test]
fn a_seed_is_the_same_machine_every_time() {
    let print = |seed| {
        let mut plant = plant(None, Some(seed), Accidents::default());
        let printed = print_on(&mut plant, None, &["G28 X Y", "G1 X60 Y50 F9000", "M400"]);
        (printed.events, plant.unwrap().figures())
    };
    let (first, second, other) = (print(3), print(3), print(4));
    assert!(first == second);
    assert!((first.1.residual_mm.unwrap() - other.1.residual_mm.unwrap()).abs() > 0.01);
}
