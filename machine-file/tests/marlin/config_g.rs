//! RepRapFirmware's `config.g` as a machine file: a whole one, and lines one by one.

use super::sources::{holds, value};
use crate::reports::verdict;
use corehbot_machine_file::Kind::{Approximated, Decide, NotNeeded, Taken};
use corehbot_machine_file::marlin::Given;
use corehbot_machine_file::{Translation, reprap};

fn of(lines: &str) -> Translation {
    let given = Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics: None };
    reprap::translate("config.g", &format!("M584 X0 Y1 Z2:4 E3\n{lines}\n"), given)
}

/// A CoreXY as a config.g.
pub(super) const CONFIG_G: &str = "; a machine
M550 P\"two; words\" ; its name
M584 X0 Y1 Z2:3 E4
M569 P0 S0 D3
M569 P1 S1
M569 P3 S0
M350 X16 Y16 Z16 E16 I1
M92 X80 Y80 Z400 E420:420
M203 X18000.00 Y18000.00 Z600 E3600
M201 X3000 Y2500 Z100 E5000
M566 X600 Y480 Z24 E120
M906 X800 Y800 Z1000 E600 I30
M669 K1
M208 X0 Y-5 Z0 S1
M208 X230 Y210 Z200 S0
M574 X1 S1 P\"!xstop\"
M574 Y2 S1 P\"ystop\"
M574 Z1 S2
M558 P9 C\"^zprobe.in\" H5 F240:120 T6000 A3 S0.01
G31 P500 X-16.4 Y-29.3 Z2.25
M308 S0 P\"bedtemp\" Y\"thermistor\" T100000 B4138
M950 H0 C\"bedheat\" T0
M143 H0 S120
M308 S1 P\"e0temp\" Y\"thermistor\" T100000 B4725 C7.06e-8
M950 H1 C\"e0heat\" T1
M307 H1 R2.4 K0.5:0.2 D5.5 S0.80
M563 P0 D0 H1
M572 D0 S0.05
M593 P\"mzv\" F40
M98 P\"other.g\"
";

#[test]
fn a_config_g_becomes_a_machine() {
    assert!(reprap::is_config(CONFIG_G));
    let given = Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics: None };
    let done = reprap::translate("config.g", CONFIG_G, given);
    holds(
        &done,
        &[
            ("name", "\"two words\""),
            ("mechanism.x", "[1, 1, 0]"),
            ("mechanism.z1", "[0, 0, 1]"),
            ("axes.x.steps_per_mm", "80"),
            ("axes.e.steps_per_mm", "420"),
            ("axes.x.max_speed", "300"),
            ("axes.z.max_speed", "10"),
            ("axes.y.max_acceleration", "2500"),
            ("corner.square_corner", "8"),
            ("z_jerk", "0.4"),
            ("extruder_jerk", "2"),
            // Peaks of 800, 1000 and 600 mA.
            ("drivers.belt.current_ma", "566"),
            ("drivers.z.current_ma", "707"),
            ("drivers.e.current_ma", "424"),
            ("drivers.z.hold_percent", "30"),
            ("drivers.belt.microsteps", "16"),
            ("drivers.belt.interpolate", "true"),
            ("axes.y.min", "-5"),
            ("axes.y.length", "215"),
            ("homing.y.end", "\"max\""),
            ("motors.x", "\"!M0\""),
            ("motors.y", "\"M1\""),
            ("motors.z1", "\"!M3\""),
            ("endstops.x", "\"!X-STOP\""),
            ("probe.kind", "\"bltouch\""),
            ("probe.z_home", "true"),
            ("probe.fast", "4"),
            ("probe.slow", "2"),
            ("probe.travel", "100"),
            ("probe.clearance", "5"),
            ("probe.tolerance", "0.01"),
            ("probe.offset.x", "-16.4"),
            ("probe.offset.z", "-2.25"),
            ("heaters.bed.thermistor", "{ beta = 4138, ohms = 100000 }"),
            ("heaters.hotend.thermistor", "{ beta = 4725, cubic = 71, ohms = 100000 }"),
            ("heaters.bed.most", "120"),
            ("heaters.hotend.max_duty", "0.8"),
            ("advance.time", "0.05"),
            ("shaper.x.kind", "\"mzv\""),
            ("shaper.y.frequency", "40"),
            ("require_homing", "true"),
        ],
    );
    let of = |section: &str, key: &str| verdict(&done.report, section, key);
    assert_eq!(of("M307", "H1 R"), (Approximated, "its model has other numbers here: M303 finds them"));
    assert_eq!(of("M98", "P").0, Approximated);
    assert_eq!(of("M569", "P1 S"), (Taken, "motors.y is without `!`"));
    assert_eq!(of("M574", "Z S").0, Taken);
}

