//! Tests of every board: its table, its connectors and its README agree.

use super::*;
use corehbot::kinematics::{Groups, Mechanism};
use corehbot::motors::{Coupling, prototype};
use corehbot::port::GroupSet;
use corehbot::settings::{Settings, Tachometer};
use corehbot_wiring::port_writes::StepWrites;
use corehbot_wiring::{Board, Pin, Port};
use std::path::Path;

fn corehbot() -> Coupling {
    Groups::new(&Mechanism::corehbot()).coupling()
}

/// The stores of a board's steps, with the prototype plugged in.
pub(crate) fn step_writes(board: &'static Board) -> StepWrites {
    let usual = board.usual();
    StepWrites::pulses(usual.step_pins(), usual.slow(), &corehbot())
}

/// The ports that a step of motors 1 and 8 is stored to, and those of motors 4 and 11. One port makes both steps.
pub(crate) fn ports_of_pairs(board: &'static Board) -> [Vec<Port>; 2] {
    let (machine, writes) = (corehbot(), step_writes(board));
    [[prototype::M1, prototype::M8], [prototype::M4, prototype::M11]].map(|pair| {
        let wanted = pair.map(|m| 1 << m.number()).iter().sum::<u8>();
        let groups = (0..32).map(GroupSet).find(|groups| machine.motors(*groups).0 == wanted);
        let values = writes.of(groups.unwrap());
        let used = writes.ports.iter().zip(values).filter(|(_, value)| **value != 0);
        assert_eq!(used.clone().map(|(_, value)| value.count_ones()).sum::<u32>(), 2);
        used.map(|(port, _)| *port).collect()
    })
}

/// The rows of all tables in the READMEs that describe a board: its own, and that of a board with the same sockets.
fn readme_of(entry: &Entry) -> Vec<Vec<String>> {
    let alike = entries().filter(|other| other.board.sockets == entry.board.sockets);
    let texts = alike.map(|other| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(other.board.connectors.key).join("README.md");
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    });
    let rows = texts.flat_map(|text| text.lines().map(str::to_owned).collect::<Vec<_>>());
    rows.filter(|row| row.starts_with('|'))
        .map(|row| row.split('|').map(|cell| cell.trim().to_owned()).collect())
        .collect()
}

/// Whether a row has a cell that begins with `name`, and behind it cells that end with `pins`.
fn has(row: &[String], name: &str, pins: &[Pin]) -> bool {
    let begins = |cell: &String| cell.split(' ').next() == Some(name);
    let ends = |(cell, pin): (&String, &Pin)| cell.split(' ').next_back() == Some(&pin_name(*pin));
    row.windows(1 + pins.len()).any(|cells| begins(&cells[0]) && cells[1..].iter().zip(pins).all(ends))
}

fn pin_name(pin: Pin) -> String {
    format!("P{:?}{}", pin.port, pin.number())
}

#[test]
fn every_table_is_sound() {
    for entry in entries() {
        assert_eq!(entry.board.problem(), None, "{}", entry.board.name);
    }
}

#[test]
fn connectors_offer_what_the_table_has() {
    for board in entries().map(|entry| entry.board) {
        let connectors = board.connectors;
        assert_eq!(connectors.outputs, board.outputs());
        assert!(connectors.sensors.iter().eq(board.thermistors.iter().map(|thermistor| &thermistor.sensor)));
        assert!(connectors.fans.iter().copied().eq(board.fans.iter().map(|fan| fan.timer.number())), "{}", board.name);
    }
}

#[test]
fn any_input_of_a_board_with_fans_may_have_a_tachometer() {
    for connectors in entries().map(|entry| entry.board.connectors).filter(|board| !board.fans.is_empty()) {
        for name in connectors.inputs {
            let tachometer = Tachometer::at(name.as_str());
            assert!(
                tachometer.is_some_and(|at| at.input() == *name),
                "{name} in Tachometer (src/settings/fan_plugs.rs)"
            );
        }
    }
}

