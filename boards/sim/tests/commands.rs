//! Every command that slicers and hosts send: what each is answered, as a table.
//!
//! The rows are those that a printer of this dialect must or should know. What belongs to heaters, probing, storage
//! or motor drivers stands here with the words in which this firmware says what it does not do.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Host, Sink, run};

struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

/// Sends lines one by one; with the first busy message comes M108.
struct Asker {
    lines: Vec<String>,
    next: usize,
    awaiting: u32,
    has_gone_on: bool,
    heard: Vec<String>,
}

impl Host for Asker {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting == 0 && self.next < self.lines.len() {
            out.extend(self.lines[self.next].bytes());
            out.push(b'\n');
            self.next += 1;
            self.awaiting = 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let is_paused = self.heard.last().is_some_and(|line| line == "echo:busy: paused for user");
        if is_paused && !core::mem::replace(&mut self.has_gone_on, true) {
            out.extend(b"M108\n");
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line.starts_with("ok") {
            self.awaiting = self.awaiting.saturating_sub(1);
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.next == self.lines.len() && self.awaiting == 0
    }
}

/// What a homed machine answers to `lines`, without its greeting and without `echo:busy: processing`.
fn answers(lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
    let outcome = run(&Settings::prototype(), Some([100, 100, 50].map(Mm::from_num)), &mut host, &mut Deaf).unwrap();
    assert!(!outcome.halted, "{:?}", host.lines);
    host.heard.into_iter().skip(2).filter(|line| line != "echo:busy: processing").collect()
}

/// Answers in front of the `ok`; an asterisk at the end stands for anything.
type Row = (&'static str, &'static [&'static str]);

const SILENCE: &[&str] = &[];
const HEATERS: &[&str] = &["echo:no heaters configured"];
const UNTUNED: &[&str] = &["echo:no heaters configured, ignored"];
const PROBE: &[&str] = &["echo:nothing is probed by this firmware, ignored"];
const PAUSED: &[&str] = &[
    "// action:paused",
    "// action:prompt_begin Paused",
    "// action:prompt_button Continue",
    "// action:prompt_show",
    "echo:busy: paused for user",
    "// action:prompt_end",
    "// action:resumed",
];

const ROWS: &[Row] = &[
    // Motion.
    ("G0 X1 F6000", SILENCE),
    ("G1 X10 Y20 E.5 F1800", SILENCE),
    ("G1 F1800", SILENCE),
    ("G1 E-.8 F2100", SILENCE),
    ("G2 X110 I5", SILENCE),
    ("G3 Z50.76 I.194 J1.201 P1  F30000", SILENCE),
    ("G2 X1", &["echo:arc ignored: *"]),
    ("G4 P10", SILENCE),
    ("G4 ; wait", SILENCE),
    ("G10", SILENCE),
    ("G10 S1", SILENCE),
    ("G11", SILENCE),
    ("M207 S2 F1800 Z.2", SILENCE),
    ("M207", &["echo:  M207 S3 F2700 Z0"]),
    ("M208 S.1", SILENCE),
    ("M208", &["echo:  M208 S0 F480"]),
    ("G17", SILENCE),
    ("G21", SILENCE),
    ("G28 X0 Y0", SILENCE),
    ("G90", SILENCE),
    ("G91", SILENCE),
    ("G92 E0", SILENCE),
    ("M400", SILENCE),
    ("M400 U1", SILENCE),
    ("M410", SILENCE),
    ("M108", SILENCE),
    ("M82", SILENCE),
    ("M83", SILENCE),
    ("M220 S90", SILENCE),
    ("M220", &["FR:100%"]),
    ("M220 B", SILENCE),
    ("M220 R", SILENCE),
    ("M221 S95", SILENCE),
    ("M221", &["echo:E0 Flow: 100%"]),
    ("T0", SILENCE),
    ("T1", &["echo:T1 Invalid extruder"]),
    ("Tx", SILENCE),
    // Waiting for the user.
    ("M0", PAUSED),
    ("M0 Press the button", PAUSED),
    ("M1", PAUSED),
    ("M601", PAUSED),
    ("M600 E10", &["// action:paused", "// action:prompt_begin Change the filament", "*", "*", "*", "*", "*"]),
    ("M1 S1", &["// action:paused", "*", "*", "*", "// action:prompt_end", "// action:resumed"]),
    ("M602", SILENCE),
    ("M24", SILENCE),
    ("M25", &["// action:paused"]),
    ("M876 S0", SILENCE),
    ("M876 P1", SILENCE),
    // Limits and settings.
    ("M92 X80 Y80", SILENCE),
    ("M92", &["echo:  M92 X80 Y80 Z800 E400"]),
    ("M201 X4000", SILENCE),
    ("M201", &["echo:  M201 X5000 Y5000 Z200 E5000"]),
    ("M203 Z10", SILENCE),
    ("M203", &["echo:  M203 X300 Y300 Z20 E80"]),
    ("M204 P500 T500", SILENCE),
    ("M204", &["echo:  M204 P3000 R3000 T5000"]),
    ("M205 X8 Y8", SILENCE),
    ("M205", &["echo:  M205 J0.013 E5 S0 T0"]),
    ("M211 S1", SILENCE),
    ("M211", &["Soft endstops: ON  Min:  X0.00 Y0.00 Z0.00   Max:  X390.00 Y417.60 Z335.00"]),
    ("M200 D0", SILENCE),
    ("M593 F40", SILENCE),
    ("M593", &["echo:  M593 X F0", "echo:  M593 Y F0"]),
    ("M593 X F60 T5", &["echo:M593 ignored: T is 0 (ZV), 1 (ZVD), 2 (MZV), 3 (EI) or 4 (2HUMP_EI), *"]),
    ("M593 P\"mzv\" F60", SILENCE),
    ("M593 P\"zvdd\" F60", &["echo:M593 ignored: *"]),
    ("M572 D0 S0.05", SILENCE),
    ("M572", &["echo:Advance K=0"]),
    ("M900 K.05", SILENCE),
    ("M900", &["echo:Advance K=0"]),
    ("SET_PRESSURE_ADVANCE ADVANCE=0.05", SILENCE),
    ("SET_PRESSURE_ADVANCE", &["echo:Advance K=0"]),
    ("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.3", SILENCE),
    ("SET_VELOCITY_LIMIT ACCEL=1000 ACCEL_TO_DECEL=500 SQUARE_CORNER_VELOCITY=5", SILENCE),
    ("SET_VELOCITY_LIMIT VELOCITY=200", &["echo:SET_VELOCITY_LIMIT VELOCITY is not obeyed by this firmware"]),
    ("SET_VELOCITY_LIMIT", &["echo:  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.5"]),
    // Values out of range.
    ("M92 E0", &["echo:M92 E0 is out of range, set to 1"]),
    ("M201 X0", &["echo:M201 X0 is out of range, set to 1"]),
    (
        "M203 X99999 Y-1",
        &["echo:M203 X99999 is out of range, set to 3000", "echo:M203 Y-1 is out of range, set to 0.01"],
    ),
    ("M204 P0 R2 T1e9", &["echo:M204 P0 is out of range, set to 1"]),
    ("M205 J5", &["echo:M205 J5 is out of range, set to 1"]),
    ("M205 E0 S-1", &["echo:M205 E0 is out of range, set to 0.01", "echo:M205 S-1 is out of range, set to 0"]),
    ("M205 X8 Y10 Z.4", &["echo:M205: one value for X and Y*"]),
    ("M207 S200 F0", &["echo:M207 S200 is out of range, set to 100", "echo:M207 F0 is out of range, set to 0.6"]),
    ("M208 S-1", &["echo:M208 S-1 is out of range, set to 0"]),
    ("M220 S5", &["echo:M220 S5 is out of range, set to 10"]),
    ("M221 S5000", &["echo:M221 S5000 is out of range, set to 999"]),
    ("M113 S99", &["echo:M113 S99 is out of range, set to 60"]),
    ("M155 S99", &["echo:M155 S99 is out of range, set to 60"]),
    ("M154 S-1", &["echo:M154 S-1 is out of range, set to 0"]),
    ("M593 F5 D2", &["echo:M593 F5 is out of range, set to 10", "echo:M593 D2 is out of range, set to 0.5"]),
    ("M900 K50", &["echo:M900 K50 is out of range, set to 4"]),
    ("M572 W9", &["echo:M572 W9 is out of range, set to 0.2"]),
    ("M913 X-5", &["echo:M913 X-5 is out of range, set to 0"]),
    ("M914 X300", &["echo:M914 X300 is out of range, set to 255"]),
    ("SET_VELOCITY_LIMIT ACCEL=0", &["echo:SET_VELOCITY_LIMIT ACCEL=0 is out of range, set to 1"]),
    ("G1 X110 F0", &["echo:F0 is out of range, set to 3000"]),
    ("G1 X110 F-5", &["echo:F-5 is out of range, set to 3000"]),
    ("G1 X110 F999999", &["echo:F999999 is out of range, set to 180000"]),
    ("G1 X99999999999", &["echo:target beyond the reachable space, moved to its edge"]),
    ("G92 X99999999999", &["echo:G92 X1000000000 is out of range, set to 10000"]),
    // Lines that are not in order.
    ("G1 Xabc", &["echo:line ignored: X needs a number"]),
    ("G1 X1,5", &["echo:line ignored: \"X1,5\" is no letter with a number"]),
    ("G1 X1.2.3", &["echo:line ignored: \"X1.2.3\" is no letter with a number"]),
    ("G1 X10\x01", &["echo:line ignored: \"X10?\" is no letter with a number"]),
    ("G1 X--5", &["echo:line ignored: \"X--5\" is no letter with a number"]),
    ("G1 C5", &["echo:line ignored: there is no axis C"]),
    ("G92 C0", &["echo:line ignored: there is no axis C"]),
    ("G90 G1 X10", &["echo:line ignored: G1 is a second command on it"]),
    ("G4 P-5", &["echo:line ignored: P-5 is out of range"]),
    ("SET_VELOCITY_LIMIT ACCEL=fast", &["echo:line ignored: \"ACCEL=fast\" is no name with = and a number"]),
    // The host's own.
    ("M105", &[]),
    ("M110 N5", SILENCE),
    ("M110", &["Line: 0"]),
    ("M111 S6", SILENCE),
    ("M111", &["echo:DEBUG:off"]),
    ("M113 S2", SILENCE),
    ("M113", &["echo:M113 S2"]),
    ("M114", &["X:100.00 Y:100.00 Z:50.00 E:0.00 Count A:16000 B:0 Z:40000"]),
    ("M114 R", &["X:100.00 Y:100.00 Z:50.00 E:0.00 Count A:16000 B:0 Z:40000"]),
    ("M117 any; text *", SILENCE),
    ("M118 A1 action:notification hi", &["// action:notification hi"]),
    ("M118 E1 hi", &["echo:hi"]),
    ("M118 hi", &["hi"]),
    ("M118 ok", &["echo:ok"]),
    ("M119", &["Reporting endstop status", "x_min: open", "y_min: open", "z_min: open"]),
    ("M154 S5", SILENCE),
    ("M155 S2", SILENCE),
    ("M73 P5 R10", SILENCE),
    ("M74 W12.5", SILENCE),
    ("M75", SILENCE),
    ("M76", SILENCE),
    ("M77", SILENCE),
    ("M80", SILENCE),
    ("M81", &["echo:M81 ignored: this firmware does not switch the power supply"]),
    ("M300 S440 P100", SILENCE),
    ("M413 S0", SILENCE),
    ("M413 S1", &["echo:Power-loss recovery OFF, this firmware cannot do it"]),
    ("M413", &["echo:Power-loss recovery OFF"]),
    ("M486 T3", SILENCE),
    ("M486 S1", SILENCE),
    ("M486 ACube (1)*", SILENCE),
    ("M486 S-1", SILENCE),
    ("M486 P1", &["echo:objects cannot be left out, ignored"]),
    ("EXCLUDE_OBJECT_START NAME=cube", SILENCE),
    ("EXCLUDE_OBJECT_END NAME=cube", SILENCE),
    ("EXCLUDE_OBJECT NAME=cube", &["echo:objects cannot be left out, ignored"]),
    ("M555 X1 Y1 W9 H9", SILENCE),
    ("M862.1 P0.4", SILENCE),
    ("M862.3 P \"MK4S\"", SILENCE),
    ("M999", SILENCE),
    // Motors and their drivers.
    ("M17", SILENCE),
    ("M18", SILENCE),
    ("M84 X Y E", SILENCE),
    ("M84 S0", SILENCE),
    ("M569 S1 X", SILENCE),
    ("M906 X800", SILENCE),
    ("M907 E500", SILENCE),
    // Heaters and fans, of which there are none.
    ("M104 S200", HEATERS),
    ("M106 S91.8", HEATERS),
    ("M107", HEATERS),
    ("M109 S200", HEATERS),
    ("M116", HEATERS),
    ("M140 S60", HEATERS),
    ("M190 S60", HEATERS),
    ("M301", UNTUNED),
    ("M303 E0 S200", UNTUNED),
    ("M304", UNTUNED),
    ("M302", &["echo:Cold extrudes are enabled"]),
    ("M302 S170", &["echo:Cold extrudes are enabled, and cannot be forbidden without a heater"]),
    ("M302 P1", &["echo:Cold extrudes are enabled"]),
    ("M141 S40", SILENCE),
    ("M142 S36", SILENCE),
    ("M191 S40", SILENCE),
    // Probing, which nothing does.
    ("G29", PROBE),
    ("G30", PROBE),
    ("M48", PROBE),
    ("M290 Z0.05", PROBE),
    ("M851", PROBE),
    ("M420 S1", &["echo:Bed Leveling OFF"]),
    // Storage, of which this machine has none.
    ("M500", &["echo:Settings not stored: no storage on this machine"]),
    ("M501", &["echo:Settings unchanged: *"]),
    ("M502", &["echo:Hardcoded Default Settings Loaded"]),
];

fn fits(heard: &str, pattern: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(begin) => heard.starts_with(begin),
        None => heard == pattern,
    }
}

#[test]
fn every_command_is_answered_as_the_table_says() {
    for (line, expected) in ROWS {
        let heard = answers(&[line]);
        let (oks, said): (Vec<_>, Vec<_>) = heard.iter().partition(|heard| heard.starts_with("ok"));
        // An answer to M108 follows that to the wait which it ended.
        let asked = 1 + usize::from(heard.iter().any(|heard| heard == "echo:busy: paused for user"));
        assert_eq!(oks.len(), asked, "{line}: {heard:?}");
        assert_eq!(said.len(), expected.len(), "{line}: {heard:?}");
        assert!(said.iter().zip(*expected).all(|(heard, pattern)| fits(heard, pattern)), "{line}: {heard:?}");
        assert!(!heard.iter().any(|heard| heard.contains("Unknown")), "{line}: {heard:?}");
    }
}

#[test]
fn the_firmware_names_itself_and_what_it_can_in_one_piece() {
    let heard = answers(&["M115 U6.2.6+8948"]);
    assert!(heard[0].starts_with("FIRMWARE_NAME:CoreH-bot ") && heard[0].contains(" EXTRUDER_COUNT:1 "), "{heard:?}");
    let caps = &heard[1..heard.len() - 1];
    assert!(caps.iter().all(|line| line.starts_with("Cap:")), "{heard:?}");
    for cap in ["AUTOREPORT_TEMP:1", "AUTOREPORT_POS:1", "EMERGENCY_PARSER:1", "HOST_ACTION_COMMANDS:1"] {
        assert!(caps.contains(&format!("Cap:{cap}")), "{cap}");
    }
    assert_eq!(heard.last().unwrap(), "ok");
}

#[test]
fn temperatures_stand_in_the_line_of_the_ok() {
    assert_eq!(answers(&["M105"]), ["ok T:0.00 /0.00 B:0.00 /0.00 @:0 B@:0"]);
    assert_eq!(answers(&["M105 T0"]), ["ok T:0.00 /0.00 B:0.00 /0.00 @:0 B@:0"]);
}

#[test]
fn the_outline_of_an_object_may_be_longer_than_a_line() {
    let outline = format!("EXCLUDE_OBJECT_DEFINE NAME=cube POLYGON=[{}]", "[100.5,100.5],".repeat(640));
    assert!(outline.len() > 8_900);
    assert_eq!(answers(&[&outline, "M114"])[0], "ok");
    let message = format!("M117 {}", "long ".repeat(200));
    assert_eq!(answers(&[&message]), ["ok"]);
    let moved = format!("G1 X5 {}", "X6 ".repeat(200));
    assert_eq!(answers(&[&moved]), ["echo:Line too long, ignored", "ok"]);
}

#[test]
fn a_dry_run_moves_everything_but_the_filament() {
    let heard = answers(&["M111 S8", "M111", "G1 X110 E5 F6000", "M400", "M114 R", "M114"]);
    assert!(heard.contains(&"echo:DEBUG:DRYRUN".to_owned()), "{heard:?}");
    let told: Vec<_> = heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert_eq!(told[0], "X:110.00 Y:100.00 Z:50.00 E:5.00 Count A:16800 B:800 Z:40000");
    assert_eq!(told[0], told[1]);
}

#[test]
fn reports_come_by_themselves_until_they_are_called_off() {
    let heard = answers(&["M155 S1", "M154 S2", "G4 S6.5", "M155 S0", "M154 S0", "G4 S5"]);
    let count = |line: &str| heard.iter().filter(|heard| heard.starts_with(line)).count();
    assert_eq!((count(" T:0.00 /0.00 B:0.00 /0.00 @:0 B@:0"), count("X:100.00 ")), (6, 3), "{heard:?}");
}

#[test]
fn a_position_told_by_itself_is_that_of_the_tool() {
    let heard = answers(&["M154 S1", "G1 X110 F120", "M400"]);
    let told: Vec<_> = heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert!(told.len() >= 4 && told[1].starts_with("X:10") && !told[1].starts_with("X:110"), "{told:?}");
}

/// A line that is not carried out leaves everything as it was.
#[test]
fn a_line_that_is_ignored_changes_nothing() {
    for line in
        ["G1 X150 Y1,5 F1200 E3", "G1 X150 F1200 C3", "G1 X150 F1200 Y", "G2 X150 F1200", "G2 X150 I25 F1200 Y,"]
    {
        let heard = answers(&["G1 X110 F6000 E1", line, "G1 F", "M114", "G91", "G1 X1 F0", "M114"]);
        let told: Vec<_> = heard.iter().filter(|line| line.starts_with("X:")).collect();
        assert!(told[0].starts_with("X:110.00 Y:100.00 Z:50.00 E:1.00"), "{line}: {heard:?}");
        assert!(told[1].starts_with("X:111.00"), "{line}: {heard:?}");
        assert!(heard.contains(&"echo:F0 is out of range, set to 6000".to_owned()), "{line}: {heard:?}");
    }
}

#[test]
fn shapers_may_have_the_names_of_another_firmware() {
    for (line, told) in [
        ("M593 P\"mzv\" F60", "echo:  M593 X F60 D0.1 T2"),
        ("M593 P\"EI\" F50 S0.05", "echo:  M593 X F50 D0.05 T3"),
        ("M593 P\"none\"", "echo:  M593 X F0"),
    ] {
        let heard = answers(&["M593 F40", line, "M593"]);
        assert!(heard.contains(&told.to_owned()), "{line}: {heard:?}");
    }
}

#[test]
fn velocity_limits_are_obeyed_word_by_word() {
    let line = "SET_VELOCITY_LIMIT VELOCITY=9 ACCEL=2000 ACCEL_TO_DECEL=500 SQUARE_CORNER_VELOCITY=6";
    let heard =
        answers(&[line, "M204", "M205", "SET_VELOCITY_LIMIT", "SET_VELOCITY_LIMIT ACCEL_TO_DECEL=1500", "M503"]);
    for told in [
        "echo:SET_VELOCITY_LIMIT VELOCITY is not obeyed by this firmware",
        "echo:  M204 P2000 R3000 T2000",
        "echo:  M205 X6 Y6 E5 S0 T0",
        "echo:  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.75",
        "echo:  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.25",
    ] {
        assert!(heard.contains(&told.to_owned()), "{told}: {heard:?}");
    }
}

#[test]
fn the_report_of_the_settings_has_the_bed_and_homing() {
    let heard = answers(&["M503"]);
    for told in [
        "echo:; reachable: X390 Y417.6 Z335 mm",
        "echo:; homing X: 40 mm/s, 5 mm back, 5 mm/s",
        "echo:; homing is not needed before moves",
    ] {
        assert!(heard.contains(&told.to_owned()), "{told}: {heard:?}");
    }
}

/// What a machine that has not been homed answers.
fn before_homing(settings: &Settings, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
    run(settings, None, &mut host, &mut Deaf).unwrap();
    host.heard.into_iter().skip(2).filter(|line| line != "ok" && line != "echo:busy: processing").collect()
}

#[test]
fn moves_before_homing_are_told_of_once_or_refused() {
    let told = "echo:motion before homing (G28), the ends of the axes are not known";
    let settings = Settings::prototype();
    let lines = ["G1 E5 F600", "G1 X5 F6000", "G1 Y5", "G2 X7 I1", "M114"];
    let heard = before_homing(&settings, &lines);
    assert_eq!(heard[0], told);
    assert!(heard[1].starts_with("X:7.00 Y:5.00") && heard.len() == 2, "{heard:?}");
    // Once a print.
    let heard = before_homing(&settings, &["G1 X5", "M110 N0", "G1 X6", "G28 X", "M110 N0", "G1 X7", "G1 Y7"]);
    assert_eq!(heard, [told; 3]);
    let strict = Settings { require_homing: true, ..settings };
    let heard =
        before_homing(&strict, &["G1 E5 F600", "G1 X5 F6000", "G2 X7 I1", "M114", "G28 X", "G1 X5", "G1 Z1", "M114"]);
    let refused = "echo:move ignored: home its axes first (G28)";
    assert_eq!([&heard[0], &heard[1], &heard[3]], [refused; 3]);
    assert!(heard[2].starts_with("X:0.00 Y:0.00 Z:0.00 E:5.00"), "{heard:?}");
    assert!(heard[4].starts_with("X:5.00 Y:0.00 Z:0.00"), "{heard:?}");
}

/// Lines whose meaning depends on others would print something else if they were passed over.
#[test]
fn conditions_stop_the_print_with_a_reason() {
    for line in ["M622 J1", "M623", "if {1 > 2}", "while true"] {
        let lines = ["G1 X110", line, "G1 X120"].map(str::to_owned).to_vec();
        let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
        let start = Some([100, 100, 50].map(Mm::from_num));
        let outcome = run(&Settings::prototype(), start, &mut host, &mut Deaf).unwrap();
        assert!(outcome.halted, "{line}");
        let [.., reason, halted] = host.heard.as_slice() else { panic!("{:?}", host.heard) };
        assert!(reason.starts_with("Error:which lines run depends on this one"), "{line}: {reason}");
        assert!(halted.starts_with("Error:Printer halted. kill() called!"), "{line}: {halted}");
    }
}

#[test]
fn arcs_end_where_they_should_in_every_plane() {
    for (line, end) in [
        ("G17\nG2 X120 I10", "X:120.00 Y:100.00 Z:50.00"),
        ("G18\nG2 X120 I10", "X:120.00 Y:100.00 Z:50.00"),
        ("G18\nG3 Z70 K10", "X:100.00 Y:100.00 Z:70.00"),
        ("G19\nG2 Y120 J10", "X:100.00 Y:120.00 Z:50.00"),
        ("G19\nG3 Z70 K10 X110", "X:110.00 Y:100.00 Z:70.00"),
    ] {
        let mut lines: Vec<&str> = line.split('\n').collect();
        lines.extend(["M114", "G17", "M114"]);
        let heard = answers(&lines);
        assert!(heard.iter().any(|line| line.starts_with(end)), "{line}: {heard:?}");
    }
    assert!(answers(&["G18", "G2 X120 J10"])[1].starts_with("echo:arc ignored: its centre is not in its plane"));
}
