//! Conversations with the whole firmware: what a host says, and what it hears.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::MotorSet;
use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Host, Outcome, Sink, run, run_with};
use proptest::prelude::*;
use std::collections::VecDeque;

#[derive(Default)]
struct Steps {
    count: u64,
    last: u64,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, _steps: MotorSet, _forward: MotorSet) {
        self.count += 1;
        self.last = tick;
    }
}

/// Sends each line when the one before is answered; a line that begins with `!` goes out together with the
/// one before it, and one that begins with `~` when the printer has said that it is busy with that.
struct Talk {
    lines: VecDeque<String>,
    awaiting: u32,
    heard: Vec<String>,
    is_busy: bool,
}

impl Talk {
    fn new(lines: &[&str]) -> Self {
        let lines = lines.iter().map(|l| (*l).to_owned()).collect();
        Self { lines, awaiting: 0, heard: Vec::new(), is_busy: false }
    }
}

impl Host for Talk {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 {
            return;
        }
        if let Some(line) = self.lines.pop_front() {
            out.extend(line.as_bytes());
            out.push(b'\n');
            self.awaiting += 1;
            self.is_busy = false;
        }
        while self.lines.front().is_some_and(|l| l.starts_with('!')) {
            let line = self.lines.pop_front().unwrap();
            out.extend(&line.as_bytes()[1..]);
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.is_busy && self.lines.front().is_some_and(|l| l.starts_with('~')) {
            let line = self.lines.pop_front().unwrap();
            out.extend(&line.as_bytes()[1..]);
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.is_busy |= line.starts_with("echo:busy");
        if line.starts_with("ok") {
            self.awaiting = self.awaiting.saturating_sub(1);
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && self.awaiting == 0
    }
}

const HOMED: Option<[f64; 3]> = Some([0.0; 3]);

fn talk_to(settings: &Settings, start: Option<[f64; 3]>, lines: &[&str]) -> (Vec<String>, Outcome, Steps) {
    let mut host = Talk::new(lines);
    let mut steps = Steps::default();
    let start = start.map(|s| s.map(Mm::from_num));
    let outcome = run(settings, start, &mut host, &mut steps).unwrap();
    // The banner is not an answer.
    let heard = host.heard.into_iter().skip(2).collect();
    (heard, outcome, steps)
}

/// What a homed machine at the origin answers, and how it ends.
fn talk(lines: &[&str]) -> (Vec<String>, Outcome, Steps) {
    talk_to(&Settings::prototype(), HOMED, lines)
}

#[test]
fn every_line_has_one_ok_and_blank_lines_have_none() {
    let (heard, ..) = talk(&["G21", "M105", "G1 X5 F6000", "FOO", "T0", "T3", "M117 hello *", "G4 P1", "M400"]);
    assert_eq!(heard.iter().filter(|l| l.starts_with("ok")).count(), 9);
    assert!(heard.contains(&"echo:Unknown command: \"FOO\"".to_owned()), "{heard:?}");
    assert!(heard.iter().any(|l| l.starts_with("ok T:")), "{heard:?}");
}

#[test]
fn an_advanced_ok_tells_line_and_room() {
    let mut settings = Settings::prototype();
    settings.advanced_ok = true;
    let (heard, ..) = talk_to(&settings, HOMED, &["N1 G90*17", "M82", "N2 *92", "M110", "N3 G1 X5*1"]);
    assert_eq!(heard[..3], ["ok N1 P144 B10", "ok P144 B10", "ok N2 P144 B10"]);
    assert_eq!(heard[3..5], ["Line: 2", "ok"]);
    assert!(heard[5].starts_with("Error:checksum"), "{heard:?}");
}

#[test]
fn the_position_is_told_as_asked_and_as_it_is() {
    let (heard, ..) = talk(&["G1 X10 Y20.004 Z1 E2 F6000", "M400", "M114", "M114 R", "G92 X0 E0", "M114"]);
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("X:")).collect();
    assert_eq!(told[0], "X:10.00 Y:20.00 Z:1.00 E:2.00 Count A:2400 B:-800 Z:800");
    assert_eq!(told[1], told[0]);
    assert_eq!(told[2], "X:0.00 Y:20.00 Z:1.00 E:0.00 Count A:2400 B:-800 Z:800");
}

#[test]
fn real_position_lags_while_moving() {
    let (heard, ..) = talk(&["G1 X100 F600", "M114", "M114 R", "M400", "M114 R"]);
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("X:")).collect();
    assert!(told[0].starts_with("X:100.00 "));
    assert!(!told[1].starts_with("X:100.00 "), "{told:?}");
    assert!(told[2].starts_with("X:100.00 "));
}

