//! Values of single motors: a machine file gives them, M906 I and M914 I change them, M500 stores them.

use super::script::{LONG_MOVE, Script, Steps, act, lines, say};
use corehbot::motors::{Motor, prototype};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot_machine_file as machine_file;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::tmc2209;
use corehbot_sim::world::{Outcome, run_on};

/// What a machine of this file has said after these lines, without every `ok`, and its drivers.
fn talk_to(eeprom: &mut Eeprom, settings: &Settings, acts: &[&str]) -> (Vec<String>, Drivers, Outcome) {
    let drivers = Drivers::new();
    let mut host = Script {
        drivers: &drivers,
        acts: lines(acts).into(),
        is_awaiting: false,
        heard: Vec::new(),
        interjection: None,
        interjected: 0,
    };
    let outcome = run_on(settings, None, &mut *eeprom, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
    let heard = std::mem::take(&mut host.heard).into_iter().filter(|line| line != "ok").collect();
    drop(host);
    (heard, drivers, outcome)
}

fn said(file: &str, acts: &[&str]) -> Vec<String> {
    let (heard, ..) = talk_to(&mut Eeprom::blank(), &machine_file::load(file).unwrap(), acts);
    heard.into_iter().filter(|line| ["M9", "driver ", "sensitivity"].iter().any(|part| line.contains(part))).collect()
}

fn is_near(drivers: &Drivers, motor: Motor, milliamperes: f64) -> bool {
    (drivers.chip(motor).run_current_ma() - milliamperes).abs() < 16.0
}

const ONE_SCREW: &str = "[drivers.z]\nstall_threshold = 20\n[drivers.z1]\ncurrent_ma = 600\nstall_threshold = 70\n";

/// A machine with two motors on one axis, and one on each other.
const CARTESIAN: &str = include_str!("../../../../examples/machines/cartesian.toml");

#[test]
fn drivers_get_the_values_of_their_motor() {
    let settings = machine_file::load(ONE_SCREW).unwrap();
    let (heard, drivers, _) = talk_to(&mut Eeprom::blank(), &settings, &["M17", "M122"]);
    assert!(is_near(&drivers, prototype::Z1, 600.0) && is_near(&drivers, prototype::Z2, 800.0));
    let thresholds = [prototype::Z1, prototype::Z2, prototype::M1].map(|m| drivers.chip(m).register(tmc2209::SGTHRS));
    assert_eq!(thresholds, [70, 20, 0]);
    let has = |part: &str| heard.iter().any(|line| line.contains(part));
    assert!(has("Driver z1: configured, motor on, 6") && has("Driver z2: configured, motor on, 795 mA"), "{heard:?}");
}

/// The currents at rest and the threshold are in registers that nothing reads back: IFCNT counts their writes.
#[test]
fn hold_currents_threshold_and_interpolation_come_back_after_a_loss_of_power() {
    let file = "[drivers.belt]\ninterpolate = false\nstealth = true\nhybrid_threshold = 100\n\
                [drivers.z]\nhold_percent = 60\n[drivers.z1]\nhold_percent = 90\n";
    let (settings, drivers) = (machine_file::load(file).unwrap(), Drivers::new());
    let dip = |drivers: &Drivers| Motor::ALL.into_iter().for_each(|motor| drivers.chip(motor).reset());
    let acts = vec![say("M17"), say("M122"), say("M84"), act(dip), say("M17"), say("M122")];
    let mut host = Script {
        drivers: &drivers,
        acts: acts.into(),
        is_awaiting: false,
        heard: Vec::new(),
        interjection: None,
        interjected: 0,
    };
    run_on(&settings, None, NoStorage, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
    let heard = std::mem::take(&mut host.heard);
    drop(host);
    let hold = |motor| drivers.chip(motor).register(tmc2209::IHOLD_IRUN) & 0x1F;
    // 26 parts of the full scale run; 50, 90 and 60 % of them, less one.
    assert_eq!([prototype::M1, prototype::Z1, prototype::Z2].map(hold), [12, 22, 14]);
    let interpolates =
        |motor| drivers.chip(motor).register(tmc2209::chopconf::ADDRESS) & tmc2209::chopconf::INTPOL != 0;
    assert_eq!([prototype::M1, prototype::M11, prototype::Z1].map(interpolates), [false, false, true]);
    let threshold = |motor| drivers.chip(motor).register(tmc2209::TPWMTHRS);
    assert_eq!([prototype::M4, prototype::Z1].map(threshold), [93, 0]);
    let said = |line: &str| heard.iter().filter(|heard| *heard == line).count();
    let m1 = "Driver m1: configured, motor on, 795 mA, stealthChop up to 100.80 mm/s, 16 plain microsteps, \
              40.00 mm a turn, 397 mA at rest";
    let z1 = "Driver z1: configured, motor on, 795 mA, spreadCycle, 16 microsteps, 4.00 mm a turn, 703 mA at rest";
    assert_eq!((said(m1), said(z1)), (2, 2), "{heard:#?}");
}

#[test]
fn own_values_change_under_way_and_change_no_step() {
    let settings = Settings::prototype();
    let (.., quiet) = talk_to(&mut Eeprom::blank(), &settings, &LONG_MOVE);
    let acts = [LONG_MOVE[0], "M906 I1 Z600", "M914 I0 Z33", "M400"];
    let (heard, drivers, outcome) = talk_to(&mut Eeprom::blank(), &settings, &acts);
    assert_eq!((outcome.ticks, outcome.counts), (quiet.ticks, quiet.counts), "{heard:?}");
    assert!(is_near(&drivers, prototype::Z1, 800.0) && is_near(&drivers, prototype::Z2, 600.0));
    assert_eq!([prototype::Z1, prototype::Z2].map(|m| drivers.chip(m).register(tmc2209::SGTHRS)), [33, 0]);
}

#[test]
fn a_line_sets_one_driver_or_the_group_and_tells_of_those_that_do_not_follow() {
    let axes = |z: u16| {
        [("X", 800), ("Y", 800), ("Z", z), ("E", 800)]
            .map(|(axis, current)| format!("{axis} driver current: {current}"))
    };
    let own = "z1 driver current: 600".to_owned();
    let acts = ["M906 I0 Z600", "M906", "M906 Z900", "M906", "M906 I0 Z0", "M906", "M906 I-1 Z700", "M906 I1"];
    let (default, one) = (axes(800).to_vec(), [own]);
    let expected = [&default[..], &one, &one, &axes(900), &one, &axes(900), &axes(700)];
    assert_eq!(said("", &acts), expected.concat());
    // A threshold of its own has nothing to do with the current.
    let heard = said(ONE_SCREW, &["M914 I1 Z40", "M906 I0 Z0", "M914 Z30"]);
    assert_eq!(heard, ["z1 homing sensitivity: 70", "z2 homing sensitivity: 40"]);
}

#[test]
fn a_driver_that_is_not_there_and_an_illegal_value_are_refused() {
    let absent = "echo:M906 ignored: there is no driver of an axis";
    let heard = said("", &["M906 I2 Z600", "M906 I1 Z600 E600", "M906 I0.5 Z600", "M906 I2", "M906 I1 X600"]);
    assert_eq!(heard, [format!("{absent} 2"), format!("{absent} 1"), format!("{absent} 0.5")], "each once a print");
    let heard = said("", &["M906 I1 Z99", "M914 I1 Z256", "M914 I1 Z-1", "M906", "M914"]);
    let ignored = [
        "echo:M906 ignored: Z99 is out of range (100 to 1700), stays 800",
        "echo:M914 ignored: Z256 is out of range (1 to 255), stays 0",
        "echo:M914 ignored: Z-1 is out of range (1 to 255), stays 0",
    ];
    assert_eq!(heard[..3], ignored);
    assert_eq!(heard.len(), 3 + 4 + 4, "no motor has a value of its own: {heard:?}");
    // The motors of the belt have one current, whichever is named.
    let heard = said("", &["M906 I0 X700", "M906"]);
    assert_eq!(heard[..2], ["X driver current: 700", "Y driver current: 700"]);
}

#[test]
fn axes_with_a_motor_each_may_have_different_currents() {
    let heard = said(CARTESIAN, &["M906 I0 X600 Y700", "M906 X900 Y850", "M503"]);
    assert_eq!(heard[0], "echo:M906 ignored: X and Y move one belt and need the same value");
    let lines = ["M906 X800 Y800 Z800 E800", "M906 I0 X600", "M906 I0 Y700"];
    assert_eq!(
        heard.iter().filter(|line| line.contains("echo:  M906")).collect::<Vec<_>>(),
        lines.map(|line| format!("echo:  {line}")).iter().collect::<Vec<_>>()
    );
}

#[test]
fn own_values_are_stored_come_back_and_can_be_sent_back() {
    let mut eeprom = Eeprom::blank();
    let settings = machine_file::load(ONE_SCREW).unwrap();
    let mut talk = |acts: &[&str]| talk_to(&mut eeprom, &settings, acts);
    let (heard, ..) = talk(&["M906 I1 Z450", "M914 I0 Z0", "M500"]);
    assert!(heard.iter().any(|line| line.starts_with("echo:Settings Stored")), "{heard:?}");
    // Off and on again.
    let (heard, drivers, _) = talk(&["M17", "M503"]);
    assert!(is_near(&drivers, prototype::Z1, 600.0) && is_near(&drivers, prototype::Z2, 450.0));
    let own: Vec<_> = heard.iter().filter(|line| line.contains(" I")).map(String::as_str).collect();
    assert_eq!(own, ["echo:  M906 I0 Z600", "echo:  M906 I1 Z450"]);
    let (_, drivers, _) = talk(&["M17", "M502", "M569 S0"]);
    assert!(is_near(&drivers, prototype::Z2, 800.0), "the machine of the file");
    assert_eq!(drivers.chip(prototype::Z1).register(tmc2209::SGTHRS), 70);
    let (_, drivers, _) = talk(&["M17", "M502", "M501", "M569 S0"]);
    assert!(is_near(&drivers, prototype::Z2, 450.0));
    assert_eq!(drivers.chip(prototype::Z1).register(tmc2209::SGTHRS), 20);
    // The lines of M503 S0 make the same of a machine without own values.
    let lines_of = |heard: &[String]| -> Vec<String> {
        heard.iter().filter_map(|line| line.strip_prefix("  ")).map(str::to_owned).collect()
    };
    let lines = lines_of(&talk(&["M503 S0"]).0);
    let acts: Vec<&str> = lines.iter().map(String::as_str).chain(["M503 S0"]).collect();
    let (again, ..) = talk_to(&mut Eeprom::blank(), &Settings::prototype(), &acts);
    assert!(lines.len() > 20 && lines_of(&again) == lines, "{lines:#?} {again:#?}");
}

/// Motors that move two axes have no place on one of them.
#[test]
fn a_value_that_no_line_sets_is_told_as_a_comment() {
    let file =
        include_str!("../../../../examples/machines/awd-corexy.toml").to_owned() + "[drivers.m4]\ncurrent_ma = 650\n";
    let heard = said(&file, &["M906 I0 X700", "M906 I1 X500", "M503"]);
    assert_eq!(heard[..2], ["m4 driver current: 650", "echo:M906 ignored: there is no driver of an axis 1"]);
    assert!(heard.contains(&"echo:; M906 of motor m4: 650".to_owned()), "{heard:?}");
    assert!(heard.contains(&"echo:  M906 X700 Y700 Z800 E800".to_owned()), "{heard:?}");
}
