//! An image on another board than its own drives nothing and says so; on its own board it is never refused.

use crate::common::{Bench, MS, bench_of, firmware, print_on};
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::Seen;
use corehbot_emulator::usb_habits::UsbHabits;
use corehbot_emulator::watch::End;
use corehbot_emulator::wiring::{OCTOPUS, PORTS, Pin, SPIDER, SPIDER_V1, Wiring};
use corehbot_machine_file as machine_file;

/// The image for a board.
fn image(key: &str) -> Firmware {
    let mut firmware = firmware();
    firmware.set_board(key).unwrap();
    firmware
}

/// Starts the image for `key` on another board, with hosts on its headers or on USB, and a machine in its EEPROM that
/// would heat and move.
fn start(key: &str, wiring: &'static Wiring, usb: bool) -> Seen {
    let gcode = "M104 S200\nM17\nG28\n";
    let settings = machine_file::load(&format!("board = \"{key}\"\n")).unwrap();
    let bench = Bench {
        wiring,
        drivers: DriverLines::new(wiring),
        second: (wiring.host_ports.len() > 1 && !usb).then_some(gcode),
        manner: Manner { is_impatient: true, insists: true, usb: usb.then(UsbHabits::default), ..Manner::default() },
        whole: 6000 * MS,
        ..bench_of(settings)
    };
    let seen = print_on(&image(key), gcode, &bench);
    assert!(seen.safety.dangers.is_empty() && seen.safety.switched.is_empty() && !seen.safety.is_hot());
    assert!(seen.recorder.events.is_empty() && seen.heat.edges.is_empty() && seen.resets.is_empty());
    seen
}

/// How often a board has said that it is not `name`.
fn told(said: &[String], name: &str) -> usize {
    let text = format!("Error:this board is not a {name}, flash the firmware that is meant for it");
    said.iter().filter(|line| **line == text).count()
}

/// The image for an Octopus on a Spider, and the reverse: whatever a host says, nothing is driven but USART1 and USB.
#[test]
fn an_image_for_another_processor_drives_two_lines_to_hosts_and_nothing_else() {
    // A Latin square: each image and each board that is wrong for it, with the host at the UART and at USB in turn.
    for (key, name, wiring, usb) in [
        ("octopus", "BTT Octopus V1.0 or V1.1", &SPIDER, false),
        ("octopus", "BTT Octopus V1.0 or V1.1", &SPIDER_V1, true),
        ("spider", "Fysetc Spider V2.2 or V2.3", &OCTOPUS, true),
        ("spider-v1", "Fysetc Spider V1.0 to V2.1", &OCTOPUS, false),
    ] {
        let seen = start(key, wiring, usb);
        // USART1 is the first header of the Spider and the second of the Octopus.
        let others = seen.second.iter().flat_map(|second| &second.said);
        let said: Vec<_> = seen.line.said.iter().chain(others).cloned().collect();
        println!("{key} on {}: {} times", wiring.name, told(&said, name));
        assert!(told(&said, name) > 1, "{key} on {}: {said:?}", wiring.name);
        let mut lines = [0; PORTS];
        // PA9 to PA12.
        lines[0] = 0b1111_u16 << 9;
        for (port, (driven, allowed)) in seen.driven.iter().zip(lines).enumerate() {
            assert_eq!(driven & !allowed, 0, "{key} on {}: port {port}", wiring.name);
        }
    }
}

/// A V2.2 has thermistors where a V1 has fans.
#[test]
fn an_image_for_the_first_spider_is_refused_by_a_later_one() {
    let seen = start("spider-v1", &SPIDER, false);
    assert!(told(&seen.line.said, "Fysetc Spider V1.0 to V2.1") > 1, "{:?}", seen.line.said);
    assert_eq!(seen.driven[1..], [0; PORTS - 1], "no fan, no heater, no motor");
}

/// Drivers may pull their enable lines down, and hot thermistors their inputs: one line that is up is enough for an
/// Octopus, and none is needed for a Spider.
#[test]
fn the_right_board_is_known_whatever_is_plugged_in() {
    let enable = |pin: &(Pin, bool)| pin.0.port > 4;
    for kept in 0..5 {
        let mut wiring = OCTOPUS;
        let lines = OCTOPUS.resistors.iter().filter(|pin| enable(pin)).enumerate();
        let lines = lines.map(|(place, (pin, _))| (*pin, place == kept));
        let others = OCTOPUS.resistors.iter().copied().filter(|pin| !enable(pin));
        wiring.resistors = lines.chain(others).collect::<Vec<_>>().leak();
        is_known("octopus", wiring);
    }
    for levels in [[false, false], [true, false], [false, true]] {
        let [tb, te4] = levels;
        let resistors = vec![(Pin::new('B', 0), tb), (Pin::new('B', 1), te4)].leak();
        is_known("spider", Wiring { resistors, ..SPIDER });
    }
    is_known("spider-v1", SPIDER_V1);
    let gates = vec![(Pin::new('B', 0), false), (Pin::new('B', 1), false)].leak();
    is_known("spider-v1", Wiring { resistors: gates, ..SPIDER_V1 });
    // Whoever takes the table of the later Spider for an older one has two fans that stand, and everything else.
    is_known("spider", SPIDER_V1);
}

fn is_known(key: &str, wiring: Wiring) {
    let wiring: &'static Wiring = Box::leak(Box::new(wiring));
    let settings = machine_file::load(&format!("board = \"{key}\"\n")).unwrap();
    let bench = Bench { wiring, drivers: DriverLines::new(wiring), ..bench_of(settings) };
    let seen = print_on(&image(key), "M115\n", &bench);
    assert_eq!((seen.end, seen.line.failure), (End::Done, None), "{key}: {:?}", seen.line.said);
}