#[test]
fn settings_that_are_reported_read_back() {
    let changes = [
        "M92 Z1600.5 E415.37",
        "M203 X250.3 Y200 Z12.7 E61",
        "M201 X4321 Y1234.5 Z150 E9000",
        "M204 P1500.25 R2500 T4000",
        "M205 X7.5 Y9 E3.3 S1 T2",
        "M593 X F60.7 D0.055 T2",
        "M593 Y F41.3 T4",
        "M900 K0.0123",
        "M572 W0.033",
        "M207 S1.25 F1800 Z0.4",
        "M208 S0.05 F600",
        "M211 S0",
        "M113 S5",
        "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.37",
        "M569 S1 X",
        "M906 Y905 E650",
        "M913 X120.5 Z20",
        "M914 X70 Z60",
        "M503",
    ];
    let (heard, ..) = talk(&changes);
    let report: Vec<String> = heard.iter().filter_map(|l| l.strip_prefix("echo:  ")).map(str::to_owned).collect();
    assert_eq!(report.len(), 21, "{heard:?}");
    assert!(report.contains(&"M113 S5".to_owned()) && report.contains(&"M211 S0".to_owned()));
    let mut again: Vec<&str> = report.iter().map(String::as_str).collect();
    again.push("M503");
    let (heard, ..) = talk(&again);
    let second: Vec<_> = heard.iter().filter_map(|l| l.strip_prefix("echo:  ")).collect();
    assert_eq!(report, second);
    // And a machine that was told nothing reports something else.
    let (heard, ..) = talk(&["M503"]);
    assert!(heard.contains(&"echo:  M205 J0.013 E5 S0 T0".to_owned()), "{heard:?}");
}

#[test]
fn a_target_beyond_the_edge_is_told_once_a_print() {
    let lines = ["G1 X500 F12000", "G1 X600", "G1 Y-5", "M400", "M114", "G28 X", "G1 X500", "M400"];
    let (heard, ..) = talk(&lines);
    assert_eq!(heard.iter().filter(|l| l.contains("beyond the reachable space")).count(), 2, "{heard:?}");
    assert!(heard.iter().any(|l| l.starts_with("X:390.00 Y:0.00")), "{heard:?}");
    let (heard, ..) = talk(&["M211", "M211 S0", "G1 X400 F12000", "M400", "M114 R"]);
    assert!(heard[0].starts_with("Soft endstops: ON  Min:  X0.00 Y0.00 Z0.00   Max:  X390.00 Y417.60 Z335.00"));
    assert!(heard.iter().any(|l| l.starts_with("X:400.00")), "{heard:?}");
}

#[test]
fn homing_finds_the_switches_through_the_belt() {
    let (heard, outcome, steps) = talk_to(&Settings::prototype(), None, &["G28", "M114", "M119"]);
    assert!(heard.contains(&"X:0.00 Y:0.00 Z:0.00 E:0.00 Count A:0 B:0 Z:0".to_owned()), "{heard:?}");
    for line in ["Reporting endstop status", "x_min: TRIGGERED", "y_min: TRIGGERED", "z_min: TRIGGERED"] {
        assert!(heard.contains(&line.to_owned()), "{line}: {heard:?}");
    }
    // It takes seconds, so the host hears that somebody is busy.
    assert!(heard.iter().filter(|l| *l == "echo:busy: processing").count() >= 3, "{heard:?}");
    assert!(steps.count > 10_000 && !outcome.halted);
    let [n1, n4, n8, n11, ..] = outcome.counts;
    assert_eq!((n1, n4), (-n8, -n11));
}

