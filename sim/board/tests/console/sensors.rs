//! Sensors that are reported and stop nothing: without a heater (M105, M122), and of filament (M119), over saves and
//! restarts.

use super::talk::{keep, talk_to};
use super::wild_machine::lines_of;
use corehbot::connectors::{ConnectorName, Sensor};
use corehbot::settings::{SensorSource, Settings, Thermistor};
use corehbot_sim::eeprom::Eeprom;

/// The prototype with a sensor in the chamber, and a PT1000 on the board.
fn machine() -> Settings {
    let mut settings = Settings::prototype();
    let [chamber, board, ..] = &mut settings.thermal.sensors;
    (chamber.is_fitted, chamber.sensor) = (true, SensorSource::At(Sensor::Hotend1));
    (board.is_fitted, board.thermistor) = (true, Thermistor::PT1000);
    settings
}

/// The degrees of a letter of M105, and its target.
fn degrees(line: &str, letter: char) -> Option<(f64, f64)> {
    let mut words = line.split(' ').skip_while(|word| !word.starts_with(&format!("{letter}:")));
    let number = |word: Option<&str>, skip: usize| word?.get(skip..)?.parse().ok();
    Some((number(words.next(), 2)?, number(words.next(), 1)?))
}

fn temperatures(settings: &Settings) -> String {
    let (heard, ..) = talk_to(settings, None, &["G4 P100", "M105"]);
    heard.into_iter().find(|line| line.starts_with("ok ") && line.contains(':')).unwrap()
}

#[test]
fn they_stand_behind_the_heaters_with_a_target_of_zero() {
    for has_heaters in [false, true] {
        let mut settings = machine();
        settings.thermal.heaters.hotend.is_fitted = has_heaters;
        let line = temperatures(&settings);
        for letter in ['C', 'M'] {
            let (is, target) = degrees(&line, letter).unwrap();
            assert!((is - 25.0).abs() < 0.5 && target == 0.0, "{line}");
        }
        assert_eq!(degrees(&line, 'P'), None, "{line}");
        assert!(line.find(" M:") < line.find(" @:"), "{line}");
    }
}

/// A heated chamber has a sensor, so `C` is said once.
#[test]
fn a_heater_in_the_chamber_counts_before_a_sensor_there() {
    let mut settings = machine();
    settings.thermal.heaters.chamber.is_fitted = true;
    let line = temperatures(&settings);
    assert_eq!((line.matches(" C:").count(), line.matches(" M:").count()), (1, 1), "{line}");
}

/// A PT1000's range read from a thermistor of 100 kOhm is an open wire, and the reverse a short.
#[test]
fn a_broken_one_is_told_and_stops_nothing() {
    // Two sensors share an input: each reads it by its own law.
    let mut settings = machine();
    settings.thermal.sensors[1].sensor = SensorSource::At(Sensor::Hotend1);
    let (heard, ..) = talk_to(&settings, None, &["G4 P100", "M105", "M122", "M104 S0", "G1 X1 F6000", "M105"]);
    let lines: Vec<_> = heard.iter().filter(|line| line.starts_with("ok T")).collect();
    assert!(lines.iter().all(|line| line.contains(" M:open @:") && degrees(line, 'C').is_some()), "{lines:?}");
    assert!(heard.contains(&"echo:board has no reading: open".to_owned()), "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("echo:chamber 25.")), "{heard:?}");
    assert!(heard.contains(&"echo:fault: none".to_owned()), "{heard:?}");
}

/// The processor's sensor is no thermistor: its kind does not matter, and it has no share of the reference.
#[test]
fn the_processors_own_temperature_is_one_of_them() {
    let mut settings = machine();
    (settings.thermal.sensors[1].sensor, settings.thermal.sensors[2].is_fitted) = (SensorSource::Mcu, true);
    let line = temperatures(&settings);
    assert_eq!((degrees(&line, 'M'), degrees(&line, 'C').map(|(_, target)| target)), (Some((40.0, 0.0)), Some(0.0)));
    let (heard, ..) = talk_to(&settings, None, &["G4 P100", "M122"]);
    assert!(heard.contains(&"echo:board 40.00 C".to_owned()), "{heard:?}");
    assert!(!heard.iter().any(|line| line.contains("mcu")), "{heard:?}");
}

#[test]
fn they_outlive_a_save_a_restart_and_m502() {
    let mut eeprom = Eeprom::blank();
    let made = Settings::prototype();
    let mut lines = lines_of(&machine());
    lines.extend(["M105", "M502", "M105", "M501", "M105", "M500"].map(str::to_owned));
    let lines: Vec<_> = lines.iter().map(String::as_str).collect();
    let (heard, ..) = keep(&mut eeprom, &made, &lines);
    let has_board = |heard: &[String]| -> Vec<bool> {
        heard.iter().filter(|line| line.starts_with("ok T")).map(|line| line.contains(" M:")).collect()
    };
    assert_eq!(has_board(&heard), [true, false, true], "{heard:?}");
    for _ in 0..2 {
        let (heard, ..) = keep(&mut eeprom, &made, &["M105"]);
        assert_eq!(has_board(&heard), [true], "{heard:?}");
    }
}

/// The line is there while the machine has the sensor, over saves and restarts.
#[test]
fn a_filament_sensor_is_a_line_of_m119() {
    let (mut eeprom, made) = (Eeprom::blank(), Settings::prototype());
    let mut settings = made;
    settings.filament.connector = ConnectorName::lit("E0DET");
    let mut told = |settings: &Settings| {
        let (heard, ..) = keep(&mut eeprom, settings, &["G4 P100", "M119", "M500", "M501", "M119"]);
        heard.iter().filter(|line| *line == "filament: TRIGGERED").count()
    };
    assert_eq!([told(&settings), told(&settings)], [2, 2]);
    assert_eq!(told(&made), 0);
}
