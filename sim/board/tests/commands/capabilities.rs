//! Capabilities: M115 announces one exactly if the command behind it works on that machine.
//!
//! Each has a trial: lines, and what they make the machine say or do. A host that switches its screens by a capability
//! has the same view.

use super::asker::Asker;
use super::deaf::Deaf;
use corehbot::connectors::ConnectorName;
use corehbot::port::NoStorage;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Desk, run_at};
use std::collections::BTreeMap;

/// The name of a capability, lines that need it, and the beginning of a reply that only a machine with it gives.
const TRIALS: [(&str, &[&str], &str); 34] = [
    ("EEPROM", &["M500"], "echo:Settings Stored"),
    ("CHAMBER_TEMPERATURE", &["M141 S40", "M105"], "ok C:2"),
    ("PAREN_COMMENTS", &["G1 X110 (Y300) F6000", "M114"], "X:110.00 Y:100.00"),
    ("QUOTED_STRINGS", &["M593 P\"mzv\" F60", "M593"], "  M593 X F60 D0.1 T2"),
    ("SERIAL_XON_XOFF", &["M575"], "echo:XON"),
    ("BINARY_FILE_TRANSFER", &["M28 B1"], "echo:Switching to Binary Protocol"),
    ("VOLUMETRIC", &["M200 D1.75", "M200"], "  M200"),
    ("AUTOREPORT_POS", &["M154 S1", "G4 S2", "M154 S0"], "X:100.00"),
    ("AUTOREPORT_TEMP", &["M155 S1", "G4 S2", "M155 S0"], " "),
    ("PROGRESS", &["M530 S1 L9", "M532 X5 L2"], "echo:progress"),
    ("PRINT_JOB", &["M75", "M31", "M77"], "echo:Print time"),
    ("AUTOLEVEL", &["G29", "M420"], "echo:Bed Leveling ON"),
    ("RUNOUT", &["M412"], "echo:Filament runout"),
    ("Z_PROBE", &["G30"], "Bed X:"),
    ("LEVELING_DATA", &["G29", "M420 V"], "Bilinear Leveling Grid:"),
    ("SOFTWARE_POWER", &["M80", "M81"], "echo:power is off"),
    ("TOGGLE_LIGHTS", &["M355"], "echo:Case light"),
    ("CASE_LIGHT_BRIGHTNESS", &["M355 P9"], "echo:Case light"),
    ("SDCARD", &["M20"], "Begin file list"),
    ("MULTI_VOLUME", &["M21 U"], "echo:SD card"),
    ("REPEAT", &["M808 L2", "M808"], "echo:Loop"),
    ("SD_WRITE", &["M28 a.gco", "G4", "M29"], "Writing to file"),
    ("AUTOREPORT_SD_STATUS", &["M27 S1"], "SD printing"),
    ("LONG_FILENAME", &["M33 /A"], "/"),
    ("LFN_WRITE", &["M20 L"], "Begin file list"),
    ("CUSTOM_FIRMWARE_UPLOAD", &["M20 F"], "Begin file list"),
    ("EXTENDED_M20", &["M20 T"], "Begin file list"),
    ("MOTION_MODES", &["G61", "G60"], "echo:Saved"),
    ("ARCS", &["G2 X120 Y100 I10 J0 F6000", "M114"], "X:120.00 Y:100.00"),
    ("BABYSTEPPING", &["M290 Z0.1", "M290"], "echo:Babystep Z0.10"),
    ("COOLER_TEMPERATURE", &["M143 S20", "M105"], "ok L:"),
    ("MEATPACK", &["M115 "], "[MP]"),
    ("CONFIG_EXPORT", &["M503 C"], "Config:"),
    ("BUILD_PERCENT", &["M73 P200"], "echo:M73 "),
];

/// What needs more than a line: a command that acts while another one waits (`emergencies.rs`), the messages of pauses
/// (`paused/`), and guards that no setting switches off (`heat.rs`).
const ELSEWHERE: [&str; 4] = ["EMERGENCY_PARSER", "HOST_ACTION_COMMANDS", "PROMPT_SUPPORT", "THERMAL_PROTECTION"];

fn answers_of(s: &Settings, has_storage: bool, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
    let mut desk = Desk::new(1);
    desk.bed = Some(Box::new(BedPlant::new(s, &BedSetup::of(s))));
    let start = Some([100, 100, 50].map(Mm::from_num));
    let (drivers, steps) = (Drivers::new(), &mut Deaf);
    if has_storage {
        run_at(&mut desk, s, start, &mut Eeprom::blank(), &drivers, &mut [&mut host], steps).unwrap();
    } else {
        run_at(&mut desk, s, start, NoStorage, &drivers, &mut [&mut host], steps).unwrap();
    }
    host.heard
}

#[test]
fn a_capability_is_announced_exactly_if_its_command_works() {
    let plain = Settings::prototype();
    let mut probed = plain;
    probed.probe_plug.connector = ConnectorName::lit("PROBE");
    (probed.probe.kind, probed.probe.samples) = (ProbeKind::Switch, 1);
    (probed.mesh.columns, probed.mesh.rows) = (3, 3);
    // A kind without an input is no probe.
    let mut unplugged = plain;
    unplugged.probe.kind = ProbeKind::Switch;
    let mut chamber = plain;
    chamber.thermal.heaters.chamber.is_fitted = true;
    let mut wrong = Vec::new();
    let machines = [("plain", plain, false), ("probe", probed, true), ("no input", unplugged, true)];
    for (machine, s, has_storage) in machines.into_iter().chain([("chamber", chamber, false)]) {
        let heard = answers_of(&s, has_storage, &["M115"]);
        let announced: BTreeMap<_, _> =
            heard.iter().filter_map(|line| line.strip_prefix("Cap:")?.split_once(':')).collect();
        for name in ELSEWHERE {
            assert_eq!(announced.get(name), Some(&"1"), "{machine}: {name}");
        }
        for (name, lines, reply) in TRIALS {
            let heard = answers_of(&s, has_storage, lines);
            let works = heard.iter().skip(2).any(|line| line.starts_with(reply));
            if announced.get(name) != Some(&if works { "1" } else { "0" }) {
                wrong.push(format!("{machine}: {name}: {heard:?}"));
            }
        }
        assert_eq!(announced.len(), TRIALS.len() + ELSEWHERE.len(), "{machine}: a capability without a trial");
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
