//! The Z probe: touches of the bed, homing by it, and what becomes of a probe that fails.

use super::talk::{Steps, Talk};
use corehbot::connectors::ConnectorName;
use corehbot::port::NoStorage;
use corehbot::protocol::BUSY;
use corehbot::settings::{OnFailure, ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::probe::{ProbeFault, ProbeModel};
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Outcome, run_at};

/// The probe seen from the nozzle.
const OFFSET: [f64; 3] = [-40.0, 0.0, -1.5];

/// A machine with a switch as its probe, 1.5 mm below the nozzle.
fn with_probe() -> Settings {
    let mut s = Settings::prototype();
    s.probe_plug.connector = ConnectorName::lit("PROBE");
    s.probe.kind = ProbeKind::Switch;
    (s.probe.offset.x, s.probe.offset.z) = (Mm::from_num(OFFSET[0]), Mm::from_num(OFFSET[2]));
    s
}

/// The same with a BLTouch.
fn with_bltouch() -> Settings {
    let mut s = with_probe();
    s.probe.kind = ProbeKind::BlTouch;
    s
}

/// A flat bed and the probe of these settings.
fn bed(settings: &Settings) -> BedSetup {
    let mut setup = BedSetup::of(settings);
    setup.probe.offset = OFFSET;
    if settings.probe.kind == ProbeKind::BlTouch {
        setup.probe.model = ProbeModel::BlTouch { pulse_ms: 10.0 };
    }
    setup
}

/// Where the machine stands at the start, homed.
const START: Option<[f64; 3]> = Some([200.0, 200.0, 20.0]);

/// What was heard, and what became of the bed.
struct Talked {
    heard: Vec<String>,
    outcome: Outcome,
    bed: Option<Box<BedPlant>>,
}

/// A talk with a machine that stands there, over such a bed, with a probe that fails so.
fn talk_over(
    settings: &Settings,
    start: Option<[f64; 3]>,
    setup: &BedSetup,
    fault: ProbeFault,
    lines: &[&str],
) -> Talked {
    let (mut host, mut desk) = (Talk::new(lines), Desk::new(1));
    let mut plant = Box::new(BedPlant::new(settings, setup));
    plant.fail(fault);
    desk.bed = Some(plant);
    let start = start.map(|start| start.map(Mm::from_num));
    let (drivers, hosts) = (Drivers::new(), &mut [&mut host as _]);
    let outcome = run_at(&mut desk, settings, start, NoStorage, &drivers, hosts, &mut Steps::default()).unwrap();
    let heard = host.heard.into_iter().skip(2).filter(|line| line != BUSY).collect();
    Talked { heard, outcome, bed: desk.bed }
}

/// The same at the usual place over a flat bed.
fn talk(settings: &Settings, fault: ProbeFault, lines: &[&str]) -> (Vec<String>, Outcome) {
    let Talked { heard, outcome, .. } = talk_over(settings, START, &bed(settings), fault, lines);
    (heard, outcome)
}

fn count(heard: &[String], text: &str) -> usize {
    heard.iter().filter(|line| line.contains(text)).count()
}

const TRIGGERED: &str = "the probe reads as triggered above the bed. Check that it is out, its wire, and the ! of \
                         endstops.probe (M119)";

/// It ends the job, and the machine can be used again: the host stays connected, and G28 is obeyed.
fn ends_the_job(heard: &[String], why: &str) {
    assert!(heard.contains(&format!("echo:print ended, heaters are off: probing failed: {why}")), "{heard:?}");
    assert_eq!([count(heard, "//action:cancel"), count(heard, "Error:"), count(heard, "!!")], [1, 0, 0], "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:0.00 Y:0.00 Z:0.00")), "{heard:?}");
}

#[test]
fn a_probe_that_never_triggers_ends_the_job_at_the_floor() {
    let (heard, outcome) = talk(&with_probe(), ProbeFault::Dead, &["M75", "G30", "M114", "G28", "M114"]);
    assert!(!outcome.halted);
    let why = "the probe did not trigger down to Z-0.5, expected at Z1.5. Check its wire, and its offset (M851)";
    ends_the_job(&heard, why);
    // It is raised by its clearance.
    assert!(heard.iter().any(|line| line.starts_with("X:200.00 Y:200.00 Z:4.50")), "{heard:?}");
}

