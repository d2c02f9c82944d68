//! The machine over the serial line: sent in pieces, joined from pieces, checked and stored.

use super::talk::{keep, talk_to};
use super::wild_machine::lines_of;
use corehbot::connectors::ConnectorName;
use corehbot::settings::Settings;
use corehbot::storage::machine_in;
use corehbot::units::Mm;
use corehbot_sim::eeprom::Eeprom;

/// The replies to these lines, except each `ok`, from the prototype with that EEPROM.
fn say(eeprom: &mut Eeprom, lines: &[String]) -> Vec<String> {
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (heard, ..) = keep(eeprom, &Settings::prototype(), &lines);
    heard.into_iter().skip(1).filter(|line| line != "ok").collect()
}

/// The machine in the answer to MACHINE_GET.
fn machine_said(heard: &[String]) -> Settings {
    let mut record = Vec::new();
    for line in heard {
        let words = line.strip_prefix("machine ").unwrap();
        if let Some(end) = words.strip_prefix("END=") {
            assert_eq!(end.parse(), Ok(record.len()));
            break;
        }
        let (at, hex) = words.strip_prefix("AT=").unwrap().split_once(" HEX=").unwrap();
        assert_eq!(at.parse(), Ok(record.len()));
        assert!(line.len() < 80, "{line}");
        record.extend((0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()));
    }
    machine_in(&record).unwrap()
}

#[test]
fn what_is_said_is_the_machine_with_what_commands_have_changed() {
    let (heard, ..) = talk_to(&Settings::prototype(), None, &["M113 S7", "MACHINE_GET"]);
    let heard: Vec<_> = heard.into_iter().filter(|line| line != "ok").collect();
    let mut machine = Settings::prototype();
    machine.keepalive_s = 7;
    assert_eq!(machine_said(&heard), machine);
}

#[test]
fn a_machine_with_the_same_motors_counts_at_once_and_is_stored() {
    let (mut eeprom, mut machine) = (Eeprom::blank(), Settings::prototype());
    machine.keepalive_s = 9;
    machine.axes.x.length = Mm::const_from_int(250);
    let mut lines = lines_of(&machine);
    lines.extend(["M113", "MACHINE_GET"].map(str::to_owned));
    let heard = say(&mut eeprom, &lines);
    assert!(heard[0].starts_with("echo:machine stored (") && heard[0].ends_with("in effect now"), "{heard:?}");
    assert_eq!(heard[1], "echo:M113 S9");
    assert_eq!(machine_said(&heard[2..]), machine);
    assert_eq!(say(&mut eeprom, &["M113".to_owned()]), ["echo:M113 S9"], "after a reset");
}

#[test]
fn a_machine_with_other_motors_waits_for_a_reset_and_is_not_written_over() {
    let (mut eeprom, mut machine) = (Eeprom::blank(), Settings::prototype());
    machine.wiring.motors.swap(0, 1);
    machine.keepalive_s = 9;
    let mut lines = lines_of(&machine);
    lines.extend(["M113", "M500"].map(str::to_owned));
    let heard = say(&mut eeprom, &lines);
    assert!(heard[0].ends_with("in effect after the next reset"), "{heard:?}");
    let waits = "echo:Settings not stored: a new machine is stored, which takes effect after the next reset";
    assert_eq!(heard[1..], ["echo:M113 S2", waits]);
    assert_eq!(eeprom.settings(), Some(machine));
}

#[test]
fn what_is_no_machine_changes_nothing() {
    let mut eeprom = Eeprom::blank();
    let first = lines_of(&Settings { keepalive_s: 5, ..Settings::prototype() });
    say(&mut eeprom, &first);
    let stored = eeprom.cells().to_vec();
    let mut twice = Settings::prototype();
    twice.wiring.motors[1] = twice.wiring.motors[0];
    let mut loose = Settings::prototype();
    loose.mechanism.rows = Default::default();
    let mut wild = Settings::prototype();
    wild.keepalive_s = 200;
    let mut unnamed = Settings::prototype();
    unnamed.wiring.motors[2].connector = ConnectorName::lit("M0");
    let refused = |eeprom: &mut Eeprom, lines: &[String]| {
        let heard = say(eeprom, lines);
        assert_eq!(heard.len(), 1, "{heard:?}");
        heard[0].strip_prefix("echo:machine not stored: ").unwrap().to_owned()
    };
    assert_eq!(refused(&mut eeprom, &lines_of(&twice)), "motor m1 and motor m4 have the same connector, M0");
    assert_eq!(refused(&mut eeprom, &lines_of(&unnamed)), "motor m1 and motor m8 have the same connector, M0");
    assert_eq!(refused(&mut eeprom, &lines_of(&loose)), "a value is outside its legal range");
    assert_eq!(refused(&mut eeprom, &lines_of(&wild)), "a value is outside its legal range");
    // A piece is missing at the end, or changed.
    let mut short = lines_of(&Settings::prototype());
    short.remove(short.len() - 2);
    assert_eq!(refused(&mut eeprom, &short), "damaged");
    let mut changed = lines_of(&Settings::prototype());
    let last = changed[3].pop();
    changed[3].push(if last == Some('0') { '1' } else { '0' });
    assert_eq!(refused(&mut eeprom, &changed), "damaged");
    assert_eq!(eeprom.cells(), stored);
}
