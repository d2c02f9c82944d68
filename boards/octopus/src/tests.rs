//! The image and its boards, and the table of the Octopus.

use crate::IMAGE;
use crate::wiring::{BOARD, PRO};
use corehbot::connectors::{BoardConnectors, ConnectorName, OCTOPUS};
use corehbot::kinematics::{Groups, Mechanism};
use corehbot::motors::prototype;
use corehbot::port::{EndstopSet, GroupSet, MotorSet, Output};
use corehbot::settings::Settings;
use corehbot::storage::{boards_of, choose_board};
use corehbot_stm32f446::wiring::port_writes::StepWrites;
use corehbot_stm32f446::wiring::{Image, Pin, Port};

#[test]
fn every_table_is_sound() {
    for board in IMAGE.boards {
        assert_eq!(board.problem(), None, "{}", board.name);
    }
}

#[test]
fn the_image_has_a_table_for_every_board_that_it_names() {
    let mut block = *IMAGE.block;
    assert!(boards_of(IMAGE.block).eq(IMAGE.boards.iter().map(|board| board.connectors.key)));
    assert_eq!(IMAGE.board().map(|board| board.name), Some(BOARD.name));
    for board in IMAGE.boards {
        assert!(choose_board(&mut block, board.connectors.key));
        let image = Image { block: Box::leak(Box::new(block)), ..IMAGE };
        assert_eq!(image.board().map(|board| board.name), Some(board.name));
    }
    let elsewhere = Image { boards: const { &[&PRO] }, ..IMAGE };
    assert!(elsewhere.board().is_none());
}

#[test]
fn the_core_knows_what_every_board_offers() {
    for board in IMAGE.boards {
        let connectors = board.connectors;
        // By that table the commands find a board.
        assert!(BoardConnectors::ALL.iter().any(|known| known.key == connectors.key), "{}", board.name);
        assert_eq!(connectors.outputs, board.outputs());
        assert!(connectors.sensors.iter().eq(board.thermistors.iter().map(|thermistor| &thermistor.sensor)));
        assert_eq!((connectors.fans, !connectors.probes.is_empty()), (board.fans.len(), board.probe.is_some()));
    }
}

#[test]
fn names_and_pins_are_those_of_the_readme() {
    let readme: Vec<Vec<_>> = include_str!("../README.md")
        .lines()
        .filter(|line| line.starts_with('|'))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let pin = |pin: Pin| format!("P{:?}{}", pin.port, pin.number());
    for (name, slot) in OCTOPUS.sockets.iter().zip(BOARD.sockets) {
        let is_it = |row: &&Vec<&str>| row.len() == 9 && row[3].split(' ').next() == Some(name.as_str());
        let row = readme.iter().find(is_it).unwrap();
        let pins = [slot.step, slot.dir, slot.enable, slot.uart.unwrap()].map(pin);
        assert_eq!(row[4..8], pins, "{name}");
    }
    for (name, input) in OCTOPUS.endstops.iter().zip(BOARD.inputs) {
        assert!(readme.iter().any(|row| row.get(2..4) == Some(&[name.as_str(), &pin(*input)])), "{name}");
    }
}

#[test]
fn every_driver_can_be_talked_to() {
    assert_eq!(BOARD.usual().uarts(), MotorSet::ALL);
}

#[test]
fn each_pair_steps_by_one_store() {
    let machine = Groups::new(&Mechanism::corehbot()).coupling();
    let usual = BOARD.usual();
    let writes = StepWrites::pulses(usual.step_pins(), usual.slow(), &machine);
    for (pair, port) in [([prototype::M1, prototype::M8], Port::F), ([prototype::M4, prototype::M11], Port::G)] {
        let wanted = pair.map(|m| 1 << m.number()).iter().sum::<u8>();
        let groups = (0..32).map(GroupSet).find(|groups| machine.motors(*groups).0 == wanted);
        let values = writes.of(groups.unwrap());
        let used: Vec<_> = writes.ports.iter().zip(values).filter(|(_, value)| **value != 0).collect();
        assert_eq!(used.len(), 1);
        assert_eq!((*used[0].0, used[0].1.count_ones()), (port, 2));
    }
}

