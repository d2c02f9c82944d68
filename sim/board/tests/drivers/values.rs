//! Values that M569, M906, M913 and M914 change, report and store.

use super::script::{LONG_MOVE, Script, Steps, act, lines, play, say};
use corehbot::motors::prototype;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::tmc2209;
use corehbot_sim::tmc2209::gconf;
use corehbot_sim::world::run_on;

#[test]
fn microsteps_are_those_of_the_settings() {
    let mut settings = Settings::prototype();
    settings.drivers.belt.microsteps = 64;
    let drivers = Drivers::new();
    let acts = lines(&["M17"]).into();
    let mut host =
        Script { drivers: &drivers, acts, is_awaiting: false, heard: Vec::new(), interjection: None, interjected: 0 };
    run_on(&settings, None, NoStorage, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
    let microsteps = |motor| drivers.chip(motor).microsteps();
    assert_eq!((microsteps(prototype::M11), microsteps(prototype::Z1)), (64, 16));
}

#[test]
fn changes_reach_drivers_under_way_and_change_no_step() {
    let quiet = play(&Drivers::new(), lines(&LONG_MOVE), None).outcome;
    let drivers = Drivers::new();
    let told = play(&drivers, lines(&[LONG_MOVE[0], "M906 X1200 Z400", "M914 Y50", "M400"]), None);
    assert_eq!((told.outcome.ticks, told.outcome.counts), (quiet.ticks, quiet.counts));
    for motor in [prototype::M1, prototype::M4, prototype::M8, prototype::M11] {
        assert!((drivers.chip(motor).run_current_ma() - 1200.0).abs() < 28.0);
        assert_eq!(drivers.chip(motor).register(tmc2209::SGTHRS), 50);
        assert_eq!(drivers.chip(motor).register(tmc2209::TCOOLTHRS), 0xF_FFFF);
    }
    assert!((drivers.chip(prototype::Z2).run_current_ma() - 400.0).abs() < 16.0);
    assert!((drivers.chip(prototype::E0).run_current_ma() - 800.0).abs() < 16.0);
}

#[test]
fn stealth_is_a_bit_of_gconf() {
    let drivers = Drivers::new();
    let is_spread = |motor| drivers.chip(motor).register(gconf::ADDRESS) & gconf::EN_SPREADCYCLE != 0;
    let told = play(&drivers, lines(&["M17", "M569 S1 X", "M913 X100", "M569", "M913", "M122"]), None);
    assert_eq!((is_spread(prototype::M1), is_spread(prototype::M11), is_spread(prototype::Z1)), (false, false, true));
    let modes: Vec<_> = told.heard.iter().filter(|line| line.contains("driver mode")).collect();
    let [stealth, spread] = ["stealthChop", "spreadCycle"];
    let expected = [("X", stealth), ("Y", stealth), ("Z", spread), ("E", spread)];
    assert_eq!(modes, expected.map(|(axis, mode)| format!("{axis} driver mode: {mode}")).iter().collect::<Vec<_>>());
    assert!(
        told.has("Y stealthChop max speed: 100")
            && told.has("Driver m8: configured, motor on, 795 mA, stealthChop up to 100.80 mm/s")
    );
}

#[test]
fn the_report_tells_of_each_driver() {
    let drivers = Drivers::new();
    let break_some = |d: &Drivers| {
        d.chip(prototype::M8).is_silent = true;
        d.chip(prototype::E0).set(tmc2209::DRV_STATUS, 1 << 8 | 1 << 6);
        d.chip(prototype::E0).set(tmc2209::SG_RESULT, 123);
    };
    let told = play(&drivers, vec![act(break_some), say("M122"), say("M17 Z"), say("M17 E"), say("M122")], None);
    let report: Vec<_> = told.heard.iter().map(String::as_str).collect();
    assert!(report.contains(&"Driver m1: not configured yet, motor off"), "{report:#?}");
    assert!(report.contains(&"Driver m8: does not answer: is the motor supply on, its jumper set to UART?"));
    assert!(report.contains(
        &"Driver z1: configured, motor on, 795 mA, spreadCycle, 16 microsteps, 4.00 mm a turn, 795 mA at rest"
    ));
    assert!(report.contains(
        &"Driver e0: configured, motor on, 795 mA, spreadCycle, 16 microsteps, 8.00 mm a turn, 397 mA at rest"
    ));
    let health = "  above 120 C, coil open?, stall result 123, 12 writes, 0 failed exchanges";
    assert!(report.contains(&health), "{report:#?}");
}

#[test]
fn values_are_reported_refused_and_kept() {
    let drivers = Drivers::new();
    let told = play(
        &drivers,
        lines(&["M906", "M906 X900 Y800", "M906 X1800", "M906 E99", "M906 Y850 E500", "M906", "M914 X70", "M914"]),
        None,
    );
    let heard: Vec<_> = told.heard.iter().map(String::as_str).filter(|line| *line != "ok").collect();
    assert_eq!(
        heard,
        [
            "X driver current: 800",
            "Y driver current: 800",
            "Z driver current: 800",
            "E driver current: 800",
            "echo:M906 ignored: X and Y move one belt and need the same value",
            "echo:M906 ignored: X1800 is out of range (100 to 1700), stays 800",
            "echo:M906 ignored: E99 is out of range (100 to 1700), stays 800",
            "X driver current: 850",
            "Y driver current: 850",
            "Z driver current: 800",
            "E driver current: 500",
            "X homing sensitivity: 70",
            "Y homing sensitivity: 70",
            "Z homing sensitivity: 0",
            "E homing sensitivity: 0",
        ]
    );
}

#[test]
fn values_are_stored_and_come_back() {
    let mut eeprom = Eeprom::blank();
    let mut talk = |acts: &[&str]| {
        let drivers = Drivers::new();
        let acts = lines(acts).into();
        let (heard, interjection) = (Vec::new(), None);
        let mut host = Script { drivers: &drivers, acts, is_awaiting: false, heard, interjection, interjected: 0 };
        let mut steps = Steps::default();
        run_on(&Settings::prototype(), None, &mut eeprom, &drivers, &mut [&mut host], &mut steps).unwrap();
        let current = drivers.chip(prototype::M8).run_current_ma();
        (host.heard, current)
    };
    talk(&["M906 X950 Z333", "M569 S1 E", "M913 E40.5", "M914 Z12", "M500"]);
    let (heard, current) = talk(&["M17", "M503"]);
    for line in ["M569 S0 X Y", "M569 S1 E", "M906 X950 Y950 Z333 E800", "M913 X0 Y0 Z0 E40.5", "M914 X0 Y0 Z12 E0"] {
        assert!(heard.contains(&format!("echo:  {line}")), "{heard:?}");
    }
    assert!((current - 950.0).abs() < 16.0);
    let (_, current) = talk(&["M17", "M502", "M569 S0"]);
    assert!((current - 800.0).abs() < 16.0, "the defaults reach motors that have power: {current}");
    let (_, current) = talk(&["M17", "M502", "M501", "M569 S0"]);
    assert!((current - 950.0).abs() < 16.0);
}
