//! Lines of a `config.g` one by one.

use super::reports::verdict;
use super::sources::{holds, value};
use corehbot_machine_file::Kind::{Decide, NotNeeded, Taken};
use corehbot_machine_file::marlin::Given;
use corehbot_machine_file::{Translation, reprap};

fn of(lines: &str) -> Translation {
    let given = Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics: None };
    reprap::translate("config.g", &format!("M584 X0 Y1 Z2:4 E3\n{lines}\n"), given)
}

/// Reproducer: an expression had "no setting", and its key that of the prototype.
#[test]
fn an_expression_is_to_decide() {
    for (line, section, key) in [
        ("M92 X{80*2} Y80", "M92", "X"),
        ("M906 X{global.current} Y800", "M906", "X"),
        ("M906 Y800 X{max({1, 2}, \"}\")}", "M906", "X"),
        ("M208 X{-5,300}", "M208", "X"),
        ("M569 P4 S{var.z}", "M569", "P4 S"),
    ] {
        let done = of(line);
        let (kind, said) = verdict(&done.report, section, key);
        assert!(kind == Decide && said.contains("an expression"), "{line}: {said}");
    }
    let done = of("M906 Y800 X{max({1, 2}, \"}\")} Z900");
    assert_ne!(verdict(&done.report, "M906", "Z").0, Decide, "{}", done.report);
    let done = of("if {state.status == \"idle\"}\n  M92 X80\nelse\n\tM92 X160\nM92 Y80");
    assert_eq!(verdict(&done.report, "M92", "X").0, Decide, "{}", done.report);
    assert_eq!(verdict(&done.report, "M92", "Y").0, Taken, "{}", done.report);
    // Of a network nothing is decided.
    assert_eq!(verdict(&of("M552 S{1}").report, "M552", "S").0, NotNeeded);
}

/// Brackets are a comment for a mill; a printer reads the letters in them.
#[test]
fn brackets_are_a_comment_of_a_mill_alone() {
    let done = of("M453\nM92 X80 (was Y99) Y160");
    holds(&done, &[("axes.x.steps_per_mm", "80"), ("axes.y.steps_per_mm", "160")]);
    for lines in ["M92 X80 (was Y99)", "M453\nM451\nM92 X80 (was Y99)"] {
        let done = of(lines);
        let (kind, said) = verdict(&done.report, "M92", "(");
        assert!(kind == Decide && said.contains("M453"), "{said}");
        assert_eq!(value(&done, "axes.y.steps_per_mm"), Some(0.into()), "{}", done.text);
    }
    holds(&of("M550 P\"a (b)\""), &[("name", "\"a (b)\"")]);
}

/// Each driver of an axis has its own direction.
#[test]
fn each_driver_of_an_axis_has_its_direction() {
    holds(&of("M569 P2 S1\nM569 P4 S0"), &[("motors.z", "\"M2\""), ("motors.z1", "\"!M3\"")]);
    holds(&of("M569 P0.2 S0\nM569 P0.4 S1"), &[("motors.z", "\"!M2\""), ("motors.z1", "\"M3\"")]);
}