#[test]
fn one_axis_is_homed_alone_and_keeps_the_others() {
    let (heard, ..) = talk(&["G1 X30 Y40 Z5 F6000", "G28 Y", "M114", "M119"]);
    assert!(heard.iter().any(|l| l.starts_with("X:30.00 Y:0.00 Z:5.00")), "{heard:?}");
    assert!(heard.contains(&"x_min: open".to_owned()) && heard.contains(&"y_min: TRIGGERED".to_owned()));
}

#[test]
fn a_missing_switch_halts_the_machine() {
    // The machine stands farther from the switch than its axis is long.
    let mut settings = Settings::prototype();
    settings.axes.x.length = Mm::from_num(20);
    let (heard, outcome, _) = talk_to(&settings, Some([100.0, 0.0, 0.0]), &["G28 X", "G1 X5"]);
    assert!(outcome.halted);
    assert!(heard.contains(&"Error:Homing failed: X endstop not found".to_owned()), "{heard:?}");
    assert!(heard.contains(&"Error:Printer halted. kill() called! Send M999 or reset".to_owned()), "{heard:?}");
    assert!(!heard.iter().any(|l| l.starts_with("ok")));
}

#[test]
fn an_emergency_stop_stops_in_mid_move() {
    let (heard, outcome, steps) = talk(&["G1 X300 F3000", "!G1 X0", "!M112"]);
    assert!(outcome.halted);
    assert!(heard.contains(&"Error:Printer halted. kill() called! Send M999 or reset".to_owned()), "{heard:?}");
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
    assert!(heard.contains(&"echo:homing was ended, the axis has no known position".to_owned()), "{heard:?}");
}

#[test]
fn a_pause_longer_than_the_clock_wraps_does_not_starve_what_follows() {
    let moves: Vec<String> = (1..20).map(|i| format!("!G1 X{} F12000", i * 15)).collect();
    let lines: Vec<&str> = ["G4 S600"].into_iter().chain(moves.iter().map(String::as_str)).collect();
    let (_, outcome, _) = talk(&lines);
    assert_eq!(outcome.underruns, 0);
}

#[test]
fn a_feed_rate_alone_moves_nothing_and_homing_counts_only_the_way_made() {
    let (_, outcome, _) = talk(&["G1 F3000", "M400"]);
    assert_eq!((outcome.moves, outcome.path_um), (0, 0));
    let (_, outcome, steps) = talk(&["G28"]);
    let way = outcome.path_um as f64 / 1000.0;
    assert!((20.0..30.0).contains(&way), "{way} mm in {} events", steps.count);
}

/// Reproducer: the Console rounded half a step away from zero, the generator upwards, so a machine that began at
/// v = -1/2 was one step off from then on.
#[test]
fn a_machine_that_begins_on_half_a_step_is_not_a_step_off() {
    let mut settings = Settings::prototype();
    settings.axes.x.steps_per_mm = 64u16.into();
    settings.axes.y.steps_per_mm = 64u16.into();
    let start = Some([0.0, 0.5 / 64.0, 0.0]);
    let (heard, ..) = talk_to(&settings, start, &["G1 X10 Y10 F6000", "M400", "M114 R"]);
    assert!(heard.contains(&"X:10.00 Y:10.00 Z:0.00 E:0.00 Count A:1280 B:0 Z:0".to_owned()), "{heard:?}");
}

#[test]
fn a_bad_line_costs_a_resend_and_nothing_else() {
    let sum = |text: &str| format!("{text}*{}", text.bytes().fold(0, |a, b| a ^ b));
    let lines = [sum("N0 M110 N0"), sum("N1 G1 X10 F6000"), "N2 G1 X20*1".to_owned(), sum("N2 G1 X20"), sum("N3 M400")];
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (heard, outcome, _) = talk(&lines);
    let dialogue = ["Error:checksum mismatch, Last Line: 1", "Resend: 2", "ok"];
    assert!(heard.windows(3).any(|w| w == dialogue), "{heard:?}");
    assert_eq!(outcome.counts[3], 1600);
}

