//! A second sensor on a heater: in M105, in the machine's faults, and broken by an accident.

use crate::common::heat_talk::{machine, talk_with};
use corehbot::connectors::{Heater, Sensor};
use corehbot::port::NoStorage;
use corehbot::settings::{SensorSource, Settings};
use corehbot::units::Celsius;
use corehbot_sim::accident::Accident;

/// A bed with a second sensor in its mat, which may be so hot.
fn settings(most: i32) -> Settings {
    let mut settings = machine(&[Heater::Bed]);
    let [.., second] = &mut settings.thermal.sensors;
    (second.is_fitted, second.sensor) = (true, SensorSource::At(Sensor::Hotend2));
    (second.guards, second.most) = (Some(Heater::Bed), Celsius::from_num(most));
    settings
}

fn talk(settings: &Settings, ms: u64, lines: &[&str], accident: Option<&str>) -> Vec<String> {
    let accident: Option<Accident> = accident.map(|text| text.parse().unwrap());
    talk_with(settings, NoStorage, ms, lines, |now, world| {
        if let (Some(accident), Some(plant)) = (&accident, world.heat().plant())
            && now >= ms / 2
        {
            accident.happen(plant.faults());
        }
    })
    .0
}

#[test]
fn m105_has_it_and_at_its_limit_the_bed_gets_no_power() {
    let reading = |heard: &[String], letter: &str| -> f64 {
        let line = heard.iter().rfind(|line| line.starts_with("ok T") || line.starts_with("ok B")).unwrap();
        let (_, rest) = line.split_once(letter).unwrap_or_else(|| panic!("{line}"));
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let heard = talk(&settings(150), 120_000, &["M140 S80", "119000:M105"], None);
    let (bed, mat) = (reading(&heard, "B:"), reading(&heard, "R:"));
    println!("bed {bed} C, mat {mat} C");
    assert!(mat > bed + 5.0, "{heard:?}");
    let held = talk(&settings(45), 120_000, &["M140 S80", "119000:M105"], None);
    let (bed, mat) = (reading(&held, "B:"), reading(&held, "R:"));
    println!("with a limit of 45 C: bed {bed} C, mat {mat} C");
    assert!(mat < 50.0 && bed < 50.0 && !held.iter().any(|line| line.starts_with("Error:")), "{held:?}");
}

#[test]
fn a_broken_one_stops_the_bed_and_says_which_sensor_it_is() {
    let heard = talk(&settings(120), 40_000, &["M140 S60"], Some("open:second@0s"));
    let told = "Error:bed: second sensor has no valid reading [E30]: ";
    assert!(heard.iter().any(|line| line.starts_with(told)), "{heard:?}");
}
