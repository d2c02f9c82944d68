//! The wiring of the bench rig: a Nucleo-F446RE with a CNC shield v3, four drivers, no Z and no extruder.
//!
//! Arduino names are on the shield. Motors 1 and 8 step on GPIOA, motors 4 and 11 on GPIOB, and one line gives
//! power to all. The host is on USART2, which the ST-LINK has as a USB serial port.

use corehbot::connectors::NUCLEO;
use corehbot_stm32f446::wiring::{Board, Crystal, Pin, Port, SerialPort, Slot, Usart};

/// The board.
pub static BOARD: Board = Board {
    name: "Nucleo-F446RE",
    connectors: &NUCLEO,
    crystal: Crystal::Clock8MHz,
    sockets: &[
        // Motor 1 in socket X: D2, D5.
        slot((Port::A, 10), (Port::B, 4)),
        // Motor 4 in socket Y: D3, D6.
        slot((Port::B, 3), (Port::B, 10)),
        // Motor 8 in socket A: D12, D13.
        slot((Port::A, 6), (Port::A, 5)),
        // Motor 11 in socket Z: D4, D7.
        slot((Port::B, 5), (Port::A, 8)),
    ],
    // X, Y and Z limits: D9, D10, D11.
    inputs: &[Pin::new(Port::C, 7), Pin::new(Port::B, 6), Pin::new(Port::A, 7)],
    probe: None,
    thermistors: &[],
    loads: &[],
    heaters: &[],
    fans: &[],
    supply_switch: None,
    // The ST-LINK's virtual serial port.
    serial: &[SerialPort { usart: Usart::Two, tx: Pin::new(Port::A, 2), rx: Pin::new(Port::A, 3), baud: 250_000 }],
    // The processor's USB pins lead to a pin header (UM1724, morpho connector CN10), not to a connector.
    has_usb: false,
    eeprom: None,
    marks: &[],
};

/// A socket; D8 enables all of them, and the shield has no line to a driver's UART.
const fn slot(step: (Port, u8), dir: (Port, u8)) -> Slot {
    let (step, dir) = (Pin::new(step.0, step.1), Pin::new(dir.0, dir.1));
    Slot { step, dir, enable: Pin::new(Port::A, 9), uart: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;
    use corehbot::port::MotorSet;

    #[test]
    fn the_table_is_sound() {
        assert_eq!(BOARD.problem(), None);
        assert_eq!(BOARD.usual().uarts(), MotorSet::NONE);
    }

    #[test]
    fn names_and_pins_are_those_of_the_readme() {
        let readme: Vec<Vec<_>> = include_str!("../README.md")
            .lines()
            .filter(|line| line.starts_with('|'))
            .map(|line| line.split('|').map(str::trim).collect())
            .collect();
        let pin = |pin: Pin| format!("P{:?}{}", pin.port, pin.number());
        for (name, slot) in NUCLEO.sockets.iter().zip(BOARD.sockets) {
            let row = readme.iter().find(|row| row.len() == 7 && row[3] == name.as_str()).unwrap();
            assert!(row[4].ends_with(&pin(slot.step)) && row[5].ends_with(&pin(slot.dir)), "{name}");
        }
        for (name, input) in NUCLEO.endstops.iter().zip(BOARD.inputs) {
            let limits =
                include_str!("../README.md").lines().find(|line| line.starts_with("Limit switches: ")).unwrap();
            assert!(limits.split(',').any(|part| {
                part.contains(&format!("{name} on D")) && part.contains(&format!("({})", pin(*input)))
            }));
        }
    }

    #[test]
    fn the_core_knows_what_is_offered() {
        assert_eq!((NUCLEO.outputs, NUCLEO.sensors.len()), (BOARD.outputs(), BOARD.thermistors.len()));
        assert_eq!((NUCLEO.fans, !NUCLEO.probes.is_empty()), (BOARD.fans.len(), BOARD.probe.is_some()));
    }

    #[test]
    fn one_line_gives_power_to_all_motors_if_any_wants_it() {
        let usual = BOARD.usual();
        for motors in [MotorSet::of(prototype::M4), prototype::BELT] {
            assert_eq!(usual.enable_lines(motors, Port::A), 1 << 9);
        }
        assert_eq!(usual.enable_lines(MotorSet::NONE, Port::A), 0);
    }
}