#[test]
fn all_but_the_screws_step_quickly() {
    let machine = Groups::new(&Mechanism::corehbot()).coupling();
    let usual = BOARD.usual();
    let writes = StepWrites::pulses(usual.step_pins(), usual.slow(), &machine);
    let slow = machine.motors(writes.beyond_quick());
    assert_eq!(slow.0, usual.slow().0 | 1 << prototype::Z1.number(), "the right screw takes the left one along");
}

#[test]
fn all_four_belt_motors_get_power_by_three_stores() {
    let usual = BOARD.usual();
    let stores = Port::ALL.into_iter().filter(|port| usual.enable_lines(prototype::BELT, *port) != 0);
    assert_eq!(stores.collect::<Vec<_>>(), [Port::A, Port::F, Port::G]);
}

#[test]
fn at_rest_heaters_are_low_and_drivers_off() {
    let on_a = BOARD.safe_levels(Port::A);
    assert_eq!(on_a >> 16, 1 << 1 | 1 << 2 | 1 << 3 | 1 << 8 | 1 << 14, "bed, HE0, HE1, FAN0, direction of M7 low");
    assert_eq!(on_a & 0xFFFF, 1, "driver M3 off");
    assert_eq!(BOARD.safe_levels(Port::F) & 0xFFFF, 1 << 14 | 1 << 15 | 1 << 1);
}

#[test]
fn he2_and_he3_are_not_offered() {
    let offered = BOARD.outputs();
    let has = [Output::Bed, Output::He0, Output::He1, Output::He2, Output::He3].map(|output| offered.has(output));
    assert_eq!(has, [true, true, true, false, false]);
    assert_eq!(BOARD.safe_levels(Port::B) >> 16, 1 << 10 | 1 << 11, "but they have a safe level");
}

#[test]
fn a_machine_is_plugged_in_where_it_says() {
    let mut machine = Settings::prototype();
    let (plugged, usual) = (BOARD.plugged(&machine).unwrap(), BOARD.usual());
    assert_eq!((plugged.slots, plugged.reversed, plugged.slow()), (usual.slots, MotorSet::NONE, usual.slow()));
    assert_eq!(usual.slow(), MotorSet::of(prototype::Z2), "on PC13");
    assert_eq!((plugged.endstops, plugged.normally_open), (usual.endstops, EndstopSet::NONE));
    // Motors 1 and z2 change places, and the switches of x and z; z1 is not fitted.
    let [m1, _, _, _, z1, z2, _] = &mut machine.wiring.motors;
    std::mem::swap(m1, z2);
    (m1.is_reversed, *z1) = (true, *m1);
    std::mem::swap(&mut machine.wiring.endstops.x, &mut machine.wiring.endstops.z);
    machine.wiring.endstops.x.is_normally_open = true;
    machine.mechanism.rows[prototype::Z1.index()] = [0; 4];
    let plugged = BOARD.plugged(&machine).unwrap();
    let [m1, m4, m8, m11, _, z2, e0] = usual.slots;
    assert_eq!(plugged.slots, [z2, m4, m8, m11, None, m1, e0]);
    assert_eq!((plugged.reversed, plugged.slow()), (MotorSet::of(prototype::M1), MotorSet::of(prototype::M1)));
    let [x, y, z] = usual.endstops;
    assert_eq!((plugged.endstops, plugged.normally_open), ([z, y, x], EndstopSet::X));
    machine.wiring.motors[0].connector = ConnectorName::lit("M7");
    assert_eq!(BOARD.plugged(&machine).unwrap().slots[0], Some(BOARD.sockets[7]));
    machine.wiring.endstops.y.connector = ConnectorName::lit("E3DET");
    assert_eq!(BOARD.plugged(&machine).unwrap().endstops[1], Pin::new(Port::G, 15));
    machine.wiring.motors[0].connector = ConnectorName::lit("M8");
    let error = BOARD.plugged(&machine).map(|_| ()).unwrap_err();
    let text = "motor m1: the BTT Octopus has no connector M8; it has M0, M1, M2, M3, M4, M5, M6, M7";
    assert_eq!(error.to_string(), text);
}