#[test]
fn names_and_pins_are_those_of_the_readme() {
    for entry in entries() {
        let (board, readme) = (entry.board, readme_of(entry));
        let is_told = |name: &str, pins: &[Pin]| {
            let (key, pins_told) = (board.connectors.key, pins.iter().map(|pin| pin_name(*pin)).collect::<Vec<_>>());
            let is_there = readme.iter().any(|row| has(row, name, pins));
            assert!(is_there, "boards/{key}/README.md has no row with {name} and behind it {pins_told:?}");
        };
        for (name, slot) in board.connectors.sockets.iter().zip(board.sockets) {
            match slot.uart {
                Some(uart) => is_told(name.as_str(), &[slot.step, slot.dir, slot.enable, uart]),
                None => is_told(name.as_str(), &[slot.step, slot.dir]),
            }
        }
        if let (Some(name), Some(pins)) = (board.connectors.accelerometer, board.accelerometer) {
            is_told(name, &[pins.clock, pins.miso, pins.mosi, pins.select]);
        }
        for (name, pin) in board.connectors.supply_switches.iter().zip(board.supply_pins) {
            is_told(name.as_str(), &[*pin]);
        }
        for (name, input) in board.connectors.inputs.iter().zip(board.inputs) {
            let (pin, circuit) = (pin_name(input.pin), input.circuit.name());
            let is_told =
                |row: &Vec<String>| has(row, name.as_str(), &[input.pin]) && row.iter().any(|cell| cell == circuit);
            let key = board.connectors.key;
            assert!(readme.iter().any(is_told), "boards/{key}/README.md has no row with {name}, {pin}, {circuit}");
        }
    }
}

#[test]
fn no_board_has_a_name_twice() {
    for board in all() {
        assert!(board.debug_sockets.iter().all(|name| board.sockets.contains(name)));
        for names in [board.sockets, board.inputs, board.supply_switches] {
            assert!(names.iter().all(|name| names.iter().filter(|other| *other == name).count() == 1));
            assert!(names.iter().all(|name| !name.is_none()));
        }
        assert_eq!(all().filter(|other| other.key == board.key).count(), 1);
        assert_eq!(called(board.key), Some(board));
    }
}

#[test]
fn the_prototype_is_plugged_into_an_octopus() {
    let machine = Settings::prototype();
    assert_eq!(machine.wiring, corehbot::settings::Wiring::usual(&octopus::CONNECTORS));
    for board in [&octopus::CONNECTORS, &sim::CONNECTORS] {
        assert_eq!(machine.check_connectors(board), Ok(()));
    }
}

/// A machine on the simulator may have any connector; a machine file without a board may too.
#[test]
fn the_simulator_takes_what_no_board_takes() {
    assert!(entries().all(|entry| !entry.board.connectors.is_simulated));
    for any in [sim::CONNECTORS, BoardConnectors::ANY] {
        assert!(any.is_simulated && any.is_bench, "{}", any.key);
    }
}

/// Printed outputs and inputs are beyond the table, each once, and outputs that nothing drives stay low.
#[test]
fn what_is_printed_and_not_driven_is_beyond_the_table() {
    for entry in entries() {
        let (board, printed) = (entry.board, entry.printed);
        for (name, pin) in printed.heaters {
            assert!(board.heaters.iter().all(|heater| heater.pin != *pin), "{name}");
            assert!(board.loads.contains(pin), "{name} of the {} is not held low", board.name);
            assert!(printed.has(board, Job::Heater, *pin));
        }
        for (name, pin) in printed.sensors {
            assert!(board.thermistors.iter().all(|sensor| sensor.pin != *pin), "{name}");
            assert!(printed.has(board, Job::Sensor, *pin));
        }
        for slot in board.sockets {
            for pin in [Some(slot.step), Some(slot.dir), Some(slot.enable), slot.uart].into_iter().flatten() {
                let is_slow = pin.is_of_debug_port() || pin.is_slow();
                assert!(is_slow || !printed.is_of_header(pin), "{}: {}", board.name, pin_name(pin));
            }
            assert!(printed.has(board, Job::Step, slot.step) && !printed.has(board, Job::Step, slot.enable));
        }
        let pins: Vec<_> = printed.heaters.iter().chain(printed.sensors).map(|(_, pin)| *pin).collect();
        assert!(pins.iter().enumerate().all(|(at, pin)| !pins[..at].contains(pin) && !printed.is_of_header(*pin)));
    }
}
