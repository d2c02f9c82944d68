//! Stops: M112, M410 and M108 in mid-move and in waits.

use super::talk::{talk, talk_to};
use corehbot::settings::Settings;

#[test]
fn an_emergency_stop_stops_in_mid_move() {
    let (heard, outcome, steps) = talk(&["G1 X300 F3000", "!G1 X0", "!M112"]);
    assert!(outcome.halted);
    let halted = "Error:Printer halted. kill() called! Send M999 or reset";
    assert_eq!(heard.iter().filter(|line| *line == halted).count(), 1, "one message is enough: {heard:?}");
    assert!(steps.count < 100, "{} steps after the stop", steps.count);
}

#[test]
fn a_quick_stop_keeps_the_position_true() {
    let lines = ["G1 X200 F1200", "!G1 X0", "!G4 S1", "!M410", "M114 R", "M114", "G1 X10 F6000", "M400", "M114 R"];
    let (heard, outcome, _) = talk(&lines);
    assert!(!outcome.halted);
    assert_eq!(heard.iter().filter(|l| *l == "ok").count(), lines.len(), "{heard:?}");
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("X:")).collect();
    assert_eq!(told[0], told[1], "what is commanded is what is");
    assert!(told[2].starts_with("X:10.00 "), "{told:?}");
    assert_eq!(outcome.counts[3], 800, "ten millimetres from the origin, counted in steps");
}

#[test]
fn m108_ends_a_dwell() {
    let (_, long, _) = talk(&["G4 S20", "G1 X1 F600", "M400"]);
    let (heard, short, _) = talk(&["G4 S20", "~M108", "G1 X1 F600", "M400"]);
    assert!(long.ticks > 200_000_000);
    assert!(short.ticks < 40_000_000, "{} ticks", short.ticks);
    assert_eq!(heard.iter().filter(|l| *l == "ok").count(), 4);
}

#[test]
fn m108_in_the_same_packet_ends_a_dwell_too() {
    let (heard, outcome, _) = talk(&["G4 S20", "!M108", "G1 X1 F600", "M400"]);
    assert!(outcome.ticks < 10_000_000, "{} ticks", outcome.ticks);
    assert_eq!(heard.iter().filter(|l| *l == "ok").count(), 4);
}

#[test]
fn a_quick_stop_forgets_lines_that_came_before_it() {
    let (heard, outcome, _) = talk(&["G1 X50 F6000", "!G1 X100", "!G1 E5", "!M410", "!G1 Y5", "M400"]);
    assert_eq!(heard.iter().filter(|l| *l == "ok").count(), 6, "{heard:?}");
    assert_eq!(outcome.moves, 1, "only the line after the stop is carried out");
    assert_eq!((outcome.counts[3], outcome.counts[6]), (400, 0));
}

#[test]
fn a_machine_that_was_stopped_hundreds_of_times_still_moves() {
    let stops = ["M410"; 300];
    let lines: Vec<&str> = ["G28 X"].into_iter().chain(stops).chain(["G1 X10 F6000", "M400", "M114 R"]).collect();
    let (heard, ..) = talk_to(&Settings::prototype(), Some([5.0, 0.0, 0.0]), &lines);
    assert!(heard.iter().any(|l| l.starts_with("X:10.00 ")), "{:?}", heard.last());
}

#[test]
fn a_quick_stop_while_homing_says_what_is_lost() {
    let (heard, outcome, _) = talk_to(&Settings::prototype(), Some([300.0, 0.0, 0.0]), &["G28 X", "~M410", "M119"]);
    assert!(!outcome.halted);
    assert!(
        heard.contains(&"echo:homing was interrupted, the position of the axis is unknown".to_owned()),
        "{heard:?}"
    );
}

#[test]
fn a_pause_longer_than_the_clock_wraps_does_not_starve_what_follows() {
    let moves: Vec<String> = (1..20).map(|i| format!("!G1 X{} F12000", i * 15)).collect();
    let lines: Vec<&str> = ["G4 S600"].into_iter().chain(moves.iter().map(String::as_str)).collect();
    let (_, outcome, _) = talk(&lines);
    assert_eq!(outcome.underruns, 0);
}