#[test]
fn a_probe_that_reads_as_triggered_moves_nothing_down() {
    let (heard, outcome) = talk(&with_probe(), ProbeFault::Stuck, &["M75", "G30", "M114", "G28", "M114"]);
    assert!(!outcome.halted);
    ends_the_job(&heard, TRIGGERED);
    assert!(heard.iter().any(|line| line.starts_with("X:200.00 Y:200.00 Z:20.00")), "{heard:?}");
}

#[test]
fn a_place_out_of_reach_is_refused_and_so_is_a_machine_that_is_not_homed() {
    let (heard, _) = talk(&with_probe(), ProbeFault::Dead, &["G30 X375", "G30 Y-1", "M84", "G30"]);
    // A single place may be at the very edge of the bed.
    let reach = "but from X0.00 Y0.00 to X350.00 Y417.60";
    assert_eq!(heard[0], format!("echo:ignored: the probe cannot touch at X375.00 Y200.00, {reach}"));
    assert_eq!(heard[2], format!("echo:ignored: the probe cannot touch at X160.00 Y-1.00, {reach}"));
    assert!(heard.contains(&"echo:move ignored: home its axes first (G28)".to_owned()), "{heard:?}");
}

#[test]
fn hosts_are_told_of_a_probe_if_there_is_one() {
    let lines = ["M115", "M503", "M851 Z-1.25", "M851", "M851 Z-30"];
    let (heard, _) = talk(&with_probe(), ProbeFault::Dead, &lines);
    assert!(heard.contains(&"Cap:Z_PROBE:1".to_owned()) && heard.contains(&"echo:  M851 X-40 Y0 Z-1.5".to_owned()));
    assert!(heard.contains(&"  M851 X-40 Y0 Z-1.25".to_owned()), "{heard:?}");
    assert!(heard.contains(&"echo:M851 ignored: Z-30 is out of range (-20 to 20), stays -1.25".to_owned()));
    let (heard, _) = talk(&Settings::prototype(), ProbeFault::Dead, &["M115", "M503", "G30"]);
    assert!(heard.contains(&"Cap:Z_PROBE:0".to_owned()) && count(&heard, "M851") == 0);
    assert!(heard.contains(&"echo:no probe configured, ignored".to_owned()), "{heard:?}");
}

/// The heights that G30 has told.
fn heights(heard: &[String]) -> Vec<f64> {
    heard.iter().filter_map(|line| line.strip_prefix("Bed X:")?.split("Z:").nth(1)?.parse().ok()).collect()
}

#[test]
fn a_touch_finds_the_height_of_the_bed_where_the_probe_is() {
    let s = with_probe();
    let mut setup = bed(&s);
    (setup.surface.height, setup.surface.tilt) = (0.25, [0.002, -0.001]);
    let lines = ["G30", "G30 X100 Y300", "M114"];
    let Talked { heard, bed, .. } = talk_over(&s, START, &setup, ProbeFault::None, &lines);
    assert!(heard[0].starts_with("Bed X:160.00 Y:200.00 Z:"), "{heard:?}");
    let [first, second] = heights(&heard)[..] else { panic!("{heard:?}") };
    let bed = bed.unwrap();
    // A step of z is 1.25 um, and a line tells whole um.
    for (found, place) in [(first, [160.0, 200.0]), (second, [100.0, 300.0])] {
        assert!((found - bed.height(place)).abs() <= 0.002, "{found}, {}", bed.height(place));
    }
    // The tool stays above the place.
    assert!(heard.iter().rev().any(|line| line.starts_with("X:140.00 Y:300.00 Z:6")), "{heard:?}");
}

#[test]
fn a_probe_that_triggers_early_twice_ends_the_job() {
    let (heard, outcome) = talk(&with_probe(), ProbeFault::Early, &["M75", "G30", "G28", "M114"]);
    assert!(!outcome.halted);
    let why =
        "the probe triggered 3.5 mm above the bed, expected at Z1.5. Check what it met, its wire, and home Z again";
    ends_the_job(&heard, why);
}

