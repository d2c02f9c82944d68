//! The wiring of the bench rig: a Nucleo-F446RE with a CNC shield v3, four drivers, no Z and no extruder.
//!
//! Arduino names are on the shield. Motors 1 and 8 step on GPIOA, motors 4 and 11 on GPIOB, and one line gives
//! power to all. The host is on USART2, which the ST-LINK has as a USB serial port.

use crate::{Entry, Printed};
use corehbot::connectors::{BoardConnectors, ConnectorName, OutputSet};
use corehbot_wiring::{Board, Crystal, Input, Pin, Port, SensorPins, SerialPort, Slot, Usart};

/// The names printed on the shield, of sockets and limit inputs.
pub const CONNECTORS: BoardConnectors = BoardConnectors {
    key: "nucleo",
    name: "CNC shield",
    sockets: &ConnectorName::all(["X", "Y", "A", "Z"]),
    inputs: &ConnectorName::all(["X", "Y", "Z"]),
    shared_inputs: &[],
    debug_sockets: &[],
    outputs: OutputSet::NONE,
    sensors: &[],
    fans: &[],
    supply_switches: &[],
    has_servo: false,
    accelerometer: Some("CN7"),
    is_bench: true,
    is_simulated: false,
};

/// The board.
pub static BOARD: Board = Board {
    name: "Nucleo-F446RE",
    connectors: &CONNECTORS,
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
    // X, Y and Z limits: D9, D10, D11, straight to the pins (Protoneer's shield v3.00).
    inputs: &[Input::plain(Port::C, 7), Input::plain(Port::B, 6), Input::plain(Port::A, 7)],
    thermistors: &[],
    loads: &[],
    heaters: &[],
    fans: &[],
    supply_pins: &[],
    servo: None,
    // The first four pins of the morpho connector CN7 (UM1724): the shield has PB3 to PB5.
    accelerometer: Some(SensorPins {
        clock: Pin::new(Port::C, 10),
        miso: Pin::new(Port::C, 11),
        mosi: Pin::new(Port::C, 12),
        select: Pin::new(Port::D, 2),
    }),
    // The ST-LINK's virtual serial port.
    serial: &[SerialPort { usart: Usart::Two, tx: Pin::new(Port::A, 2), rx: Pin::new(Port::A, 3), baud: 250_000 }],
    // The processor's USB pins lead to a pin header (UM1724, morpho connector CN10), not to a connector.
    has_usb: false,
    eeprom: None,
    has_144_pins: false,
    marks: &[],
};

/// The way of an image onto it: the ST-LINK writes to the start of flash, and there is no bootloader.
pub const ENTRY: Entry = Entry {
    board: &BOARD,
    chip: "STM32F446RETx",
    start: 0x0800_0000,
    has_card_slot: false,
    before_dfu: "",
    // A0 to A5, and the limit inputs (UM1724, Arduino connectors; Protoneer's shield v3.00).
    printed: Printed::headers(&[(Port::A, &[0, 1, 4, 7]), (Port::B, &[0, 6]), (Port::C, &[0, 1, 7])]),
};

/// A socket; D8 enables all of them, and the shield has no line to a driver's UART.
const fn slot(step: (Port, u8), dir: (Port, u8)) -> Slot {
    let (step, dir) = (Pin::new(step.0, step.1), Pin::new(dir.0, dir.1));
    Slot { step, dir, enable: Pin::new(Port::A, 9), uart: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::ports_of_pairs;
    use corehbot::motors::prototype;
    use corehbot::port::MotorSet;

    #[test]
    fn each_pair_steps_by_one_store_and_no_driver_can_be_talked_to() {
        assert_eq!(ports_of_pairs(&BOARD), [[Port::A], [Port::B]]);
        assert_eq!(BOARD.usual().uarts(), MotorSet::NONE);
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
