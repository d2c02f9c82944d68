//! Heaters and fans as hosts know them, on a simulated machine that warms and cools.

use crate::common::heat_talk::{machine, talk_with};
use corehbot::connectors::Heater;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Celsius;
use corehbot_rig::plant::HeaterFault;
use corehbot_sim::world::World;

fn talk(settings: &Settings, ms: u64, lines: &[&str]) -> Vec<String> {
    talk_with(settings, NoStorage, ms, lines, |_, _| {}).0
}

fn has(heard: &[String], line: &str) -> bool {
    heard.iter().any(|heard| heard == line)
}

#[test]
fn a_target_is_reported_from_the_next_line_on() {
    let heard = talk(&machine(&[Heater::Hotend, Heater::Bed]), 1000, &["M104 S20", "M140 S21.5", "M105"]);
    assert_eq!(heard[..2], ["ok", "ok"]);
    let (hotend, bed) = heard[2].split_once(" B:").unwrap();
    assert!(hotend.starts_with("ok T:2") && hotend.ends_with(" /20.00"), "{heard:?}");
    assert!(bed.starts_with('2') && bed.ends_with(" /21.50 @:0 B@:0"), "{heard:?}");
}

#[test]
fn only_heaters_that_are_fitted_are_reported() {
    let heard = talk(&machine(&[Heater::Bed]), 1000, &["M104 S200", "M104 S200", "M141 S40", "M105"]);
    assert_eq!(heard[..4], ["echo:no hotend configured, ignored", "ok", "ok", "ok"]);
    assert!(heard[4].starts_with("ok B:25.0") && heard[4].ends_with(" /0.00 B@:0"), "{heard:?}");
}

#[test]
fn targets_beyond_the_limits_are_refused_and_told_of() {
    let lines =
        ["M104 S20", "M104 S500", "M105", "M104 S-5", "M140 S99999999999", "M140 S0", "M104 T1 S20", "M104 S", "M105"];
    let heard = talk(&machine(&[Heater::Hotend, Heater::Bed]), 400, &lines);
    for told in [
        "echo:M104 ignored: S500 is out of range (0 to 285), stays 20",
        "echo:M104 S-5 is out of range, set to 0",
        "echo:M140 ignored: S1000000000 is out of range (0 to 120), stays 0",
        "echo:T1 Invalid extruder",
        "echo:line ignored: S needs a number",
    ] {
        assert!(has(&heard, told), "{told}: {heard:?}");
    }
    assert!(heard.iter().any(|line| line.starts_with("ok T:") && line.contains(" /20.00 B:")), "{heard:?}");
    assert!(heard.last().unwrap().contains(" /0.00 B:"), "{heard:?}");
}

/// A wait for a refused target would last for ever, or be over at once as if all were well: the firmware does not wait.
#[test]
fn no_target_that_was_refused_is_waited_for() {
    let heard = talk(&machine(&[Heater::Hotend]), 4000, &["M104 S30", "M109 S400", "M105"]);
    assert_eq!(heard[1], "echo:M109 ignored: S400 is out of range (0 to 285), stays 30");
    assert!(!heard.iter().any(|line| line.contains(" W:")), "{heard:?}");
    assert!(heard.last().unwrap().contains(" /30.00"), "{heard:?}");
}

#[test]
fn a_wait_tells_temperatures_every_second_and_ends_after_the_residency() {
    let heard = talk(&machine(&[Heater::Bed]), 8000, &["M190 S25.5", "M190", "M190 S10", "M117"]);
    let told: Vec<_> = heard.iter().filter_map(|line| line.rsplit_once(" W:")).map(|(_, w)| w).collect();
    assert_eq!(told, ["3", "2", "1", "0"], "{heard:?}");
    assert!(heard[0].starts_with(" B:25.0") && heard[0].contains(" /25.50 B@:"), "{heard:?}");
    assert_eq!(heard[heard.len() - 4..], ["ok", "ok", "ok", "ok"]);
}

#[test]
fn m108_ends_a_wait_and_leaves_the_target() {
    let heard = talk(&machine(&[Heater::Bed]), 6000, &["M190 S40", "3000:M108", "M105", "M140 S0"]);
    assert!(heard.iter().any(|line| line.ends_with(" W:?")), "{heard:?}");
    let place = heard.iter().position(|line| line == "ok").unwrap();
    assert!((3..=4).contains(&place) && heard[place + 2].contains(" /40.00 "), "{heard:?}");
}