#[test]
fn heaters_are_missed_once() {
    let (heard, ..) = talk(&["M104 S200", "M140 S60", "M109 S200", "M106 S255"]);
    assert_eq!(heard, ["echo:no heaters configured", "ok", "ok", "ok", "ok"]);
}

#[test]
fn motors_without_power_do_not_know_where_they_are() {
    let (heard, ..) = talk(&["G1 X500 F12000", "M84", "G1 X600", "M400", "M114"]);
    // The first target is clamped; after M84 the axis has no known edge.
    assert!(heard.iter().any(|l| l.starts_with("X:600.00")), "{heard:?}");
}

#[test]
fn inches_relative_moves_and_overrides_mean_what_they_say() {
    let lines = [
        "G20",
        "G1 X1 F100",
        "G21",
        "G91",
        "G1 X1 E1 F6000",
        "G90",
        "M83",
        "M400",
        "M221 S200",
        "G1 E1",
        "M400",
        "M114",
    ];
    let (heard, outcome, _) = talk(&lines);
    assert!(heard.iter().any(|l| l.starts_with("X:26.40 Y:0.00 Z:0.00 E:2.00")), "{heard:?}");
    assert_eq!(outcome.counts[6], 400 + 800, "flow of 200 % for the second millimetre of filament");
    let (heard, ..) = talk(&["M220 S50", "M220", "M220 B", "M220 S120", "M220 R", "M220", "M221"]);
    assert_eq!(heard.iter().filter(|l| *l == "FR:50%").count(), 2, "{heard:?}");
    assert!(heard.contains(&"echo:E0 Flow: 100%".to_owned()));
}

#[test]
fn bad_arcs_move_nothing() {
    let (heard, outcome, _) = talk(&["G2 X10 Y0", "G2 X50 R5", "G3 I0 J0", "M400"]);
    assert_eq!(heard.iter().filter(|l| l.starts_with("echo:arc ignored")).count(), 3, "{heard:?}");
    assert_eq!(outcome.moves, 0);
}

#[test]
fn a_helix_with_turns_ends_where_it_should() {
    let (heard, outcome, _) = talk(&["G1 X50 Y50 F9000", "G3 I10 J0 Z3 P3 E6 F3000", "M400", "M114 R"]);
    assert!(heard.iter().any(|l| l.starts_with("X:50.00 Y:50.00 Z:3.00 E:6.00")), "{heard:?}");
    let path = outcome.path_um as f64 / 1000.0;
    let exact = 50.0 * 2f64.sqrt() + (3.0 * std::f64::consts::TAU * 10.0).hypot(3.0);
    assert!((path - exact).abs() < 0.2, "{path} {exact}");
}

#[test]
fn too_much_filament_in_one_move_is_left_out() {
    let (heard, outcome, _) = talk(&["G1 X10 E99999 F6000", "G1 E100001", "M400"]);
    assert!(heard.contains(&"echo:E left out: more than 1000 mm of filament in one move".to_owned()), "{heard:?}");
    assert_eq!((outcome.counts[3], outcome.counts[6]), (800, 800));
}

#[test]
fn sensors_say_what_they_read_or_that_there_is_nothing() {
    let (heard, ..) = talk(&["M122"]);
    for line in ["echo:sensor bed 62594/65536", "echo:sensor hotend0 62594/65536", "echo:sensor hotend1 -"] {
        assert!(heard.contains(&line.to_owned()), "{heard:?}");
    }
}

/// What a machine with storage says to such lines, greeting apart, but with what it found there at the start.
fn keep(eeprom: &mut Eeprom, settings: &Settings, lines: &[&str]) -> (Vec<String>, Outcome, Steps) {
    let mut host = Talk::new(lines);
    let mut steps = Steps::default();
    let outcome = run_with(settings, HOMED.map(|s| s.map(Mm::from_num)), eeprom, &mut [&mut host], &mut steps).unwrap();
    assert_eq!(host.heard[0], "start");
    (host.heard.into_iter().skip(2).collect(), outcome, steps)
}

