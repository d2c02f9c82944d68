//! The simulated bed and its probe over several lives of the firmware.

use super::talk::{Steps, Talk, talk_to};
use corehbot::connectors::ConnectorName;
use corehbot::motors::MOTORS;
use corehbot::port::NoStorage;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::bed_plant::{FLOOR_MM, read};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, run_at};

/// A prototype with a contact as a probe, or a BLTouch.
fn probing(kind: ProbeKind) -> Settings {
    let mut settings = Settings::prototype();
    settings.probe_plug.connector = ConnectorName::lit("PROBE");
    settings.probe.kind = kind;
    settings.probe.offset.z = Mm::lit("-1.5");
    settings
}

/// One life of the firmware, homed at X200 Y200 Z20: the replies, the steps, and the bed for the next life.
fn life(
    settings: &Settings,
    bed: Box<BedPlant>,
    breaks: &[&str],
    lines: &[&str],
) -> (Vec<String>, [i32; MOTORS], Box<BedPlant>) {
    let (mut host, mut desk) = (Talk::new(lines), Desk::new(1));
    desk.bed = Some(bed);
    desk.probe_accidents = breaks.iter().map(|text| text.parse().unwrap()).collect();
    let start = Some([200, 200, 20].map(Mm::from_num));
    let (drivers, hosts) = (Drivers::new(), &mut [&mut host as _]);
    let outcome = run_at(&mut desk, settings, start, NoStorage, &drivers, hosts, &mut Steps::default()).unwrap();
    assert!(!outcome.halted, "{:?}", host.heard);
    (host.heard, outcome.counts, desk.bed.unwrap())
}

fn plant(settings: &Settings, setup: &BedSetup) -> Box<BedPlant> {
    Box::new(BedPlant::new(settings, setup))
}

/// The heights that G30 told.
fn heights(heard: &[String]) -> Vec<&str> {
    heard
        .iter()
        .filter(|line| line.starts_with("Bed X"))
        .filter_map(|line| line.split_once(" Z:").map(|(_, z)| z))
        .collect()
}

#[test]
fn the_probe_is_reported_as_it_touches_the_bed() {
    let lines = ["M119", "G1 Z1", "M400", "M119", "G1 Z2", "M400", "M119"];
    let (heard, outcome, _) = talk_to(&probing(ProbeKind::Switch), Some([100.0, 100.0, 5.0]), &lines);
    assert!(!outcome.halted);
    let states: Vec<_> = heard.iter().filter(|line| line.starts_with("z_probe")).collect();
    assert_eq!(states, ["z_probe: open", "z_probe: TRIGGERED", "z_probe: open"]);
}

#[test]
fn a_pin_that_is_out_at_power_up_stops_nothing() {
    let settings = probing(ProbeKind::BlTouch);
    let (_, _, bed) = life(&settings, plant(&settings, &BedSetup::of(&settings)), &[], &["M401"]);
    assert!(bed.is_out());
    let (heard, _, bed) = life(&settings, bed, &[], &["M119", "G30", "G30"]);
    assert!(heard.contains(&"z_probe: open".to_owned()), "{heard:?}");
    assert_eq!(heights(&heard), ["0.000"; 2], "{heard:?}");
    assert!(!bed.is_out());
}

#[test]
fn the_same_file_over_the_same_bed_makes_the_same_steps() {
    let settings = probing(ProbeKind::BlTouch);
    let setup = read("tilt.x=0.002,bowl=0.1,wave=0.02,noise=0.01,drift=0.01,delay=1,seed=5", &settings).unwrap();
    let file = ["G30 X100 Y100", "G30 X300 Y150", "M48 P5 X150 Y200"];
    let [first, second] = [(); 2].map(|()| life(&settings, plant(&settings, &setup), &[], &file));
    assert_eq!(heights(&first.0).len(), 2, "{:?}", first.0);
    assert_eq!((&first.0, first.1), (&second.0, second.1));
    let other = read("tilt.x=0.002,bowl=0.1,wave=0.02,noise=0.01,drift=0.01,delay=1,seed=6", &settings).unwrap();
    let third = life(&settings, plant(&settings, &other), &[], &file);
    assert_ne!(heights(&first.0), heights(&third.0));
}

/// Each accident comes between two touches, and the probe is mended later: the job ends once, nothing is damaged, and
/// the machine probes again.
#[test]
fn a_probe_that_breaks_in_a_job_ends_it_and_damages_nothing() {
    for kind in ["stuck", "dead", "early", "cut", "fallen"] {
        let settings = probing(ProbeKind::Switch);
        let breaks = [format!("{kind}:probe@30s"), "mended:probe@90s".to_owned()];
        let breaks: Vec<_> = breaks.iter().map(String::as_str).collect();
        let lines = ["M75", "G30", "G4 S40", "G30", "M110 N0", "G4 S80", "G28", "G30 X200 Y200"];
        let (heard, _, bed) = life(&settings, plant(&settings, &BedSetup::of(&settings)), &breaks, &lines);
        let count = |text: &str| heard.iter().filter(|line| line.contains(text)).count();
        assert_eq!([count("//action:cancel"), count("Error:"), count("!!")], [1, 0, 0], "{kind}: {heard:?}");
        assert_eq!(heights(&heard), ["0.000"; 2], "{kind}: {heard:?}");
        assert!(bed.deepest().is_none_or(|depth| depth.mm <= FLOOR_MM), "{kind}");
    }
}
