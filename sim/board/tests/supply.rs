//! The switch of the power supply as a machine has it.

use crate::common::heat_talk::{machine, talk_with};
use corehbot::connectors::{ConnectorName, Heater};
use corehbot::port::NoStorage;
use corehbot_rig::plant::{HeaterFault, SensorFault};

/// Whether the supply is on at the end, and the hotend's temperature: it heats, then its sensor breaks and its switch
/// sticks.
fn stuck_behind_a_lost_sensor(switch: &str) -> (bool, f64) {
    let mut settings = machine(&[Heater::Hotend]);
    settings.supply.switch = ConnectorName::lit(switch);
    let mut end = (true, 0.0);
    let (heard, _) = talk_with(&settings, NoStorage, 60_000, &["M104 S200"], |now, world| {
        let is_supplied = world.heat().is_supplied();
        let Some(plant) = world.heat().plant() else { return };
        if now >= 30_000 {
            plant.faults().hotend_sensor = SensorFault::Open;
            plant.faults().hotend_heater = HeaterFault::STUCK_ON;
        }
        end = (is_supplied, plant.hotend_celsius());
    });
    assert!(heard.iter().any(|line| line.contains("[E01]")), "{heard:?}");
    end
}

#[test]
fn a_machine_with_a_switch_cools_and_one_without_heats_on() {
    for switch in ["auto", "PS-ON", "PE7"] {
        let (is_supplied, celsius) = stuck_behind_a_lost_sensor(switch);
        println!("{switch}: {celsius:.0} C");
        assert!(!is_supplied && celsius < 120.0, "{switch}: {celsius} C");
    }
    let (is_supplied, celsius) = stuck_behind_a_lost_sensor("none");
    println!("none: {celsius:.0} C");
    assert!(is_supplied && celsius > 150.0, "{celsius} C");
}