/// A reply's words without its size and checksum.
fn words(reply: &str) -> &str {
    reply.split(" (").next().unwrap()
}

const DEFAULTS: &str = "echo:Hardcoded Default Settings Loaded";

#[test]
fn stored_settings_count_after_a_reset() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    let (heard, ..) = keep(&mut eeprom, &made, &["M203 X250.5", "M205 X8", "M113 S7", "M500", "M504"]);
    assert_eq!(heard[0], DEFAULTS);
    let said: Vec<_> = heard.iter().filter(|l| *l != "ok").map(|l| words(l)).collect();
    assert_eq!(said, [DEFAULTS, "echo:Settings Stored", "echo:stored settings valid"]);
    let receipt = |l: &str| l.split_once(" (").unwrap().1.to_owned();
    let stored = heard.iter().find(|l| l.contains("Stored")).unwrap();
    assert_eq!(receipt(stored), receipt(heard.iter().find(|l| l.contains("valid")).unwrap()));

    let (heard, ..) = keep(&mut eeprom, &made, &["M503", "M502", "M503", "M501", "M503"]);
    assert_eq!(heard[0], format!("echo:stored settings retrieved ({}", receipt(stored)));
    let reports: Vec<&[String]> = heard.split(|l| l.contains("ettings")).collect();
    let [_, stored, defaults, loaded] = reports[..] else { panic!("{heard:?}") };
    assert!(stored.contains(&"echo:  M203 X250.5 Y300 Z20 E80".to_owned()), "{heard:?}");
    assert!(stored.contains(&"echo:  M205 X8 Y8 E5 S0 T0".to_owned()), "{heard:?}");
    assert!(stored.contains(&"echo:  M113 S7".to_owned()), "{heard:?}");
    assert!(defaults.contains(&"echo:  M203 X300 Y300 Z20 E80".to_owned()), "{heard:?}");
    assert!(defaults.contains(&"echo:  M205 J0.013 E5 S0 T0".to_owned()), "{heard:?}");
    // The report that ends with the ok of M503, and begins with the ok of M501.
    assert_eq!(&loaded[1..], stored);
}

#[test]
fn the_defaults_are_those_the_machine_was_made_with() {
    let mut made = Settings::prototype();
    made.keepalive_s = 9;
    let (heard, ..) = keep(&mut Eeprom::blank(), &made, &["M113 S1", "M500", "M502", "M113", "M501", "M113"]);
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("echo:M113")).collect();
    assert_eq!(told, ["echo:M113 S9", "echo:M113 S1"]);
}

#[test]
fn settings_that_did_not_change_are_not_written_again() {
    let mut eeprom = Eeprom::blank();
    let (heard, ..) = keep(&mut eeprom, &Settings::prototype(), &["M500", "M500", "M501", "M500"]);
    let receipts: Vec<_> = heard.iter().filter(|l| l.starts_with("echo:Settings Stored (")).collect();
    assert!(receipts.len() == 3 && receipts[0] == receipts[1] && receipts[1] == receipts[2], "{heard:?}");
    let once = eeprom.writes();
    assert!((1..16).contains(&once), "{once} writes");
    keep(&mut eeprom, &Settings::prototype(), &["M92 E415", "M500"]);
    assert_eq!(eeprom.writes(), 2 * once);
}

#[test]
fn without_storage_nothing_is_stored_and_nothing_pretended() {
    let (heard, ..) = talk(&["M115", "M113 S7", "M500", "M501", "M504", "M113", "M502", "M113"]);
    assert!(heard.contains(&"Cap:EEPROM:0".to_owned()), "{heard:?}");
    let said: Vec<_> = heard.iter().filter(|l| l.starts_with("echo:")).collect();
    let expected = [
        "echo:Settings not stored: no storage on this machine",
        "echo:Settings unchanged: no storage on this machine",
        "echo:no storage on this machine",
        "echo:M113 S7",
        DEFAULTS,
        "echo:M113 S2",
    ];
    assert_eq!(said, expected);
    let (heard, ..) = keep(&mut Eeprom::blank(), &Settings::prototype(), &["M115"]);
    assert!(heard.contains(&"Cap:EEPROM:1".to_owned()), "{heard:?}");
}

