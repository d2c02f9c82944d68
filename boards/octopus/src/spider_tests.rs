//! The table of the Spider.

use crate::spider::BOARD;
use corehbot::connectors::SPIDER;
use corehbot::kinematics::{Groups, Mechanism};
use corehbot::motors::prototype;
use corehbot::port::{GroupSet, MotorSet, OutputSet};
use corehbot_stm32f446::wiring::port_writes::StepWrites;
use corehbot_stm32f446::wiring::{Pin, Port};

#[test]
fn names_and_pins_are_those_of_the_readme() {
    let readme: Vec<Vec<_>> = include_str!("../../spider/README.md")
        .lines()
        .filter(|line| line.starts_with('|'))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let pin = |pin: Pin| format!("P{:?}{}", pin.port, pin.number());
    for (name, slot) in SPIDER.sockets.iter().zip(BOARD.sockets) {
        let row = readme.iter().find(|row| row.len() == 8 && row[2] == name.as_str()).unwrap();
        let pins = [slot.step, slot.dir, slot.enable, slot.uart.unwrap()].map(pin);
        assert_eq!(row[3..7], pins, "{name}");
    }
    for (name, input) in SPIDER.endstops.iter().zip(BOARD.inputs) {
        assert!(readme.iter().any(|row| row.get(2..4) == Some(&[name.as_str(), &pin(*input)])), "{name}");
    }
}

#[test]
fn each_pair_steps_by_one_store_and_nothing_of_the_prototype_is_slow() {
    let (machine, usual) = (Groups::new(&Mechanism::corehbot()).coupling(), BOARD.usual());
    assert_eq!((usual.uarts(), usual.slow()), (MotorSet::ALL, MotorSet::NONE));
    let writes = StepWrites::pulses(usual.step_pins(), usual.slow(), &machine);
    assert_eq!(writes.beyond_quick(), GroupSet::NONE);
    for (pair, port) in [([prototype::M1, prototype::M8], Port::E), ([prototype::M4, prototype::M11], Port::D)] {
        let wanted = pair.map(|m| 1 << m.number()).iter().sum::<u8>();
        let groups = (0..32).map(GroupSet).find(|groups| machine.motors(*groups).0 == wanted);
        let values = writes.of(groups.unwrap());
        let used: Vec<_> = writes.ports.iter().zip(values).filter(|(_, value)| **value != 0).collect();
        assert_eq!((used.len(), *used[0].0, used[0].1.count_ones()), (1, port, 2));
    }
}

/// Heaters and fans are off, on either version.
#[test]
fn heaters_are_low_and_not_offered() {
    assert_eq!(BOARD.outputs(), OutputSet::NONE);
    assert_eq!(
        BOARD.safe_levels(Port::B) >> 16 & 0xFFFF,
        1 << 15 | 0b1111_1100 | 1 << 12,
        "with the direction of Y-MOT"
    );
    assert_eq!(BOARD.safe_levels(Port::C) >> 16, 1 << 8 | 1 << 4 | 1 << 13);
}
