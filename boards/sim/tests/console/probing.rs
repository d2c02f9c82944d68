//! The Z probe: touches of the bed, and what becomes of a probe that fails.

use super::talk::{Steps, Talk};
use corehbot::motors::EndstopSet;
use corehbot::port::NoStorage;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::plugs::Plugs;
use corehbot_sim::world::{Desk, Outcome, run_at};

/// A machine with a switch as its probe, 1.5 mm below the nozzle.
fn with_probe() -> Settings {
    let mut s = Settings::prototype();
    s.probe.kind = ProbeKind::Switch;
    (s.probe.offset.x, s.probe.offset.z) = (Mm::from_num(-40), Mm::lit("-1.5"));
    s
}

/// The replies of a machine that stands homed at X200 Y200 Z20, with such a mistake in its wiring.
fn talk(settings: &Settings, mistake: &str, lines: &[&str]) -> (Vec<String>, Outcome) {
    let (mut host, mut desk) = (Talk::new(lines), Desk::new(1));
    desk.endstops = EndstopSet::ALL;
    let mut plugs = Plugs::default();
    plugs.make(mistake, settings).unwrap();
    desk.plugs = Some(plugs);
    let start = Some([200, 200, 20].map(Mm::from_num));
    let (drivers, hosts) = (Drivers::new(), &mut [&mut host as _]);
    let outcome = run_at(&mut desk, settings, start, NoStorage, &drivers, hosts, &mut Steps::default()).unwrap();
    (host.heard.into_iter().skip(2).collect(), outcome)
}

fn count(heard: &[String], text: &str) -> usize {
    heard.iter().filter(|line| line.contains(text)).count()
}

const DEAD: &str = "dead-endstop:probe";
const STUCK: &str = "stuck-endstop:probe";

/// It ends the job, and the machine can be used again: the host stays connected, and G28 is obeyed.
fn ends_the_job(heard: &[String], why: &str) {
    assert!(heard.contains(&format!("echo:print ended, heaters are off: probing failed: {why}")), "{heard:?}");
    assert_eq!([count(heard, "//action:cancel"), count(heard, "Error:"), count(heard, "!!")], [1, 0, 0], "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:0.00 Y:0.00 Z:0.00")), "{heard:?}");
}

#[test]
fn a_probe_that_never_triggers_ends_the_job_at_the_floor() {
    let (heard, outcome) = talk(&with_probe(), DEAD, &["M75", "G30", "M114", "G28", "M114"]);
    assert!(!outcome.halted);
    let why = "the probe did not trigger down to Z-0.5, expected at Z1.5. Check its wire, and its offset (M851)";
    ends_the_job(&heard, why);
    // It is raised by its clearance.
    assert!(heard.iter().any(|line| line.starts_with("X:200.00 Y:200.00 Z:4.50")), "{heard:?}");
}

#[test]
fn a_probe_that_reads_as_triggered_moves_nothing_down() {
    let (heard, outcome) = talk(&with_probe(), STUCK, &["M75", "G30", "M114", "G28", "M114"]);
    assert!(!outcome.halted);
    let why = "the probe reads as triggered above the bed. Check that it is out, its wire, and the ! of \
               endstops.probe (M119)";
    ends_the_job(&heard, why);
    assert!(heard.iter().any(|line| line.starts_with("X:200.00 Y:200.00 Z:20.00")), "{heard:?}");
}

#[test]
fn a_place_out_of_reach_is_refused_and_so_is_a_machine_that_is_not_homed() {
    let (heard, _) = talk(&with_probe(), DEAD, &["G30 X375", "G30 Y1", "M84", "G30"]);
    let reach = "but from X10.00 Y10.00 to X350.00 Y407.60";
    assert_eq!(heard[0], format!("echo:ignored: the probe cannot touch at X375.00 Y200.00, {reach}"));
    assert_eq!(heard[2], format!("echo:ignored: the probe cannot touch at X160.00 Y1.00, {reach}"));
    assert!(heard.contains(&"echo:move ignored: home its axes first (G28)".to_owned()), "{heard:?}");
}

#[test]
fn hosts_are_told_of_a_probe_if_there_is_one() {
    let lines = ["M115", "M503", "M851 Z-1.25", "M851", "M851 Z-30"];
    let (heard, _) = talk(&with_probe(), DEAD, &lines);
    assert!(heard.contains(&"Cap:Z_PROBE:1".to_owned()) && heard.contains(&"echo:  M851 X-40 Y0 Z-1.5".to_owned()));
    assert!(heard.contains(&"  M851 X-40 Y0 Z-1.25".to_owned()), "{heard:?}");
    assert!(heard.contains(&"echo:M851 ignored: Z-30 is out of range (-20 to 20), stays -1.25".to_owned()));
    let (heard, _) = talk(&Settings::prototype(), DEAD, &["M115", "M503", "G30"]);
    assert!(heard.contains(&"Cap:Z_PROBE:0".to_owned()) && count(&heard, "M851") == 0);
    assert!(heard.contains(&"echo:no probe configured, ignored".to_owned()), "{heard:?}");
}
