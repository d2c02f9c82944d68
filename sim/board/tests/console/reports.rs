//! Reports: settings as lines, sensors, the firmware itself.

use super::talk::talk;
use corehbot::settings::plain::{CODES, Owner, condition};

#[test]
fn settings_that_are_reported_read_back() {
    let changes = [
        "M92 Z1600.5 E415.37",
        "M203 X250.3 Y200 Z12.7 E61",
        "M201 X4321 Y1234.5 Z150 E9000",
        "M204 P1500.25 R2500 T4000",
        "M205 X7.5 Y9 Z0.35 E3.3 S1 T2",
        "M593 X F60.7 D0.055 T2",
        "M593 Y F41.3 T4",
        "M900 K0.0123",
        "M572 W0.033",
        "M207 S1.25 F1800 Z0.4",
        "M208 S0.05 F600",
        "M211 S0",
        "M206 X-3 Z0.25",
        "SET_GCODE_OFFSET Z=-0.075",
        "M113 S5",
        "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.37",
        "M569 S1 X",
        "M906 Y905 E650",
        "M913 X120.5 Z20",
        "M914 X70 Z60",
        "M503 S0",
    ];
    let (heard, ..) = talk(&changes);
    let report: Vec<String> = heard.iter().filter_map(|l| l.strip_prefix("  ")).map(str::to_owned).collect();
    // The prototype has no heaters.
    let plain = CODES.iter().filter(|code| condition(**code).owner != Owner::Heaters).count();
    // M422 has two lines for each of two screws, SET_GCODE_OFFSET one.
    assert_eq!(report.len(), 15 + 4 + 1 + plain, "{heard:?}");
    assert!(report.contains(&"M113 S5".to_owned()) && report.contains(&"M211 S0 ; OFF".to_owned()));
    let mut again: Vec<&str> = report.iter().map(String::as_str).collect();
    again.push("M503 S0");
    let (heard, ..) = talk(&again);
    let second: Vec<_> = heard.iter().filter_map(|l| l.strip_prefix("  ")).collect();
    assert_eq!(report, second);
    // A machine without these lines reports something else.
    let (heard, ..) = talk(&["M503"]);
    assert!(heard.contains(&"echo:  M205 J0.013 E5 S0 T0 Z3000".to_owned()), "{heard:?}");
}

#[test]
fn heaters_are_missed_once() {
    let (heard, ..) = talk(&["M104 S200", "M140 S60", "M109 S200", "M116"]);
    assert_eq!(heard, ["echo:no heaters configured", "ok", "ok", "ok", "ok"]);
}

#[test]
fn sensors_say_what_they_read_or_that_there_is_nothing() {
    let (heard, ..) = talk(&["M122"]);
    for line in ["echo:sensor bed 62594/65536", "echo:sensor hotend0 62594/65536", "echo:sensor hotend1 -"] {
        assert!(heard.contains(&line.to_owned()), "{heard:?}");
    }
}

#[test]
fn firmware_tells_its_name_and_abilities() {
    let (heard, ..) = talk(&["M115"]);
    assert!(heard[0].starts_with("FIRMWARE_NAME:CoreH-bot "), "{heard:?}");
    assert!(heard.contains(&"Cap:EMERGENCY_PARSER:1".to_owned()) && heard.last().unwrap() == "ok");
}
