//! The wiring of the Fysetc Spider V2.2 and V2.3 with an STM32F446VET6 (LQFP100). V1.0 to V2.1 differ in FAN0 and FAN1
//! (`spider_v1`).
//!
//! From Fysetc's README (github.com/FYSETC/FYSETC-SPIDER), Klipper's generic-fysetc-spider.cfg, Marlin's
//! pins_FYSETC_SPIDER.h and the RepRapFirmware that Fysetc adapted (FYSETC.h), which agree. The schematic itself has
//! not been read.
//!
//! Motors 1 and 8 have step pins on GPIOE, motors 4 and 11 on GPIOD, so each pair steps by one store. The host is on
//! USART1, on the header for a Raspberry Pi, or on USB.

use crate::{Entry, Printed};
use corehbot::connectors::{BoardConnectors, ConnectorName, Output, OutputSet, Sensor};
use corehbot_wiring::{
    Board, Crystal, FanPin, FanTimer, HeaterPin, HeaterTimer, Input, Pin, Port, SerialPort, Slot, ThermistorPin, Usart,
};

/// The names printed on it: BED, E0 and E1 are the outputs BED, HE0 and HE1. Left out, though printed: E2, because no
/// timer can end its pulses.
pub const CONNECTORS: BoardConnectors = BoardConnectors {
    key: "spider",
    name: "Fysetc Spider",
    sockets: &ConnectorName::all(["X-MOT", "Y-MOT", "E2-MOT", "Z-MOT", "E3-MOT", "E4-MOT", "E0-MOT", "E1-MOT"]),
    inputs: &ConnectorName::all(["X-MIN", "Y-MIN", "Z-MIN", "X-MAX", "Y-MAX", "Z-MAX"]),
    shared_inputs: &[],
    debug_sockets: &[],
    outputs: OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1),
    sensors: &[Sensor::Bed, Sensor::Hotend0, Sensor::Hotend1, Sensor::Hotend2],
    fans: &[None; 3],
    // It has no connector for it: pins of EXP1.
    supply_switches: &ConnectorName::all(["PC9", "PC10", "PC11", "PC12", "PD0", "PD1", "PD2"]),
    has_servo: false,
    // Its header for SPI has PA5 to PA7, no pins of SPI3; PB3 to PB5 and PA15 are heaters, a strip and a driver's UART.
    accelerometer: None,
    is_bench: false,
    is_simulated: false,
};

/// The board.
pub static BOARD: Board = Board {
    name: "Fysetc Spider V2.2 or V2.3",
    connectors: &CONNECTORS,
    crystal: Crystal::Oscillator12MHz,
    sockets: &[
        // X-MOT: motor 1.
        Slot::new((Port::E, 11), (Port::E, 10), (Port::E, 9), (Port::E, 7)),
        // Y-MOT: motor 4.
        Slot::new((Port::D, 8), (Port::B, 12), (Port::D, 9), (Port::E, 15)),
        // E2-MOT: motor 8.
        Slot::new((Port::E, 2), (Port::E, 4), (Port::E, 3), (Port::C, 15)),
        // Z-MOT: motor 11.
        Slot::new((Port::D, 14), (Port::D, 13), (Port::D, 15), (Port::D, 10)),
        // E3-MOT: left screw.
        Slot::new((Port::D, 12), (Port::C, 4), (Port::E, 8), (Port::A, 15)),
        // E4-MOT: right screw.
        Slot::new((Port::E, 1), (Port::E, 0), (Port::C, 5), (Port::D, 11)),
        // E0-MOT: extruder.
        Slot::new((Port::D, 5), (Port::D, 6), (Port::D, 4), (Port::D, 7)),
        // E1-MOT, which has a slow direction pin.
        Slot::new((Port::E, 6), (Port::C, 13), (Port::E, 5), (Port::C, 14)),
    ],
    // X-MIN, Y-MIN, Z-MIN, X-MAX, Y-MAX, Z-MAX: contacts to ground (Fysetc's printer.cfg: ^ before each endstop_pin,
    // and Z-MAX in [probe]).
    inputs: &[
        Input::plain(Port::B, 14),
        Input::plain(Port::B, 13),
        Input::plain(Port::A, 0),
        Input::plain(Port::A, 1),
        Input::plain(Port::A, 2),
        Input::plain(Port::A, 3),
    ],
    // Under 4.7 kOhm to 3.3 V. TB of V1.x is TE3 of V2.2 and V2.3; their TB and TE4 (PB0, PB1) are not on ADC3.
    thermistors: &[
        thermistor(Sensor::Bed, 3, 13),
        thermistor(Sensor::Hotend0, 0, 10),
        thermistor(Sensor::Hotend1, 1, 11),
        thermistor(Sensor::Hotend2, 2, 12),
    ],
    loads: &loads([Pin::new(Port::A, 13), Pin::new(Port::A, 14)]),
    // E2 (PB3) is on TIM2 alone, which keeps the time: it stays low.
    heaters: &[
        heater(Output::Bed, Pin::new(Port::B, 4), HeaterTimer::Three, 1),
        heater(Output::He0, Pin::new(Port::B, 15), HeaterTimer::Twelve, 2),
        heater(Output::He1, Pin::new(Port::C, 8), HeaterTimer::Three, 3),
    ],
    // FAN0 and FAN1 are pins of the debug port, which no timer reaches.
    fans: &[
        FanPin { pin: Pin::new(Port::A, 13), timer: FanTimer::None, channel: 0 },
        FanPin { pin: Pin::new(Port::A, 14), timer: FanTimer::None, channel: 0 },
        FAN2,
    ],
    // EXP1_1 and EXP1_3 to EXP1_8 of Klipper's generic-fysetc-spider.cfg.
    supply_pins: &[
        Pin::new(Port::C, 9),
        Pin::new(Port::C, 10),
        Pin::new(Port::C, 11),
        Pin::new(Port::C, 12),
        Pin::new(Port::D, 0),
        Pin::new(Port::D, 1),
        Pin::new(Port::D, 2),
    ],
    servo: None,
    accelerometer: None,
    serial: &[SerialPort { usart: Usart::One, tx: Pin::new(Port::A, 9), rx: Pin::new(Port::A, 10), baud: 250_000 }],
    has_usb: true,
    eeprom: Some([Pin::new(Port::B, 8), Pin::new(Port::B, 9)]),
    has_144_pins: false,
    marks: &[],
};