#[test]
fn damaged_records_are_named_and_not_used() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    keep(&mut eeprom, &made, &["M113 S7", "M500", "M113 S8", "M500"]);
    let both = eeprom.cells().to_vec();
    // The newer record is in slot B.
    eeprom.cells()[1024 + 50] ^= 4;
    let (heard, ..) = keep(&mut eeprom, &made, &["M113", "M504"]);
    assert_eq!(
        (heard[0].as_str(), words(&heard[1])),
        ("echo:storage slot B not used: damaged", "echo:stored settings retrieved")
    );
    assert_eq!((heard[2].as_str(), heard[4].as_str()), ("echo:M113 S7", "echo:storage slot B not used: damaged"));
    assert_eq!(words(&heard[5]), "echo:stored settings valid");
    // Both: the defaults, at the start and after M501.
    eeprom.cells()[20] ^= 1;
    let (heard, ..) = keep(&mut eeprom, &made, &["M113", "M113 S5", "M501", "M113", "M504"]);
    assert_eq!(
        heard[..4],
        ["echo:storage slot A not used: damaged", "echo:storage slot B not used: damaged", DEFAULTS, "echo:M113 S2"]
    );
    assert_eq!(heard.iter().filter(|l| *l == "echo:M113 S2").count(), 2, "{heard:?}");
    assert!(heard.contains(&"echo:no valid settings stored".to_owned()));
    // And the next save makes it good.
    let (heard, ..) = keep(&mut eeprom, &made, &["M113 S8", "M500", "M504"]);
    assert_eq!(words(&heard[heard.len() - 2]), "echo:stored settings valid");
    assert_ne!(eeprom.cells(), both);
}

#[test]
fn loading_another_resolution_waits_for_the_motion_and_keeps_the_position() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    keep(&mut eeprom, &made, &["M92 X160 Y160 Z1600 E200", "M500"]);
    let lines = [
        "M502",
        "G1 X20 Y10 Z2 E4 F3000",
        "M501",
        "M114",
        "M114 R",
        "G1 X30 E6",
        "M400",
        "M114 R",
        "M502",
        "M114 R",
        "G1 X10.5 Y0 Z0 E5",
        "M400",
        "M114 R",
    ];
    let (heard, outcome, _) = keep(&mut eeprom, &made, &lines);
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("X:")).map(String::as_str).collect();
    let there = "X:20.00 Y:10.00 Z:2.00 E:4.00 Count A:4800 B:1600 Z:3200";
    let further = "X:30.00 Y:10.00 Z:2.00 E:6.00 Count A:";
    assert_eq!(told[..2], [there, there]);
    assert_eq!(told[2], format!("{further}6400 B:3200 Z:3200"));
    assert_eq!(told[3], format!("{further}3200 B:1600 Z:1600"));
    assert_eq!(told[4], "X:10.50 Y:0.00 Z:0.00 E:5.00 Count A:840 B:840 Z:0");
    // u = x + y drives motor 11: 30 mm at 80, 10 mm at 160, and back by 29.5 mm at 80 steps/mm; E likewise.
    assert_eq!(outcome.counts[3], 30 * 80 + 10 * 160 - (40 * 80 - 840));
    assert_eq!(outcome.counts[6], 4 * 400 + 2 * 200 - 400);
}

/// Says something so many turns after it has sent M500.
struct Interrupter {
    talk: Talk,
    turns: u32,
    says: &'static str,
}

impl Host for Interrupter {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.talk.send(out);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.talk.awaiting > 0 {
            self.turns = self.turns.wrapping_sub(1);
            if self.turns == 0 {
                out.extend(self.says.bytes());
                self.talk.awaiting += 1;
            }
        }
    }

    fn hear(&mut self, line: &str) {
        self.talk.hear(line);
    }

    fn is_done(&self) -> bool {
        self.talk.is_done()
    }
}

