//! The height of the first layer over the lives of a machine: shifted, kept, stored, forgotten.

use super::talk::{keep, talk, talk_to};
use corehbot::settings::Settings;
use corehbot_sim::eeprom::Eeprom;

fn said<'h>(heard: &'h [String], begin: &str) -> Vec<&'h str> {
    heard.iter().filter(|line| line.starts_with(begin)).map(String::as_str).collect()
}

#[test]
fn shifts_add_up_to_decimals() {
    let lines = ["G28", "M290 Z0.05", "M290 Z0.05", "M290 Z0.05", "M290", "M290 Z-0.025", "M290 Z0.0125", "M290"];
    let (heard, ..) = talk(&lines);
    let news = ", not saved: M500 keeps it";
    let expected = [format!("echo:Z offset 0.15{news}"), format!("echo:Z offset 0.1375{news}")];
    assert_eq!(said(&heard, "echo:Z offset"), expected);
}

/// Steps of z from its switch, where it stood at the start.
const fn z_of(outcome: &corehbot_sim::world::Outcome) -> i32 {
    outcome.counts[4]
}

#[test]
fn what_is_stored_holds_after_power_off_and_what_is_not_is_gone() {
    let (made, mut eeprom) = (Settings::prototype(), Eeprom::blank());
    let (heard, ..) = keep(&mut eeprom, &made, &["M290 Z0.05", "M84", "M84", "M290"]);
    let told = "echo:the offset of Z is not saved: M500 keeps it";
    assert_eq!(said(&heard, told).len(), 1, "told once: {heard:?}");
    assert_eq!(said(&heard, "echo:Z offset"), ["echo:Z offset 0.05, not saved: M500 keeps it"]);
    let (heard, ..) = keep(&mut eeprom, &made, &["M290", "M290 Z-0.075", "M290 Z.025", "M500", "M84", "M290"]);
    assert_eq!(said(&heard, "echo:Z offset"), ["echo:Z offset 0", "echo:Z offset -0.05"]);
    assert!(said(&heard, told).is_empty());
    // Off and on: the switch is 0.05 mm above the place that the program calls 0.
    let lines = ["M290", "G28 Z", "M114", "G1 Z0.2 F600", "M114", "M290 Z0.1", "M501", "M114", "M290", "M503"];
    let (heard, outcome, _) = keep(&mut eeprom, &made, &lines);
    let kept = ["echo:Z offset -0.05", "echo:Z offset -0.05"];
    assert_eq!(said(&heard, "echo:Z offset"), kept, "{heard:?}");
    let places: Vec<&str> = said(&heard, "X:").iter().map(|line| line.split(' ').nth(2).unwrap()).collect();
    // The last shift is not stored: M501 gives the place its stored name.
    assert_eq!(places, ["Z:0.05", "Z:0.20", "Z:0.30"], "{heard:?}");
    assert_eq!(z_of(&outcome), 200, "0.25 mm above the switch");
    assert!(said(&heard, "echo:; SET_GCODE_OFFSET Z=").contains(&"echo:; SET_GCODE_OFFSET Z=-0.05"), "{heard:?}");
    // M502 and M500 forget it.
    let (heard, ..) = keep(&mut eeprom, &made, &["M502", "M290", "M500", "M290"]);
    assert_eq!(said(&heard, "echo:Z offset"), ["echo:Z offset 0, not saved: M500 keeps it", "echo:Z offset 0"]);
}

#[test]
fn the_same_file_twice_prints_at_the_same_height() {
    let file = ["G28", "G1 Z0.2 F600", "M290 Z0.05", "M400"];
    let (_, once, _) = talk(&file);
    assert_eq!(z_of(&once), 200);
    let (_, twice, _) = talk(&[&file[..], &["G28", "G1 Z0.2 F600", "M400"]].concat());
    assert_eq!(z_of(&twice), 200);
    // Without keeping it, homing forgets it.
    let lines = ["M290 Z0.1 P0", "M290", "G28 Z", "M290", "G1 Z0.2 F600", "M400"];
    let (heard, outcome, _) = talk(&lines);
    assert_eq!(z_of(&outcome), 160);
    assert_eq!(said(&heard, "echo:Babystep"), ["echo:Babystep Z0.10", "echo:Babystep Z0.00"]);
    assert_eq!(said(&heard, "echo:Z offset"), ["echo:Z offset 0"; 2]);
}