#[test]
fn touches_that_differ_too_much_end_the_job_with_both_values() {
    let mut s = with_probe();
    s.probe.samples = 9;
    let (heard, _) = talk(&s, ProbeFault::Noisy, &["M75", "G30", "M114"]);
    let told = heard.iter().find(|line| line.contains("probing failed: touches of the probe differ by")).unwrap();
    assert!(told.contains(" mm, allowed are 0.1 mm. "), "{told}");
}

#[test]
fn a_bltouch_finds_the_bed_by_its_pulse_and_its_pin_goes_in() {
    let s = with_bltouch();
    for pulse_ms in [10.0, 5.0] {
        let mut setup = bed(&s);
        setup.surface.height = -0.4;
        setup.probe.model = ProbeModel::BlTouch { pulse_ms };
        let lines = ["G30", "G30 X100 Y300", "M401 S1", "G30 E0", "M402", "M114"];
        let Talked { heard, bed, .. } = talk_over(&s, START, &setup, ProbeFault::None, &lines);
        let found = heights(&heard);
        assert_eq!(found.len(), 3, "{heard:?}");
        assert!(found.iter().all(|height| (height + 0.4).abs() <= 0.002), "{found:?}");
        assert!(!bed.unwrap().is_out());
    }
}

#[test]
fn an_alarm_of_a_bltouch_at_the_start_stops_nothing_and_is_reset() {
    let (heard, outcome) = talk(&with_bltouch(), ProbeFault::Alarm, &["M119", "G30", "M119"]);
    assert!(!outcome.halted);
    let states: Vec<_> = heard.iter().filter(|line| line.starts_with("z_probe")).collect();
    assert_eq!(states, ["z_probe: TRIGGERED", "z_probe: open"], "{heard:?}");
    assert_eq!(heights(&heard).len(), 1, "{heard:?}");
}

#[test]
fn a_bltouch_that_stays_triggered_ends_the_job() {
    let (heard, outcome) = talk(&with_bltouch(), ProbeFault::Stuck, &["M75", "G30", "M114", "G28", "M114"]);
    assert!(!outcome.halted);
    ends_the_job(&heard, TRIGGERED);
}

#[test]
fn a_quick_stop_during_a_touch_takes_the_probe_in() {
    let lines = ["G30", "~M410", "M114", "G4 S1"];
    let Talked { heard, bed, outcome } =
        talk_over(&with_bltouch(), START, &bed(&with_bltouch()), ProbeFault::None, &lines);
    assert!(!outcome.halted && heights(&heard).is_empty(), "{heard:?}");
    assert!(!bed.unwrap().is_out());
}

/// A machine that homes z by its probe.
fn homing(mut s: Settings) -> Settings {
    s.probe.homes_z = true;
    s
}

#[test]
fn z_is_homed_by_the_probe_in_the_middle_of_the_bed() {
    for s in [homing(with_probe()), homing(with_bltouch())] {
        let mut setup = bed(&s);
        (setup.surface.height, setup.surface.tilt) = (-30.0, [0.01, 0.0]);
        let lines = ["G28", "M114", "G30 X195 Y208.8", "G30 X295 Y208.8", "G28 Z", "G30 X195 Y208.8"];
        let Talked { heard, outcome, bed } = talk_over(&s, None, &setup, ProbeFault::None, &lines);
        assert!(!outcome.halted);
        let [first, right, again] = heights(&heard)[..] else { panic!("{heard:?}") };
        assert!(first.abs() <= 0.002 && again.abs() <= 0.002 && (right - 1.0).abs() <= 0.003, "{heard:?}");
        assert!(heard.iter().any(|line| line.starts_with("X:235.00 Y:208.80 Z:6.5")), "{heard:?}");
        assert!(!bed.unwrap().is_out());
    }
}

#[test]
fn z_is_never_homed_by_the_probe_where_the_bed_may_not_be() {
    let s = homing(with_probe());
    let lines = ["G28 Z", "G28 X Y", "G28 Z", "G28 O", "M114"];
    let Talked { heard, bed, .. } = talk_over(&s, None, &bed(&s), ProbeFault::None, &lines);
    let why = "homing failed: Z is homed at a place in X and Y, and one of them is not homed. Home them too (G28)";
    assert!(heard[0].ends_with(why), "{heard:?}");
    // Nothing was begun, so nothing ends.
    assert_eq!(count(&heard, "//action:cancel"), 0, "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:235.00 Y:208.80 Z:6.5")), "{heard:?}");
    assert!(bed.unwrap().deepest().is_none());
}