#[test]
fn an_emergency_stop_is_heard_while_settings_are_saved() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    keep(&mut eeprom, &made, &["M113 S7", "M500"]);
    let mut stored = made;
    stored.keepalive_s = 7;
    let (before, size) = (eeprom.writes(), eeprom.writes());
    // The M500 of other settings lasts a turn for every page read, written and read again.
    let mut save = |says, turns| {
        let mut host = Interrupter { talk: Talk::new(&["M113 S8", "M500"]), turns, says };
        let outcome = run_with(&made, None, &mut eeprom, &mut [&mut host], &mut Steps::default()).unwrap();
        (outcome.halted, eeprom.writes(), eeprom.settings(), host.talk.heard)
    };
    let (halted, writes, kept, heard) = save("M112\n", 10);
    assert!(halted && writes > before && writes < before + size, "{writes} writes: {heard:?}");
    assert_eq!(kept, Some(stored));
    // A quick stop has nothing to stop there; the save goes on.
    let (halted, _, kept, heard) = save("M410\n", 10);
    stored.keepalive_s = 8;
    assert!(!halted && kept == Some(stored), "{heard:?}");
    assert!(heard.iter().any(|l| l.starts_with("echo:Settings Stored")), "{heard:?}");
    assert_eq!(heard.iter().filter(|l| *l == "ok").count(), 3, "{heard:?}");
}

/// Plans a move, looks at the storage, and so many turns later sends a quick stop.
struct Stopper {
    turns: u32,
    oks: u32,
    stage: u32,
}

impl Host for Stopper {
    fn send(&mut self, _out: &mut Vec<u8>) {}

    fn interject(&mut self, out: &mut Vec<u8>) {
        let (awaited, text) = match self.stage {
            0 => (0, "M17\n"),
            1 => (1, "G1 X50 F3000\nM504\n"),
            2 if self.turns > 0 => {
                self.turns -= 1;
                return;
            }
            2 => (0, "M410\n"),
            3 => (4, "G4 P500\n"),
            _ => return,
        };
        if self.oks >= awaited {
            out.extend(text.bytes());
            self.stage += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.oks += u32::from(line.starts_with("ok"));
    }

    fn is_done(&self) -> bool {
        self.oks == 5
    }
}

/// A move that is planned and has not begun yet is motion, too.
#[test]
fn a_quick_stop_while_storage_is_looked_at_forgets_the_move_before_it() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    keep(&mut eeprom, &made, &["M500", "M113 S7", "M500"]);
    for turns in 0..20 {
        let mut host = Stopper { turns, oks: 0, stage: 0 };
        let mut steps = Steps::default();
        run_with(&made, Some([Mm::ZERO; 3]), &mut eeprom, &mut [&mut host], &mut steps).unwrap();
        assert_eq!(steps.count, 0, "after {turns} turns");
    }
}

/// A memory that is busy for some turns after every write, and perhaps for ever.
struct Busy<'e> {
    eeprom: &'e mut Eeprom,
    asked: u32,
    turns: Option<u32>,
}

impl Storage for Busy<'_> {
    fn capacity(&self) -> u32 {
        self.eeprom.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        assert!(self.asked >= self.turns.unwrap_or(0), "read while busy");
        self.eeprom.read(at, into).await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        assert!(self.asked >= self.turns.unwrap_or(0), "written while busy");
        self.asked = 0;
        self.eeprom.write(at, bytes).await
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        self.asked += 1;
        match self.turns {
            None if self.asked > 20 => Err(StorageError::Failed),
            turns => Ok(turns.is_some_and(|turns| self.asked >= turns)),
        }
    }
}