#[test]
fn an_offset_in_klippers_words_is_the_same_offset() {
    let lines = [
        "G28 Z",
        "SET_GCODE_OFFSET Z=0.1",
        "M114",
        "G1 Z0.2 F600",
        "SET_GCODE_OFFSET Z=0.1",
        "SET_GCODE_OFFSET Z=0.1 MOVE=1",
        "M400",
        "M114",
        "SET_GCODE_OFFSET Z_ADJUST=-0.05 MOVE=1",
        "M400",
        "M114",
        "M290",
    ];
    let (heard, outcome, _) = talk(&lines);
    let places: Vec<&str> = said(&heard, "X:").iter().map(|line| line.split(' ').nth(2).unwrap()).collect();
    assert_eq!(places, ["Z:-0.10", "Z:0.20", "Z:0.20"], "{heard:?}");
    assert_eq!(z_of(&outcome), 200);
    assert_eq!(said(&heard, "echo:Z offset"), ["echo:Z offset 0.05, not saved: M500 keeps it"]);
    // The next homing gives the same place.
    let (_, again, _) = talk(&[&lines[..], &["G28 Z", "G1 Z0.2 F600", "M400"]].concat());
    assert_eq!(z_of(&again), 200);
}

#[test]
fn z_stays_on_its_axis_and_goes_down_to_the_bed() {
    let high = Some([0.0, 0.0, 334.9]);
    let lines = ["M290 Z0.2", "M290 Z0.05", "G1 Z335 F600", "M400", "M114"];
    let (heard, ..) = talk_to(&Settings::prototype(), high, &lines);
    assert_eq!(said(&heard, "echo:ignored"), ["echo:ignored: Z would leave its axis"]);
    assert!(heard.iter().any(|line| line.starts_with("X:0.00 Y:0.00 Z:334.95")), "{heard:?}");
    // The bed is lower than the switch says: the nozzle follows.
    let (heard, outcome, _) = talk(&["G28 Z", "M290 Z-0.1", "G1 Z1 F600", "G1 Z0", "M400", "M114"]);
    assert_eq!(z_of(&outcome), -80, "{heard:?}");
    assert!(said(&heard, "echo:target").is_empty());
    // A sum beyond 5 mm is refused.
    let lines = ["G1 Z9 F600", "M290 Z-2", "M290 Z-2", "M290 Z-2", "M400", "M290"];
    let (heard, outcome, _) = talk(&lines);
    assert_eq!(said(&heard, "echo:ignored"), ["echo:ignored: the offset of Z would be out of range (-5 to 5 mm)"]);
    assert_eq!(z_of(&outcome), 9 * 800 - 3200);
}

#[test]
fn home_offsets_count_from_homing_on_and_are_kept() {
    let (made, mut eeprom) = (Settings::prototype(), Eeprom::blank());
    let lines = ["M206 Z0.5", "M114", "G1 Z1 F600", "G28 Z", "M114", "G1 Z1 F600", "M500"];
    let (heard, outcome, _) = keep(&mut eeprom, &made, &lines);
    let z = |heard: &[String]| -> Vec<String> {
        said(heard, "X:").iter().map(|line| line.split(' ').nth(2).unwrap().to_owned()).collect()
    };
    assert_eq!((z(&heard), z_of(&outcome)), (vec!["Z:0.50".to_owned(); 2], 400));
    let (heard, outcome, _) = keep(&mut eeprom, &made, &["M114", "M206", "G28", "M114", "G92 Z0", "G28 Z", "M114"]);
    assert_eq!((z(&heard), z_of(&outcome)), (vec!["Z:0.50".to_owned(); 3], 0), "{heard:?}");
    assert!(heard.contains(&"  M206 X0 Y0 Z0.5".to_owned()), "{heard:?}");
}

#[test]
fn the_present_place_becomes_the_place_of_the_switches() {
    let (heard, ..) = talk(&["G1 X15 Y5 Z3 F6000", "M428", "M206", "G28", "M114", "G1 X5 Y-5", "M428", "M206"]);
    assert_eq!(said(&heard, "  M206"), ["  M206 X-15 Y-5 Z-3", "  M206 X-20 Y0 Z0"].as_slice().to_vec(), "{heard:?}");
    let places = said(&heard, "X:");
    assert!(places[0].starts_with("X:0.00 Y:0.00 Z:0.00"), "{places:?}");
    assert!(places[1].starts_with("X:-15.00 Y:-5.00 Z:-3.00"), "{places:?}");
    let (heard, ..) = talk(&["G1 X21 F6000", "M428", "M84", "M428", "M206"]);
    let refused = ["echo:Too far from reference point", "echo:M428 ignored: home first (G28)"];
    assert_eq!([said(&heard, "echo:Too")[0], said(&heard, "echo:M428")[0]], refused);
    assert_eq!(said(&heard, "  M206"), ["  M206 X0 Y0 Z0"]);
}