/// The way of an image onto it: behind Fysetc's bootloader of 32 KiB. Only the pins of its heaters are known.
pub const ENTRY: Entry = Entry {
    board: &BOARD,
    chip: "STM32F446VETx",
    start: 0x0800_8000,
    has_card_slot: true,
    before_dfu: "\
before you set the BT0 jumper: unplug the bed and all heaters, because nobody has checked how the chip's bootloader
drives their pins (PB4, PB15, PC8, PB3); BOOT1 (PB2, FAN2) has to be low: if no bootloader shows up, bridge PB2 to ground",
    printed: Printed {
        heaters: &[E2],
        // TE3 of V2.2 is the bed's input here.
        sensors: &[("TB", Pin::new(Port::B, 0)), ("TE4", Pin::new(Port::B, 1))],
        headers: HEADERS,
        namesakes: NAMESAKES,
    },
};

/// E2, which stays low.
pub(crate) const E2: (&str, Pin) = ("E2", Pin::new(Port::B, 3));

/// The S6 has the same pins with other heaters on them, and another bootloader (Klipper's generic-fysetc-s6.cfg).
pub(crate) const NAMESAKES: &[&str] = &["fysetc s6"];

/// Displays (EXP1, EXP2), the Raspberry Pi header, the strips, the EEPROM, the debug port, and the inputs of switches
/// (Fysetc's README, its pin definition; Klipper's generic-fysetc-spider.cfg).
pub(crate) const HEADERS: &[(Port, &[u8])] = &[
    (Port::A, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14]),
    (Port::B, &[5, 6, 7, 8, 9, 10, 13, 14]),
    (Port::C, &[6, 7, 9, 10, 11, 12]),
    (Port::D, &[0, 1, 2, 3]),
];

/// FAN2, on either version.
pub(crate) const FAN2: FanPin = FanPin { pin: Pin::new(Port::B, 2), timer: FanTimer::Two, channel: 4 };

/// All heaters and fans: E0, E1, E2 and the bed, FAN2, the strips' R, G and B, and FAN0 and FAN1.
pub(crate) const fn loads([fan0, fan1]: [Pin; 2]) -> [Pin; 10] {
    [
        Pin::new(Port::B, 15),
        Pin::new(Port::C, 8),
        Pin::new(Port::B, 3),
        Pin::new(Port::B, 4),
        Pin::new(Port::B, 2),
        Pin::new(Port::B, 6),
        Pin::new(Port::B, 5),
        Pin::new(Port::B, 7),
        fan0,
        fan1,
    ]
}

/// A heater (STM32F446 datasheet, table of alternate functions).
const fn heater(output: Output, pin: Pin, timer: HeaterTimer, channel: u8) -> HeaterPin {
    HeaterPin { output, pin, timer, channel }
}

/// A thermistor on port C.
const fn thermistor(sensor: Sensor, pin: u8, channel: u8) -> ThermistorPin {
    ThermistorPin { sensor, pin: Pin::new(Port::C, pin), channel }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{ports_of_pairs, step_writes};
    use corehbot::motors::prototype;
    use corehbot::port::{GroupSet, MotorSet};

    #[test]
    fn each_pair_steps_by_one_store_and_nothing_of_the_prototype_is_slow() {
        let usual = BOARD.usual();
        assert_eq!((usual.uarts(), usual.slow()), (prototype::ALL, MotorSet::NONE));
        assert_eq!(ports_of_pairs(&BOARD), [[Port::E], [Port::D]]);
        assert_eq!(step_writes(&BOARD).beyond_quick(), GroupSet::NONE);
    }

    #[test]
    fn whoever_flashes_by_usb_is_warned_of_the_heaters_and_of_both_boot_pins() {
        for word in ["bed", "all heaters", "PB4", "PB15", "PC8", "PB3", "BT0", "BOOT1", "PB2"] {
            assert!(ENTRY.before_dfu.contains(word), "{word}");
        }
    }

    /// Heaters and fans are off at rest, on either version.
    #[test]
    fn at_rest_heaters_are_low_and_e2_is_not_offered() {
        assert_eq!(BOARD.outputs(), CONNECTORS.outputs);
        assert!(!BOARD.outputs().has(Output::He2));
        let low = |port| BOARD.safe_levels(port) >> 16;
        assert_eq!(low(Port::B), 1 << 15 | 0b1111_1100 | 1 << 12, "with the direction of Y-MOT");
        assert_eq!(low(Port::C), 1 << 8 | 1 << 4 | 1 << 13);
    }
}