#[test]
fn memory_that_takes_its_time_is_waited_for_and_m112_is_heard_meanwhile() {
    let made = Settings::prototype();
    let save = |turns: Option<u32>, says, after| {
        let mut eeprom = Eeprom::blank();
        let mut host = Interrupter { talk: Talk::new(&["M500"]), turns: after, says };
        let busy = Busy { eeprom: &mut eeprom, asked: turns.unwrap_or(0), turns };
        let outcome = run_with(&made, None, busy, &mut [&mut host], &mut Steps::default()).unwrap();
        (outcome.halted, eeprom.settings().is_some(), host.talk.heard)
    };
    let (_, is_stored, heard) = save(Some(5), "", 0);
    assert!(is_stored && heard.iter().any(|l| l.starts_with("echo:Settings Stored")), "{heard:?}");
    let (halted, is_stored, heard) = save(Some(50), "M112\n", 10);
    assert!(halted && !is_stored, "{heard:?}");
    let (_, is_stored, heard) = save(None, "", 0);
    assert!(!is_stored && heard.contains(&"echo:Settings not stored: storage does not answer".to_owned()), "{heard:?}");
}

#[test]
fn what_is_said_of_storage_means_nothing_else_to_a_host() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    let mut heard = Vec::new();
    let mut say =
        |eeprom: &mut Eeprom| heard.extend(keep(eeprom, &made, &["M502", "M501", "M504", "M113 S9", "M500"]).0);
    say(&mut eeprom);
    say(&mut eeprom);
    eeprom.cells()[30] ^= 1;
    say(&mut eeprom);
    heard.extend(talk(&["M500", "M501", "M504"]).0);
    let reserved = [
        "X:", " T:", "T0:", " B:", "NAME:", "File", "file", "SD", "Invalid", " Count ", "_min", "_max", "start", "ok",
        "rs", "Error",
    ];
    for line in heard.iter().filter(|l| *l != "ok") {
        assert!(line.starts_with("echo:") && !reserved.iter().any(|word| line.contains(word)), "{line}");
    }
}

#[test]
fn firmware_tells_its_name_and_abilities() {
    let (heard, ..) = talk(&["M115"]);
    assert!(heard[0].starts_with("FIRMWARE_NAME:CoreH-bot "), "{heard:?}");
    assert!(heard.contains(&"Cap:EMERGENCY_PARSER:1".to_owned()) && heard.last().unwrap() == "ok");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Whatever lines look like, each is answered once, nothing panics, and the pairs stay pairs.
    #[test]
    fn any_lines_are_answered_once_each(
        lines in proptest::collection::vec(
            prop_oneof![
                4 => "G[0-3]( ?[XYZE]-?[0-9]{1,3}(\\.[0-9]{0,4})?){1,3}( F[1-9][0-9]{3})?( [IJR]-?[0-9]{1,2}){0,2}",
                2 => "M2(0[1-5]|11|2[01])( [XYZESTPRJ]-?[0-9]{0,5}(\\.[0-9]{0,3})?){0,4}",
                1 => "G(9[0-2]|2[01]|17|4 P[0-9]{1,3})",
                1 => "M(17|18|84|82|83|92 E[0-9]{1,4}|105|114 ?R?|115|119|220 S[0-9]{1,5}|221|400|410|50[0-4]|122)",
                1 => "M(569|906|91[34])( [SXYZE]-?[0-9]{0,4}(\\.[0-9]{0,3})?){0,4}",
                1 => "G1 [XYE]-?[0-9]{5,30}",
                1 => "[ -~]{1,40}".prop_filter("it must not be blank, a comment, numbered or a stop", |l| {
                    let l = l.trim();
                    let stop = l.to_ascii_uppercase().replace(' ', "");
                    !l.is_empty() && !l.starts_with([';', '!', '~']) && !l.contains('*')
                        && !stop.starts_with('N') && !stop.contains("M112") && !stop.starts_with("G4")
                }),
            ],
            1..25,
        ),
    ) {
        let mut lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        lines.push("M400");
        let (heard, outcome, _) = keep(&mut Eeprom::blank(), &Settings::prototype(), &lines);
        prop_assert!(!outcome.halted);
        prop_assert_eq!(heard.iter().filter(|l| l.starts_with("ok")).count(), lines.len(), "{:?}", heard);
        let [n1, n4, n8, n11, z1, z2, _] = outcome.counts;
        prop_assert_eq!((n1, n4, z1), (-n8, -n11, z2));
    }
}
