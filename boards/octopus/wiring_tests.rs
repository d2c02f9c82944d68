//! Tests of the table of the Octopus.

use super::*;
use crate::tests::ports_of_pairs;
use corehbot::kinematics::{Groups, Mechanism};
use corehbot::motors::{per_motor, prototype};
use corehbot::port::MotorSet;
use corehbot::settings::{EndstopPlug, Settings};
use corehbot_wiring::port_writes::StepWrites;

#[test]
fn every_driver_can_be_talked_to_and_each_pair_steps_by_one_store() {
    assert_eq!(BOARD.usual().uarts(), prototype::ALL);
    assert_eq!(ports_of_pairs(&BOARD), [[Port::F], [Port::G]]);
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
fn whoever_flashes_by_usb_is_warned_of_the_heaters_and_of_both_boot_pins() {
    for word in ["HE2", "HE3", "PB10", "PB11", "BOOT0", "BOOT1", "PB2"] {
        assert!(ENTRY.before_dfu.contains(word), "{word}");
    }
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
    assert_eq!((plugged.endstops, plugged.probe), (usual.endstops, None));
    // Motors 1 and z2 change places, and the switches of x and z; z1 is not fitted.
    let [m1, _, _, _, z1, z2, ..] = &mut machine.wiring.motors;
    std::mem::swap(m1, z2);
    (m1.is_reversed, *z1) = (true, *m1);
    std::mem::swap(&mut machine.wiring.endstops.x, &mut machine.wiring.endstops.z);
    machine.wiring.endstops.x.is_normally_open = true;
    machine.mechanism.rows[prototype::Z1.index()] = [0; 4];
    let plugged = BOARD.plugged(&machine).unwrap();
    let [m1, m4, m8, m11, _, z2, e0, ..] = usual.slots;
    assert_eq!(plugged.slots, per_motor(&[z2, m4, m8, m11, None, m1, e0], None));
    assert_eq!((plugged.reversed, plugged.slow()), (MotorSet::of(prototype::M1), MotorSet::of(prototype::M1)));
    let [x, y, z] = usual.endstops;
    assert_eq!(plugged.endstops, [z.input.contact(true), y, x]);
    machine.wiring.motors[0].connector = ConnectorName::lit("M7");
    assert_eq!(BOARD.plugged(&machine).unwrap().slots[0], Some(BOARD.sockets[7]));
    machine.wiring.endstops.y.connector = ConnectorName::lit("E3DET");
    assert_eq!(BOARD.plugged(&machine).unwrap().endstops[1].input, Input::plain(Port::G, 15));
    for (name, input) in [("PROBE", Input::optocoupler(Port::B, 7)), ("BLTOUCH", Input::plain(Port::B, 7))] {
        machine.probe_plug = EndstopPlug { connector: ConnectorName::lit(name), is_normally_open: true };
        assert_eq!(BOARD.plugged(&machine).unwrap().probe, Some(input.contact(true)));
    }
    machine.wiring.motors[0].connector = ConnectorName::lit("M8");
    let error = BOARD.plugged(&machine).map(|_| ()).unwrap_err();
    let text = "motor m1: the BTT Octopus has no connector M8; it has M0, M1, M2, M3, M4, M5, M6, M7";
    assert_eq!(error.to_string(), text);
}