#[test]
fn m410_ends_a_wait_and_leaves_the_target() {
    let heard = talk(&machine(&[Heater::Bed]), 6000, &["M190 S40", "3000:M410", "M105", "M140 S0"]);
    assert!(heard.iter().any(|line| line.starts_with("ok") && line.contains(" /40.00 ")), "{heard:?}");
}

#[test]
fn moves_go_on_while_a_command_waits_for_heat() {
    let lines = ["G1 X110 F6000", "G1 X120", "M190 S40", "2000:M108", "M114 R", "M140 S0"];
    let heard = talk(&machine(&[Heater::Bed]), 3000, &lines);
    assert!(heard.iter().any(|line| line.starts_with("X:120.00 ")), "{heard:?}");
}

#[test]
fn a_wait_for_cooling_ends_when_nothing_cools() {
    let heard = talk(&machine(&[Heater::Bed]), 62_000, &["M190 R20", "M118 over"]);
    let lines = heard.iter().filter(|line| line.ends_with(" W:?")).count();
    assert!((60..=62).contains(&lines) && has(&heard, "over"), "{lines}");
}

/// A cartridge that is open.
#[test]
fn a_fault_halts_the_machine_in_words_that_hosts_know() {
    let break_it = |_: u64, world: &mut World<'_>| {
        if let Some(plant) = world.heat().plant() {
            plant.faults().hotend_heater = HeaterFault::OPEN;
        }
    };
    let (heard, _) = talk_with(&machine(&[Heater::Hotend]), NoStorage, 60_000, &["M109 S200"], break_it);
    let [.., fault, halted] = heard.as_slice() else { panic!("{heard:?}") };
    assert!(fault.starts_with("Error:hotend: heating failed"), "{heard:?}");
    assert_eq!(halted, "Error:Printer halted. kill() called! Send M999 or reset");
    assert!(!has(&heard, "ok"), "{heard:?}");
}

