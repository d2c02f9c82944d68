//! Fans with a tachometer: M123, M122, and a fan that stands still.

use crate::common::heat_talk::{machine, talk_with};
use corehbot::connectors::Heater;
use corehbot::port::NoStorage;
use corehbot::settings::{Settings, Tachometer};
use corehbot_rig::plant::PlantFaults;
use corehbot_sim::eeprom::Eeprom;

/// The prototype with a hotend; the part fan is FAN0, the hotend's FAN1, the controller's FAN2. The first two have a
/// tachometer, with four pulses a turn.
fn settings() -> Settings {
    let mut settings = machine(&[Heater::Hotend]);
    settings.fans[0].tachometer = Tachometer::at("E0DET").unwrap();
    settings.fan_pulses = 4;
    settings.fans[1].tachometer = Tachometer::at("E1DET").unwrap();
    settings
}

fn talk(settings: &Settings, ms: u64, lines: &[&str], breaks: Option<fn(&mut PlantFaults)>) -> Vec<String> {
    let begin = ms / 2;
    talk_with(settings, NoStorage, ms, lines, |now, world| {
        if let (Some(breaks), Some(plant)) = (breaks, world.heat().plant())
            && now >= begin
        {
            breaks(plant.faults());
        }
    })
    .0
}

fn reports(heard: &[String]) -> Vec<&str> {
    heard.iter().map(String::as_str).filter(|line| line.starts_with("PRN1:")).collect()
}

#[test]
fn m123_has_turns_and_duties_of_the_fans_with_a_tachometer() {
    let heard = talk(&settings(), 22_000, &["M123", "M106 S127.5", "M104 S200", "20900:M123", "20950:M122"], None);
    let reports = reports(&heard);
    assert_eq!(reports[0], "PRN1:0 RPM E0:0 RPM PRN1@:0 E0@:0", "{heard:?}");
    // Half of 4800 turns at half of the duty, to a pulse in 2 s.
    let rest = reports[1].strip_suffix(" PRN1@:128 E0@:255");
    let [part, hotend] = rest.map(turns).unwrap_or_else(|| panic!("{reports:?}"));
    assert!((4770..=4800).contains(&hotend) && (2390..=2400).contains(&part), "{reports:?}");
    assert!(heard.contains(&format!("echo:fans {}", reports[1])), "{heard:?}");
    assert!(!heard.iter().any(|line| line.contains("FAN2") || line.contains("stands still")), "{heard:?}");
}

/// Turns of `PRN1:2400 RPM E0:4800 RPM`.
fn turns(report: &str) -> [u32; 2] {
    let mut numbers = report.split(' ').filter_map(|word| word.split_once(':')?.1.parse().ok());
    [numbers.next().unwrap(), numbers.next().unwrap()]
}

#[test]
fn m123_s_reports_them_by_itself_until_s0() {
    let heard = talk(&settings(), 12_000, &["M123 S2", "7000:M123 S0"], None);
    assert_eq!(reports(&heard).len(), 3, "{heard:?}");
    let heard = talk(&machine(&[Heater::Hotend]), 5_000, &["M123 S1"], None);
    assert_eq!(heard, ["ok"], "no fan, no reports");
}

/// It is told once, the print goes on, and it is told again when it has turned in between.
#[test]
fn a_part_fan_that_stands_still_is_told_and_stops_nothing() {
    let lines = ["M104 S200", "M106", "28000:M123", "28500:G1 X101 F6000", "29000:M114"];
    let heard = talk(&settings(), 30_000, &lines, Some(|faults| faults.part_fan_broken = true));
    let told = heard.iter().filter(|line| line.contains("stands still")).collect::<Vec<_>>();
    assert_eq!(told, ["echo:fan0 stands still: free it, or plug it in"], "{heard:?}");
    assert!(reports(&heard)[0].starts_with("PRN1:0 RPM "), "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:101.00")), "{heard:?}");
}

#[test]
fn a_hotend_fan_that_stands_still_halts_the_machine() {
    let lines = ["M104 S200"];
    let heard = talk(&settings(), 40_000, &lines, Some(|faults| faults.hotend_fan_broken = true));
    assert!(
        heard.iter().any(|line| line == "Error:FAN1: fan stands still [E12]: free the fan, or plug it in"),
        "{heard:?}"
    );
    assert!(!heard.iter().any(|line| line.starts_with("echo:fan1 stands")), "{heard:?}");
}

/// The same after a save and two starts: pulses of a turn are stored, and its fan gives twice as many as that.
#[test]
fn pulses_of_a_turn_outlive_a_restart() {
    let mut eeprom = Eeprom::blank();
    eeprom.save(&Settings { fan_pulses: 2, ..settings() }).unwrap();
    for _ in 0..2 {
        let (heard, _) = talk_with(&settings(), &mut eeprom, 5_000, &["M106", "4900:M123"], |_, _| {});
        assert!(heard.iter().any(|line| line.starts_with("PRN1:9")), "{heard:?}");
    }
}