/// Microsteps behind the steps of a mm change them, and a stall is no switch.
#[test]
fn a_config_g_is_read_as_its_firmware_reads_it() {
    let text = "M584 X0 Y1 Z2 E3\nM92 X80 Y80 Z400\nM350 X32 I0\nM574 X1 S3\nM558 P1\nM558 P5 H3\nM669 K3\n";
    let done = reprap::translate("config.g", text, Given::default());
    holds(
        &done,
        &[("axes.x.steps_per_mm", "160"), ("axes.y.steps_per_mm", "80"), ("drivers.belt.interpolate", "false")],
    );
    let of = |section: &str, key: &str| verdict(&done.report, section, key);
    assert_eq!(of("M574", "X S").0, Decide);
    assert_eq!(of("M669", "K").0, Decide);
    assert!(done.report.sections.iter().any(|section| section.keys.iter().any(|key| key.verdict.kind == NotNeeded)));
    for other in ["M92 X80\nM203 X300\n", "[printer]\n[stepper_x]\n", "G28\nG1 X5\n", "#define A 5\n"] {
        assert!(!reprap::is_config(other), "{other}");
    }
}

/// Version 2 says by S0 that a switch closes; a switch at its usual place opens (S1).
#[test]
fn switches_that_close_keep_their_sign() {
    let given = Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics: None };
    for (lines, [x, y]) in [
        ("M574 X1 Y2 S0", ["!X-STOP", "!Y-STOP"]),
        ("M574 X1 Y2 S1", ["X-STOP", "Y-STOP"]),
        ("M574 X1 Y2", ["X-STOP", "Y-STOP"]),
        ("M574 X1 S0\nM574 Y2 S1", ["!X-STOP", "Y-STOP"]),
        ("M574 X1 Y2 S0\nM574 X1 S1", ["X-STOP", "!Y-STOP"]),
        ("M574 X1 S0\nM574 X1 S0\nM574 Y1 S1", ["!X-STOP", "Y-STOP"]),
        ("M574 X1 S1 P\"!xstop\"\nM574 Y1 S1 P\"ystop\"", ["!X-STOP", "Y-STOP"]),
    ] {
        let done = reprap::translate("config.g", &format!("M584 X0 Y1 Z2 E3\n{lines}\n"), given);
        holds(&done, &[("endstops.x", &format!("{x:?}")), ("endstops.y", &format!("{y:?}"))]);
        let asked = done.report.open.join("\n");
        assert!(asked.contains(&format!("endstops.x = {x:?}, endstops.y = {y:?}")), "as in the file: {asked}");
    }
    let done = reprap::translate("config.g", "M574 X1 Y2 S0\n", given);
    assert_eq!(verdict(&done.report, "M574", "XY S"), (Taken, "endstops.x has `!`; endstops.y has `!`"));
    let done = reprap::translate("config.g", "M574 X1 S0\n", Given::default());
    assert_eq!(verdict(&done.report, "M574", "X S").0, Approximated);
    let done = reprap::translate("config.g", "M574 X1 S0 P\"xstop\"\n", given);
    assert_eq!(verdict(&done.report, "M574", "X S").0, Decide);
}

/// A shaper's kind and frequency are one command; motors of an axis and numbers without end are told.
#[test]
fn words_of_a_config_g_have_one_verdict() {
    let of = |lines: &str| reprap::translate("config.g", &format!("M584 X0 Y1 Z2 E3\n{lines}\n"), Given::default());
    for (line, kind, frequency) in [("M593 P\"mzv\" F42", "mzv", "42"), ("M593 F30", "zvd", "30")] {
        let done = of(line);
        holds(
            &done,
            &[
                ("shaper.x.kind", &format!("{kind:?}")),
                ("shaper.y.kind", &format!("{kind:?}")),
                ("shaper.x.frequency", frequency),
            ],
        );
        assert_eq!(verdict(&done.report, "M593", "F").0, Taken, "{line}");
    }
    holds(&of("M593 P\"none\" F40"), &[("shaper.x.kind", "\"none\"")]);
    let done = reprap::translate("config.g", "M584 X0.0 Y0.1 Z0.2:0.4:0.5 E0.3\n", Given::default());
    let (kind, said) = verdict(&done.report, "M584", "Z");
    assert!(kind == Taken && !said.contains("hybrid"), "{said}");
    holds(&done, &[("mechanism.z2", "[0, 0, 1]")]);
    assert!(!done.text.contains("hybrid_threshold"), "{}", done.text);
    let done = of("M92X80Y80Z400E420");
    assert_eq!(verdict(&done.report, "M92", "Z").0, Decide);
    holds(&done, &[("axes.x.steps_per_mm", "80"), ("axes.y.steps_per_mm", "80")]);
    holds(&of("M92X80Y80Z400 E420"), &[("axes.z.steps_per_mm", "400"), ("axes.e.steps_per_mm", "420")]);
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