#[test]
fn a_dead_probe_ends_homing_and_the_machine_can_be_used_again() {
    let s = homing(with_probe());
    let lines = ["M75", "G28", "G1 Z5", "M108", "G1 Z5", "G28 X"];
    let (heard, outcome) = talk(&s, ProbeFault::Dead, &lines);
    assert!(!outcome.halted);
    let why = "probing failed: the probe did not trigger within 347 mm. Check that it is out, and its wire";
    assert_eq!(count(&heard, why), 1, "{heard:?}");
    // After M108 the axis without a place does not move.
    assert_eq!(count(&heard, "echo:move ignored: home its axes first (G28)"), 1, "{heard:?}");
    assert_eq!([count(&heard, "Error:"), count(&heard, "!!")], [0, 0]);
}

#[test]
fn the_repeatability_of_a_probe_with_noise_is_that_of_the_noise() {
    let s = with_probe();
    let mut setup = bed(&s);
    (setup.probe.noise, setup.probe.seed, setup.surface.height) = (0.005, 7, 0.1);
    let lines = ["M48 P50 V2", "M48 P3", "M48 P4 V0 L3"];
    let Talked { heard, .. } = talk_over(&s, START, &setup, ProbeFault::None, &lines);
    assert_eq!(heard[0], "M48 Z-Probe Repeatability Test");
    assert!(heard[1].starts_with("1 of 50: z: 0.") && heard[50].starts_with("50 of 50: z: 0."), "{heard:?}");
    let number = |line: &str, after: &str| -> f64 {
        line.split(after).nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
    };
    let [finished, mean, deviation] = &heard[51..54] else { panic!() };
    assert_eq!(finished, "Finished!");
    // Three standard errors of 50 touches, and a step.
    assert!((number(mean, "Mean: ") - 0.1).abs() <= 0.0021 + 0.00125, "{mean}");
    assert!((number(deviation, "Standard Deviation: ") - 0.005).abs() <= 0.0015, "{deviation}");
    assert!(heard.contains(&"echo:M48 ignored: P3 is out of range (4 to 50)".to_owned()), "{heard:?}");
    assert!(heard.iter().any(|line| line == "echo:M48 L is not supported by this firmware"), "{heard:?}");
}

#[test]
fn the_servo_gets_orders_by_angle_or_by_length() {
    let lines = ["M280", "M280 P0 S10", "M280 P0", "M280 P0 S1472", "M280", "M280 P0 S-1", "M280 P1 S90", "M280 S9999"];
    let (heard, _) = talk(&with_bltouch(), ProbeFault::None, &lines);
    let told: Vec<_> = heard.iter().filter(|line| *line != "ok").map(String::as_str).collect();
    let refused = "echo:M280 ignored: S9999 is out of range (0 to 2400)";
    let other = "echo:M280 ignored: the only servo is P0, of a BLTouch";
    let servo = ["echo: Servo 0: off", "echo: Servo 0: 10", "echo: Servo 0: 90"];
    assert_eq!(told, [servo[0], servo[1], servo[2], other, refused]);
}

#[test]
fn a_print_may_be_paused_instead_and_its_line_is_kept() {
    let mut s = with_probe();
    s.job.on_failure = OnFailure::Pause;
    let (heard, outcome) = talk(&s, ProbeFault::Stuck, &["M75", "G30", "~M524", "G28 X", "M114"]);
    assert!(!outcome.halted);
    assert!(heard.contains(&format!("echo:probing failed: {TRIGGERED}")), "{heard:?}");
    assert_eq!(count(&heard, "echo:print held: mend what failed, then send M24 to try the line again"), 1, "{heard:?}");
    assert_eq!([count(&heard, "//action:pause"), count(&heard, "Error:"), count(&heard, "!!")], [1, 0, 0], "{heard:?}");
    // Without a print there is nothing to pause.
    let (heard, _) = talk(&s, ProbeFault::Stuck, &["G30", "G30", "M114"]);
    assert_eq!(count(&heard, "echo:print ended, heaters are off: probing failed"), 1, "{heard:?}");
    assert_eq!(count(&heard, "echo:the print was ended"), 1, "{heard:?}");
}
