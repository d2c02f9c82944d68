//! Settings in storage: kept, found again, and rejected when damaged.

use super::talk::{keep, talk};
use corehbot::settings::Settings;
use corehbot::storage::{PAGE, STRIDE};
use corehbot_sim::eeprom::Eeprom;

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
    assert!(stored.contains(&"echo:  M205 X8 Y8 E5 S0 T0 Z3000".to_owned()), "{heard:?}");
    assert!(stored.contains(&"echo:  M113 S7".to_owned()), "{heard:?}");
    assert!(defaults.contains(&"echo:  M203 X300 Y300 Z20 E80".to_owned()), "{heard:?}");
    assert!(defaults.contains(&"echo:  M205 J0.013 E5 S0 T0 Z3000".to_owned()), "{heard:?}");
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
    let bytes = receipts[0].trim_start_matches("echo:Settings Stored (").split(' ').next().unwrap();
    assert_eq!(once, bytes.parse::<u32>().unwrap().div_ceil(PAGE as u32), "a write for each page of {bytes} bytes");
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
    eeprom.cells()[STRIDE as usize + 50] ^= 4;
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
    let there = "X:20.00 Y:10.00 Z:2.00 E:4.00 C:0.00 Count A:4800 B:1600 Z:3200";
    let further = "X:30.00 Y:10.00 Z:2.00 E:6.00 C:0.00 Count A:";
    assert_eq!(told[..2], [there, there]);
    assert_eq!(told[2], format!("{further}6400 B:3200 Z:3200"));
    assert_eq!(told[3], format!("{further}3200 B:1600 Z:1600"));
    assert_eq!(told[4], "X:10.50 Y:0.00 Z:0.00 E:5.00 C:0.00 Count A:840 B:840 Z:0");
    // u = x + y drives motor 11: 30 mm at 80, 10 mm at 160, and back by 29.5 mm at 80 steps/mm; E likewise.
    assert_eq!(outcome.counts[3], 30 * 80 + 10 * 160 - (40 * 80 - 840));
    assert_eq!(outcome.counts[6], 4 * 400 + 2 * 200 - 400);
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
