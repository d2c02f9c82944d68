//! The wiring of the Octopus, from BTT's schematic of V1.0 and V1.1.
//!
//! Motors 1 and 8 have step and direction pins on GPIOF, motors 4 and 11 step pins on GPIOG, so each pair steps
//! by one store. The direction pin of slot M7 is the debug port's clock, until a machine has a motor there.
//!
//! Hosts: USART2 on the Raspberry Pi header, USART1 on the TFT header, and USB. `LINES` of the core allows no more.

use crate::{Entry, Printed};
use corehbot::connectors::{BoardConnectors, ConnectorName, Output, OutputSet, Sensor};
use corehbot_wiring::{
    Board, Crystal, FanPin, FanTimer, HeaterPin, HeaterTimer, Input, Mark, Pin, Port, SensorPins, SerialPort, Slot,
    ThermistorPin, Usart,
};

/// The names printed on it. M2 is one driver with two plugs. The direction line of M7 (PA14) is the clock of the debug
/// port. Left out, though printed: heater outputs HE2 and HE3, because no timer can end their pulses.
pub const CONNECTORS: BoardConnectors = BoardConnectors {
    key: "octopus",
    name: "BTT Octopus",
    sockets: &ConnectorName::all(["M0", "M1", "M4", "M3", "M2", "M5", "M6", "M7"]),
    inputs: &ConnectorName::all([
        "X-STOP", "Y-STOP", "Z-STOP", "Z2-STOP", "E0DET", "E1DET", "E2DET", "E3DET", "BLTOUCH", "PROBE",
    ]),
    shared_inputs: &[ConnectorName::all(["BLTOUCH", "PROBE"])],
    debug_sockets: &ConnectorName::all(["M7"]),
    outputs: OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1),
    sensors: &[Sensor::Bed, Sensor::Hotend0, Sensor::Hotend1, Sensor::Hotend2, Sensor::Hotend3],
    fans: &[Some(1), Some(9), Some(4), Some(4), Some(4), Some(4)],
    supply_switches: &ConnectorName::all(["PS-ON", "PE7", "PE8", "PE9", "PE10", "PE12", "PE13", "PE14", "PE15"]),
    has_servo: true,
    accelerometer: Some("SPI3"),
    is_bench: false,
    is_simulated: false,
};

/// The board.
pub static BOARD: Board = Board {
    name: "BTT Octopus V1.0 or V1.1",
    connectors: &CONNECTORS,
    crystal: Crystal::Oscillator12MHz,
    sockets: &[
        // M0: motor 1.
        Slot::new((Port::F, 13), (Port::F, 12), (Port::F, 14), (Port::C, 4)),
        // M1: motor 4.
        Slot::new((Port::G, 0), (Port::G, 1), (Port::F, 15), (Port::D, 11)),
        // M4: motor 8.
        Slot::new((Port::F, 9), (Port::F, 10), (Port::G, 2), (Port::F, 2)),
        // M3: motor 11.
        Slot::new((Port::G, 4), (Port::C, 1), (Port::A, 0), (Port::C, 7)),
        // M2: left screw.
        Slot::new((Port::F, 11), (Port::G, 3), (Port::G, 5), (Port::C, 6)),
        // M5: right screw.
        Slot::new((Port::C, 13), (Port::F, 0), (Port::F, 1), (Port::E, 4)),
        // M6: extruder.
        Slot::new((Port::E, 2), (Port::E, 3), (Port::D, 4), (Port::E, 1)),
        // M7.
        Slot::new((Port::E, 6), (Port::A, 14), (Port::E, 0), (Port::D, 3)),
    ],
    // PROBE (J40): by an EL357C, whose transistor is on the side of 3.3 V (schematic; BTT's issue 33 of the Octopus and
    // Voron-2's pull request 249: Klipper needs ~!PB7 for a sensor that opens).
    inputs: &inputs(Input::optocoupler(Port::B, 7)),
    // TB, TH0 to TH3, all on ADC3 (STM32F446 datasheet, pin definitions), under 4.7 kOhm to 3.3 V.
    thermistors: &[
        thermistor(Sensor::Bed, 3, 9),
        thermistor(Sensor::Hotend0, 4, 14),
        thermistor(Sensor::Hotend1, 5, 15),
        thermistor(Sensor::Hotend2, 6, 4),
        thermistor(Sensor::Hotend3, 7, 5),
    ],
    loads: &[
        // Bed, HE0 to HE3.
        Pin::new(Port::A, 1),
        Pin::new(Port::A, 2),
        Pin::new(Port::A, 3),
        Pin::new(Port::B, 10),
        Pin::new(Port::B, 11),
        // FAN0 to FAN5.
        Pin::new(Port::A, 8),
        Pin::new(Port::E, 5),
        Pin::new(Port::D, 12),
        Pin::new(Port::D, 13),
        Pin::new(Port::D, 14),
        Pin::new(Port::D, 15),
    ],
    // HE2 and HE3 (PB10, PB11) share channels of TIM2 with HE0 and HE1 and have no channel of TIM5. So nothing would
    // end their pulses: they stay low.
    heaters: &[heater(Output::Bed, 1), heater(Output::He0, 2), heater(Output::He1, 3)],
    fans: &[
        FanPin { pin: Pin::new(Port::A, 8), timer: FanTimer::One, channel: 1 },
        FanPin { pin: Pin::new(Port::E, 5), timer: FanTimer::Nine, channel: 1 },
        fan_on_d(1),
        fan_on_d(2),
        fan_on_d(3),
        fan_on_d(4),
    ],
    // PS_ON, with 10 kOhm to 3.3 V: a supply that hangs on it is off while the processor is in reset. Then the pins of
    // EXP1 (Klipper's generic-bigtreetech-octopus.cfg, EXP1_1 to EXP1_8).
    supply_pins: &[
        Pin::new(Port::E, 11),
        Pin::new(Port::E, 7),
        Pin::new(Port::E, 8),
        Pin::new(Port::E, 9),
        Pin::new(Port::E, 10),
        Pin::new(Port::E, 12),
        Pin::new(Port::E, 13),
        Pin::new(Port::E, 14),
        Pin::new(Port::E, 15),
    ],
    // The servo's line of BLTOUCH (J43), straight to the pin (schematic).
    servo: Some(Pin::new(Port::B, 6)),
    // SPI3, straight to the pins. PA15, PB3 and PB4 are JTAG's after a reset; a probe by two wires does without them
    // (schematic; STM32F446 datasheet, pin definitions).
    accelerometer: Some(SensorPins {
        clock: Pin::new(Port::B, 3),
        miso: Pin::new(Port::B, 4),
        mosi: Pin::new(Port::B, 5),
        select: Pin::new(Port::A, 15),
    }),
    serial: &[
        // The Raspberry Pi header.
        SerialPort { usart: Usart::Two, tx: Pin::new(Port::D, 5), rx: Pin::new(Port::D, 6), baud: 250_000 },
        // The TFT header.
        SerialPort { usart: Usart::One, tx: Pin::new(Port::A, 9), rx: Pin::new(Port::A, 10), baud: 250_000 },
    ],
    has_usb: true,
    eeprom: Some([Pin::new(Port::B, 8), Pin::new(Port::B, 9)]),
    has_144_pins: true,
    // Here PA0 is an enable line with a resistor of 10 kOhm to 3.3 V (R5) and PA2 a heater with one to ground.
    // On the Octopus Pro V1.1 PA0 is the heater, which our idle level would switch on (BTT pins of the Pro
    // V1.1).
    marks: &[Mark::up(const { &[Pin::new(Port::A, 0)] }), Mark::down(const { &[Pin::new(Port::A, 2)] })],
};

