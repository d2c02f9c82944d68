//! Tests of steps.

use super::*;
use crate::wiring::OCTOPUS;
use corehbot::motors::prototype;

const F: usize = 5;
const G: usize = 6;

fn port(data: u16) -> Port {
    Port { outputs: 0xFFFF, data, ..Port::default() }
}

#[test]
fn rises_until_the_first_fall_are_one_event() {
    let mut recorder = Recorder::new(&OCTOPUS);
    let on = prototype::ALL;
    recorder.store(10, F, port(1 << 12), on);
    recorder.store(100, F, port(1 << 13 | 1 << 9 | 1 << 12), on);
    recorder.store(108, G, port(1 | 1 << 4), on);
    recorder.store(300, F, port(1 << 12), on);
    recorder.store(308, G, port(0), on);
    recorder.store(400, F, port(1 << 9), on);
    let [first, second] = recorder.events[..] else { panic!("{:?}", recorder.events) };
    assert_eq!((first.at, first.steps, first.spread), (100, prototype::BELT, 8));
    assert_eq!(first.forward, MotorSet::of(prototype::M1));
    assert_eq!((second.at, second.steps), (400, MotorSet::of(prototype::M8)));
    assert_eq!(recorder.pulse, Pulse { high: 200, low: 100, set_up: 90 });
    assert_eq!((recorder.split_pairs, recorder.unpowered), (0, 0));
}

#[test]
fn a_pair_in_two_stores_is_counted_and_so_is_a_motor_without_power() {
    let mut recorder = Recorder::new(&OCTOPUS);
    recorder.store(100, F, port(1 << 13), MotorSet::of(prototype::M1));
    recorder.store(108, F, port(1 << 13 | 1 << 9), MotorSet::of(prototype::M1));
    assert_eq!(recorder.events.len(), 1);
    assert_eq!((recorder.split_pairs, recorder.unpowered), (1, 1));
}

#[test]
fn a_late_rise_is_an_event_of_its_own() {
    let mut recorder = Recorder::new(&OCTOPUS);
    recorder.store(100, F, port(1 << 13), prototype::ALL);
    recorder.store(100 + WINDOW_NS + 1, G, port(1), prototype::ALL);
    assert_eq!(recorder.events.len(), 2);
}