#[test]
fn a_hotend_and_a_bed_are_heated_and_waited_for() {
    let lines = ["M140 S60", "M104 S205", "M190 S60", "M109 S205", "M105", "M140 S0", "M109 R100", "M105"];
    let mut fans = [0; 3];
    let look = |_: u64, world: &mut World<'_>| fans = [0, 1, 2].map(|fan| world.status().heat().fan(fan));
    let (heard, outcome) = talk_with(&machine(&[Heater::Hotend, Heater::Bed]), NoStorage, 700_000, &lines, look);
    let reports: Vec<_> = heard.iter().filter(|line| line.starts_with("ok T:")).collect();
    assert_eq!(reports.len(), 2, "{:?}", heard.last());
    let temperature = |report: &str, letter: &str| -> f64 {
        let (_, rest) = report.split_once(letter).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    assert!((temperature(reports[0], "T:") - 205.0).abs() < 1.5 && (temperature(reports[0], "B:") - 60.0).abs() < 1.5);
    assert!((temperature(reports[1], "T:") - 100.0).abs() < 3.5, "{}", reports[1]);
    assert_eq!((fans, outcome.halted), ([0, 65_535, 65_535], false), "fans of hotend and controller run");
}

#[test]
fn m112_switches_heaters_off() {
    let mut seen = (false, false);
    let (heard, _) =
        talk_with(&machine(&[Heater::Hotend]), NoStorage, 3000, &["M106", "M104 S200", "2000:M112"], |now, world| {
            let heat = world.status().heat();
            seen.0 |= now < 2000 && heat.target(Heater::Hotend) == Celsius::from_num(200);
            seen.1 |= now > 2100 && heat.target(Heater::Hotend) > Celsius::ZERO;
        });
    assert_eq!(seen, (true, false), "{heard:?}");
}

#[test]
fn heaters_that_nobody_uses_go_off_also_while_the_user_is_waited_for() {
    let mut settings = machine(&[Heater::Bed]);
    settings.thermal.idle_min = 1;
    let told = "echo:Heaters off after 1 minutes without use";
    let bed = |heard: &[String]| heard.iter().rfind(|line| line.starts_with("ok B:")).cloned().unwrap();
    // Colder than the room: a constant reading is not a fault then.
    let heard = talk(&settings, 63_000, &["M140 S20", "62000:M105"]);
    assert!(has(&heard, told) && bed(&heard).contains(" /0.00 "), "{heard:?}");
    // A user who comes back finds the bed as it was.
    let heard = talk(&settings, 70_000, &["M140 S20", "M0", "62000:M108", "M105"]);
    assert!(has(&heard, told) && has(&heard, "echo:Heating again"), "{heard:?}");
    assert!(bed(&heard).contains(" /20.00 "), "{heard:?}");
    // Motion is use.
    let heard = talk(&settings, 63_000, &["M140 S20", "G1 X110 F6000", "30000:G1 X100", "62000:M105"]);
    assert!(!has(&heard, told) && bed(&heard).contains(" /20.00 "), "{heard:?}");
}

#[test]
fn no_filament_moves_while_the_hotend_is_cold() {
    let told = "echo: cold extrusion prevented";
    let settings = machine(&[Heater::Hotend]);
    // Nothing of this prints: a printing host is held (`paused/`).
    let lines = [
        "G1 X110 F6000",
        "G1 E5 F600",
        "G1 Z49 E9",
        "G1 Z50",
        "G2 X120 I5",
        "G1 E12",
        "G10",
        "G11",
        "G92 E9",
        "M400",
        "M114",
    ];
    let (heard, outcome) = talk_with(&settings, NoStorage, 8000, &lines, |_, _| {});
    assert_eq!((outcome.counts[6], outcome.counts[0].abs() > 0), (0, true));
    assert_eq!(heard.iter().filter(|line| *line == told).count(), 1, "{heard:?}");
    assert!(has(&heard, "X:120.00 Y:100.00 Z:50.00 E:9.00 C:0.00 Count A:17600 B:1600 Z:40000"), "{heard:?}");
    let (_, outcome) = talk_with(&settings, NoStorage, 8000, &[&["M302 P1"], lines.as_slice()].concat(), |_, _| {});
    assert_eq!(outcome.counts[6], 12 * 400, "with leave it moves");
    for lines in [["M302 P1", "M302"], ["M302 S0", "M302"]] {
        let heard = talk(&settings, 1000, &lines);
        assert!(heard[1].starts_with("echo:Cold extrudes are enabled (min temp "), "{heard:?}");
    }
    let heard = talk(&settings, 1000, &["M302", "M302 S180", "M302", "M302 S999"]);
    assert_eq!(heard[0], "echo:Cold extrudes are disabled (min temp 170C)");
    assert!(has(&heard, "echo:Cold extrudes are disabled (min temp 180C)"), "{heard:?}");
    assert!(has(&heard, "echo:M302 ignored: S999 is out of range (0 to 285), stays 180"), "{heard:?}");
}

#[test]
fn settings_of_heaters_are_said_as_the_lines_that_set_them() {
    let settings = machine(&[Heater::Hotend, Heater::Bed]);
    let changes = ["M301 P10 I.5 D40", "M306 E-1 P400 C1500 A3 F3.5 R.25 L8", "M302 S180", "M710 S128 D30"];
    let report = |lines: &[&str]| {
        let heard = talk(&settings, 4000, &[lines, &["M503"]].concat());
        let said = heard.iter().filter_map(|line| line.strip_prefix("echo:  M"));
        said.filter(|line| ["301", "304", "306", "302", "710"].iter().any(|code| line.starts_with(code)))
            .map(|line| format!("M{line}"))
            .collect::<Vec<_>>()
    };
    let once = report(&changes);
    assert_eq!(
        once,
        [
            "M306 E0 P40 C10.8 A0.075 F0.125 R0.83333 L1.2 H0.0056",
            "M301 P10 I0.5 D40",
            "M304 P120 I1 D600",
            "M306 P400 C1500 A3 F3.5 R0.25 L8 H0.0056 E-1",
            "M302 S180",
            "M710 S128 D30",
        ]
    );
    let lines: Vec<&str> = once.iter().map(String::as_str).collect();
    assert_eq!(report(&lines), once);
    for line in ["M301", "M304", "M306 E-1"] {
        assert!(talk(&settings, 500, &[line])[0].starts_with("  M30"), "{line}");
    }
}

/// Reproducer: M306 took any capacity and loss for any heater, and without E it took the hotend without a word.
#[test]
fn a_model_that_no_such_heater_has_is_refused_and_the_heater_is_named() {
    let settings = machine(&[Heater::Hotend, Heater::Bed]);
    for (line, told) in [
        ("M306 E0 P40 C200", "echo:M306 ignored: C200 is out of range (1 to 66.6"),
        ("M306 E0 A3.5", "echo:M306 ignored: A3.5 is out of range (0.01 to 0.4), stays 0.075"),
        ("M306 E0 P1", "echo:M306 ignored: P1 is out of range (5 to 200), stays 40"),
        ("M306 E0 L80", "echo:M306 ignored: L80 is out of range (0.1 to 60), stays 1.2"),
        ("M306 E-1 C10.8", "echo:M306 ignored: C10.8 is out of range (100 to 2"),
        ("M306 E0 P5", "echo:M306 ignored: this model does not fit this power, set P, C, A, F, R and L in one line"),
    ] {
        let heard = talk(&settings, 1000, &[line, "M306 E0", "M306 E-1"]);
        assert!(heard[0].starts_with(told), "{line}: {heard:?}");
        let has_model = |model: &str| heard.iter().any(|said| said.contains(model));
        assert!(has_model("P40 C10.8 A0.075 F0.125 R0.83333 L1.2 H0.0056"), "{line}: {heard:?}");
        assert!(has_model("P500 C1700 A3.5 F3.5 R0.2 L10 H0.0056"), "{line}: {heard:?}");
    }
    let named = "echo:M306 without E is the hotend's (E0); E-1 is the bed, E-2 the chamber";
    assert_eq!(talk(&settings, 500, &["M306 C12"])[..2], [named, "ok"]);
    assert_eq!(talk(&settings, 500, &["M306 E0 C12"])[0], "ok");
    // A heavy block of 25 W, in one line.
    assert_eq!(talk(&settings, 500, &["M306 E0 P25 C34 A.08 F.12"])[0], "ok");
}

/// Reproducer: the second heating to the same target ended in E09.
#[test]
fn nearly_every_second_print_heats_to_the_same_target_again() {
    let lines = ["M109 S210", "M104 S0", "G4 S20", "M109 S210", "M104 S0", "G4 S60", "M140 S60", "M109 S210", "M105"];
    let heard = talk(&machine(&[Heater::Hotend, Heater::Bed]), 400_000, &lines);
    assert!(!heard.iter().any(|line| line.starts_with("Error:")), "{heard:?}");
    assert!(heard.last().unwrap().contains(" /210.00 "), "{heard:?}");
}

#[test]
fn diagnosis_has_the_fault_and_the_heaters() {
    let heard = talk(&machine(&[Heater::Bed]), 3000, &["M122"]);
    assert!(has(&heard, "echo:fault: none"), "{heard:?}");
    assert!(
        heard.iter().any(|line| line.starts_with("echo:heater bed 2") && line.ends_with(" C, target 0.00 C, duty 0 %")),
        "{heard:?}"
    );
}

/// On 6f0e814, it gave 130 J/K for a hotend of 10.8.
#[test]
fn a_tuning_of_a_hot_hotend_cools_it_first_and_says_so() {
    let heard = talk(&machine(&[Heater::Hotend]), 420_000, &["M109 S215", "M303 E0 S215 C3", "M105"]);
    assert!(has(&heard, "echo:too hot to begin, it cools first; M108 ends this wait"), "{heard:?}");
    let found = heard.iter().find_map(|line| line.strip_prefix("echo:hotend: ")?.split_once(" J/K"));
    let capacity: f64 = found.unwrap().0.parse().unwrap();
    assert!((capacity - 10.8).abs() < 1.0, "{capacity}");
    // So near to the room's temperature nothing swings.
    let heard = talk(&machine(&[Heater::Bed]), 1000, &["M303 E-1 S25 C3", "M105"]);
    assert_eq!(heard[0], "echo:M303 ignored: S is the temperature to tune at, 40 or more");
}

#[test]
fn a_tuning_without_swings_is_ended_by_m108_and_leaves_the_heater_off() {
    let heard = talk(&machine(&[Heater::Bed]), 6000, &["M303 E-1 S40", "3000:M108", "M105"]);
    assert!(has(&heard, "PID Autotune start"), "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("PID Autotune failed!")), "{heard:?}");
    assert!(heard.last().unwrap().contains(" /0.00 "), "{heard:?}");
}