/// The way of an image onto it: behind BTT's bootloader of 32 KiB.
pub const ENTRY: Entry = Entry {
    board: &BOARD,
    chip: "STM32F446ZETx",
    start: 0x0800_8000,
    has_card_slot: true,
    // The chip's own bootloader looks for hosts on USART3 too, and pulls up these pins, the gates of two heaters
    // (AN2606, STM32F446xx configuration in system memory boot mode).
    before_dfu: "\
before you set the BOOT0 jumper: unplug HE2 and HE3, because the chip's bootloader pulls their gates (PB10, PB11) up;
BOOT1 (PB2, on EXP2) has to be low: unplug a display there, and if no bootloader shows up, bridge PB2 to ground",
    printed: Printed {
        heaters: &[("HE2", Pin::new(Port::B, 10)), ("HE3", Pin::new(Port::B, 11))],
        sensors: &[("PT100", Pin::new(Port::F, 8))],
        // Displays (EXP1, EXP2), SPI3, BLTOUCH and PROBE, PWR-DET and PS_ON, the strip, hosts, WiFi, CAN, EEPROM, card,
        // and the inputs of switches (BTT's schematic of V1.0 and V1.1).
        headers: &[
            (Port::A, &[4, 5, 6, 7, 9, 10, 11, 12, 13, 15]),
            (Port::B, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 14, 15]),
            (Port::C, &[0, 5, 8, 9, 10, 11, 12, 14, 15]),
            (Port::D, &[0, 1, 2, 5, 6, 7, 8, 9, 10]),
            (Port::E, &[7, 8, 9, 10, 11, 12, 13, 14, 15]),
            (Port::G, &[6, 7, 8, 9, 10, 11, 12, 13, 14, 15]),
        ],
        // HE0 is on PA0 there (BTT's pins of the Pro V1.1).
        namesakes: &["octopus pro v1.1"],
    },
};

/// The inputs, of which PROBE is elsewhere on other boards.
pub(crate) const fn inputs(probe: Input) -> [Input; 10] {
    [
        // X-STOP, Y-STOP, Z-STOP, Z2-STOP, E0DET to E3DET: 10 kOhm to 3.3 V, 100 nF to ground (schematic).
        Input::plain(Port::G, 6),
        Input::plain(Port::G, 9),
        Input::plain(Port::G, 10),
        Input::plain(Port::G, 11),
        Input::plain(Port::G, 12),
        Input::plain(Port::G, 13),
        Input::plain(Port::G, 14),
        Input::plain(Port::G, 15),
        // BLTOUCH (J43): straight to the pin, without a resistor of the board (schematic; BTT's issue 154 of the
        // Octopus: it floats).
        Input::plain(Port::B, 7),
        probe,
    ]
}

/// A heater on port A, where pin n is channel n + 1 of TIM5 (STM32F446 datasheet, table of alternate functions).
const fn heater(output: Output, pin: u8) -> HeaterPin {
    HeaterPin { output, pin: Pin::new(Port::A, pin), timer: HeaterTimer::Five, channel: pin + 1 }
}

/// A fan on port D, where pins 12 to 15 are the channels of TIM4 (the same table).
const fn fan_on_d(channel: u8) -> FanPin {
    FanPin { pin: Pin::new(Port::D, channel + 11), timer: FanTimer::Four, channel }
}

/// A thermistor on port F.
const fn thermistor(sensor: Sensor, pin: u8, channel: u8) -> ThermistorPin {
    ThermistorPin { sensor, pin: Pin::new(Port::F, pin), channel }
}

#[cfg(test)]
#[path = "wiring_tests.rs"]
mod tests;
