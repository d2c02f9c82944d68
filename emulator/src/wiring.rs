//! Wiring: the job of each pin of the chip on the board, and the part connected to it.
//!
//! It is taken from the board's schematic and not from the firmware. So an image that has mixed up two pins does not
//! find the same mistake here. Each board has a [`Wiring`] in [`ALL`], and `tests/machines.rs` runs its image on it.

use corehbot::connectors::{Output, Sensor};
use corehbot::motors::{EndstopSet, MOTORS, Motor, MotorSet, per_motor, prototype};
use corehbot::settings::Settings;

/// Ports of the chip, GPIOA to GPIOH.
pub const PORTS: usize = 8;

/// A pin of the chip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pin {
    /// 0 is GPIOA.
    pub port: usize,
    /// 0 to 15.
    pub bit: u8,
}

impl Pin {
    /// Pin `bit` of port `letter`, which is upper case.
    #[must_use]
    pub const fn new(letter: char, bit: u8) -> Self {
        assert!(letter.is_ascii_uppercase() && (letter as usize - 'A' as usize) < PORTS && bit < 16);
        Self { port: letter as usize - 'A' as usize, bit }
    }

    /// The pin's bit in its port.
    #[must_use]
    pub const fn mask(self) -> u16 {
        1 << self.bit
    }
}

impl std::fmt::Display for Pin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.port as u8), self.bit)
    }
}

/// A motor's driver slot.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    /// The motor on it.
    pub motor: Motor,
    /// A rising edge is a step.
    pub step: Pin,
    /// High turns the motor forward.
    pub dir: Pin,
    /// Low gives it power.
    pub enable: Pin,
    /// The driver's UART, if the board has a line to it.
    pub uart: Option<Pin>,
}

/// A timer that drives pins.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Timer {
    /// TIM1.
    One,
    /// The complementary outputs of TIM1.
    OneComplementary,
    /// TIM2.
    Two,
    /// TIM3.
    Three,
    /// TIM4.
    Four,
    /// TIM5.
    Five,
    /// TIM9.
    Nine,
    /// TIM12.
    Twelve,
}

impl Timer {
    /// The alternate function that connects a pin to the timer (STM32F446 datasheet, table of alternate functions).
    #[must_use]
    pub const fn function(self) -> u64 {
        match self {
            Self::One | Self::OneComplementary | Self::Two => 1,
            Self::Three | Self::Four | Self::Five => 2,
            Self::Nine => 3,
            Self::Twelve => 9,
        }
    }

    /// Where its registers begin (RM0390 rev 6, section 2.2.2).
    #[must_use]
    pub const fn base(self) -> u64 {
        match self {
            Self::One | Self::OneComplementary => 0x4001_0000,
            Self::Two => 0x4000_0000,
            Self::Three => 0x4000_0400,
            Self::Four => 0x4000_0800,
            Self::Five => 0x4000_0C00,
            Self::Nine => 0x4001_4000,
            Self::Twelve => 0x4000_1800,
        }
    }

    /// Whether `address` is in its block of 1 KiB.
    #[must_use]
    pub const fn has(self, address: u64) -> bool {
        address & !0x3FF == self.base()
    }
}

/// A pin that switches a heater or a fan on when it is high.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Load {
    /// The pin.
    pub pin: Pin,
    /// The timer that may drive it, and its channel there.
    pub timer: Option<(Timer, u8)>,
}

impl Load {
    const fn new(letter: char, bit: u8, timer: Timer, channel: u8) -> Self {
        Self { pin: Pin::new(letter, bit), timer: Some((timer, channel)) }
    }
}

/// A serial port's divisor register (RM0390 rev 6, section 25.6.8).
pub const BRR: u64 = 0x08;

/// A serial port for a host.
#[derive(Clone, Copy, Debug)]
pub struct HostPort {
    /// Its place among the part's ports.
    pub place: usize,
    /// Its base address (RM0390 rev 6, section 2.2.2).
    pub base: u64,
    /// It is on APB2, else on APB1.
    pub is_on_apb2: bool,
}

/// The source of the high-speed oscillator (HSE), and its rate in Hz.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Hse {
    /// A crystal, which the oscillator drives.
    Crystal(u64),
    /// The clock of another chip: the oscillator is to be bypassed (RM0390 rev 6, section 6.2.1).
    Clock(u64),
}

impl Hse {
    /// The rate in Hz.
    #[must_use]
    pub const fn hz(self) -> u64 {
        match self {
            Self::Crystal(hz) | Self::Clock(hz) => hz,
        }
    }
}

/// Where a board keeps settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingsMemory {
    /// An AT24C32 on I2C1.
    Eeprom,
    /// Sectors 1 and 2 of the processor's flash.
    Flash,
}

/// A socket and an input beside those of the prototype.
#[derive(Clone, Copy, Debug)]
pub struct Spare {
    /// The name of the socket.
    pub socket: &'static str,
    /// Its step and direction pins, enable line and UART.
    pub pins: [Pin; 4],
    /// The name of the input, and its pin.
    pub input: (&'static str, Pin),
}

/// The way from a connector to a pin.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Circuit {
    /// A closed contact connects the pin to ground.
    ToGround,
    /// A closed contact lights an optocoupler with its transistor on 3.3 V.
    OptocouplerTo3V3,
}

impl Circuit {
    /// What the board does to the pin: nothing while the contact is open.
    #[must_use]
    pub fn level(self, is_closed: bool) -> Option<bool> {
        is_closed.then_some(self == Self::OptocouplerTo3V3)
    }
}

/// The connector of an accelerometer on SPI3.
#[derive(Clone, Copy, Debug)]
pub struct SensorPins {
    /// SCK.
    pub clock: Pin,
    /// From the sensor.
    pub miso: Pin,
    /// To the sensor.
    pub mosi: Pin,
    /// Low selects the sensor.
    pub select: Pin,
}

/// The probe's pin on a board, and its circuit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ProbeInput {
    /// The pin.
    pub pin: Pin,
    circuit: Circuit,
    /// The contact opens when the probe triggers.
    opens: bool,
}

impl ProbeInput {
    /// The level that the probe gives the pin.
    #[must_use]
    pub fn level(self, has_triggered: bool) -> Option<bool> {
        self.circuit.level(has_triggered != self.opens)
    }
}

/// A board with an STM32F446.
#[derive(Clone, Copy, Debug)]
pub struct Wiring {
    /// The board's name.
    pub name: &'static str,
    /// One slot a motor, in the order of [`Motor::ALL`]; a bench rig has no slot for some.
    pub slots: [Option<Slot>; MOTORS],
    /// A pressed endstop is high: a normally closed switch to ground with a pull-up, so a cut wire stops
    /// the machine.
    pub endstops: [(EndstopSet, Pin); 3],
    /// Connectors for a contact without a resistor of the board.
    pub bare_inputs: &'static [(&'static str, Pin, Circuit)],
    /// Outputs that heat when they are high, and their timer.
    pub heaters: &'static [(Output, Load)],
    /// FAN0 and so on.
    pub fans: &'static [Load],
    /// PS_ON, which switches the power supply of heaters, fans and motors unless a machine says otherwise.
    pub supply_switch: Option<Pin>,
    /// The line of a servo, which only a machine with a BLTouch has driven.
    pub servo: Option<Pin>,
    /// The connector of an accelerometer.
    pub sensor: Option<SensorPins>,
    /// Levels that resistors on the board give to pins that nothing drives.
    pub resistors: &'static [(Pin, bool)],
    /// Thermistors, and their channels of ADC3.
    pub thermistors: &'static [(Sensor, u8)],
    /// Where the firmware begins, behind the bootloader.
    pub application: u32,
    /// Serial ports for hosts.
    pub host_ports: &'static [HostPort],
    /// A socket that has no motor of the prototype, by its name, and an input that has no switch of it.
    pub spare: Option<Spare>,
    /// The source of the high-speed clock.
    pub hse: Hse,
    /// Where settings are kept.
    pub settings: SettingsMemory,
}

/// The line that switches the power supply.
#[derive(Clone, Copy, Debug)]
pub struct SupplyLine {
    /// Its pin.
    pub pin: Pin,
    /// The supply is on while the pin is driven high, else while it is driven low.
    pub is_on_high: bool,
}

impl Wiring {
    /// The line that switches the supply of a machine; without one it is always on.
    #[must_use]
    pub fn supply(&self, settings: &Settings) -> Option<SupplyLine> {
        let pin = match settings.supply.switch.as_str() {
            "none" | "" => None,
            "auto" | "PS-ON" => self.supply_switch,
            // P, the letter of the port, and a number.
            name => name
                .get(1..2)
                .and_then(|port| port.chars().next())
                .zip(name.get(2..)?.parse().ok())
                .map(|(port, number)| Pin::new(port, number)),
        };
        pin.map(|pin| SupplyLine { pin, is_on_high: settings.supply.is_on_high })
    }

    /// The board of that name.
    #[must_use]
    pub fn called(name: &str) -> Option<&'static Self> {
        ALL.into_iter().find(|board| board.name == name)
    }

    /// The input of the machine's probe, if it has one and the board has a bare input of that name.
    #[must_use]
    pub fn probe(&self, settings: &Settings) -> Option<ProbeInput> {
        let plug = settings.probe_plug;
        let input = self.bare_inputs.iter().find(|(name, ..)| *name == plug.connector.as_str());
        input.map(|&(_, pin, circuit)| ProbeInput { pin, circuit, opens: !plug.is_normally_open })
    }

    /// The motors that the board has a slot for.
    #[must_use]
    pub fn motors(&self) -> MotorSet {
        self.slots.iter().flatten().fold(MotorSet::NONE, |all, slot| all.with(MotorSet::of(slot.motor)))
    }
}

/// Every board.
pub static ALL: [&Wiring; 5] = [&OCTOPUS, &OCTOPUS_PRO, &SPIDER, &SPIDER_V1, &NUCLEO];

const fn slot(motor: Motor, step: Pin, dir: Pin, enable: Pin, uart: Pin) -> Option<Slot> {
    Some(Slot { motor, step, dir, enable, uart: Some(uart) })
}

/// A board's rail in mV.
pub const RAIL: u32 = 3300;

/// The voltage of a thermistor at room temperature in mV: 100 kOhm at 25 C under 4.7 kOhm from 3.3 V.
pub const ROOM: u32 = 3152;

/// BTT Octopus V1.0 and V1.1. Motors 1, 8, 4, 11 are in slots M0, M4, M1, M3, the ball screws in M2 and M5 and the
/// extruder in M6. The Raspberry Pi header is USART2 and the TFT header USART1.
pub static OCTOPUS: Wiring = Wiring {
    name: "octopus",
    slots: per_motor(
        &[
            slot(prototype::M1, Pin::new('F', 13), Pin::new('F', 12), Pin::new('F', 14), Pin::new('C', 4)),
            slot(prototype::M4, Pin::new('G', 0), Pin::new('G', 1), Pin::new('F', 15), Pin::new('D', 11)),
            slot(prototype::M8, Pin::new('F', 9), Pin::new('F', 10), Pin::new('G', 2), Pin::new('F', 2)),
            slot(prototype::M11, Pin::new('G', 4), Pin::new('C', 1), Pin::new('A', 0), Pin::new('C', 7)),
            slot(prototype::Z1, Pin::new('F', 11), Pin::new('G', 3), Pin::new('G', 5), Pin::new('C', 6)),
            slot(prototype::Z2, Pin::new('C', 13), Pin::new('F', 0), Pin::new('F', 1), Pin::new('E', 4)),
            slot(prototype::E0, Pin::new('E', 2), Pin::new('E', 3), Pin::new('D', 4), Pin::new('E', 1)),
        ],
        None,
    ),
    endstops: [
        (EndstopSet::X, Pin::new('G', 6)),
        (EndstopSet::Y, Pin::new('G', 9)),
        (EndstopSet::Z, Pin::new('G', 10)),
    ],
    bare_inputs: &[
        ("BLTOUCH", Pin::new('B', 7), Circuit::ToGround),
        ("PROBE", Pin::new('B', 7), Circuit::OptocouplerTo3V3),
    ],
    heaters: &[
        (Output::Bed, Load::new('A', 1, Timer::Five, 2)),
        (Output::He0, Load::new('A', 2, Timer::Five, 3)),
        (Output::He1, Load::new('A', 3, Timer::Five, 4)),
        (Output::He2, Load { pin: Pin::new('B', 10), timer: None }),
        (Output::He3, Load { pin: Pin::new('B', 11), timer: None }),
    ],
    fans: &[
        Load::new('A', 8, Timer::One, 1),
        Load::new('E', 5, Timer::Nine, 1),
        Load::new('D', 12, Timer::Four, 1),
        Load::new('D', 13, Timer::Four, 2),
        Load::new('D', 14, Timer::Four, 3),
        Load::new('D', 15, Timer::Four, 4),
    ],
    // 10 kOhm to 3.3 V.
    supply_switch: Some(Pin::new('E', 11)),
    servo: Some(Pin::new('B', 6)),
    // Header SPI3, straight to the pins.
    sensor: Some(SensorPins {
        clock: Pin::new('B', 3),
        miso: Pin::new('B', 4),
        mosi: Pin::new('B', 5),
        select: Pin::new('A', 15),
    }),
    // Enable lines have 10 kOhm to 3.3 V and heaters 10 kOhm to ground: the check for the right board reads them.
    resistors: &[
        (Pin::new('F', 14), true),
        (Pin::new('F', 15), true),
        (Pin::new('G', 5), true),
        (Pin::new('G', 2), true),
        (Pin::new('F', 1), true),
        (Pin::new('A', 0), true),
        (Pin::new('A', 1), false),
        (Pin::new('A', 2), false),
        (Pin::new('A', 3), false),
        (Pin::new('B', 10), false),
        (Pin::new('B', 11), false),
    ],
    thermistors: &[
        (Sensor::Bed, 9),
        (Sensor::Hotend0, 14),
        (Sensor::Hotend1, 15),
        (Sensor::Hotend2, 4),
        (Sensor::Hotend3, 5),
    ],
    application: 0x0800_8000,
    host_ports: &[
        HostPort { place: 1, base: 0x4000_4400, is_on_apb2: false },
        HostPort { place: 0, base: 0x4001_1000, is_on_apb2: true },
    ],
    // The direction line of M7 is the clock of the debug port.
    spare: Some(Spare {
        socket: "M7",
        pins: [Pin::new('E', 6), Pin::new('A', 14), Pin::new('E', 0), Pin::new('D', 3)],
        input: ("E3DET", Pin::new('G', 15)),
    }),
    hse: Hse::Crystal(12_000_000),
    settings: SettingsMemory::Eeprom,
};

/// BTT Octopus Pro V1.0 with an STM32F446: the same pins, except for a PROBE header of its own (BTT's README of the
/// Octopus Pro).
pub static OCTOPUS_PRO: Wiring = Wiring {
    name: "octopus-pro",
    bare_inputs: &[
        ("BLTOUCH", Pin::new('B', 7), Circuit::ToGround),
        ("PROBE", Pin::new('C', 5), Circuit::OptocouplerTo3V3),
    ],
    ..OCTOPUS
};

/// Fysetc Spider V2.2 and V2.3. Motors 1, 8, 4, 11 are in X-MOT, E2-MOT, Y-MOT, Z-MOT, the ball screws in E3-MOT and
/// E4-MOT and the extruder in E0-MOT. The Raspberry Pi header is USART1 (Fysetc's README, pin definition). PB0 and PB1
/// are TB and TE4 with 4.7 kOhm to 3.3 V; no other resistor is known. Ports F and G have no pins.
pub static SPIDER: Wiring = Wiring {
    name: "spider",
    slots: per_motor(
        &[
            slot(prototype::M1, Pin::new('E', 11), Pin::new('E', 10), Pin::new('E', 9), Pin::new('E', 7)),
            slot(prototype::M4, Pin::new('D', 8), Pin::new('B', 12), Pin::new('D', 9), Pin::new('E', 15)),
            slot(prototype::M8, Pin::new('E', 2), Pin::new('E', 4), Pin::new('E', 3), Pin::new('C', 15)),
            slot(prototype::M11, Pin::new('D', 14), Pin::new('D', 13), Pin::new('D', 15), Pin::new('D', 10)),
            slot(prototype::Z1, Pin::new('D', 12), Pin::new('C', 4), Pin::new('E', 8), Pin::new('A', 15)),
            slot(prototype::Z2, Pin::new('E', 1), Pin::new('E', 0), Pin::new('C', 5), Pin::new('D', 11)),
            slot(prototype::E0, Pin::new('D', 5), Pin::new('D', 6), Pin::new('D', 4), Pin::new('D', 7)),
        ],
        None,
    ),
    endstops: [
        (EndstopSet::X, Pin::new('B', 14)),
        (EndstopSet::Y, Pin::new('B', 13)),
        (EndstopSet::Z, Pin::new('A', 0)),
    ],
    bare_inputs: &[("Z-MAX", Pin::new('A', 3), Circuit::ToGround)],
    heaters: &[
        (Output::Bed, Load::new('B', 4, Timer::Three, 1)),
        (Output::He0, Load::new('B', 15, Timer::Twelve, 2)),
        (Output::He1, Load::new('C', 8, Timer::Three, 3)),
        (Output::He2, Load { pin: Pin::new('B', 3), timer: None }),
    ],
    fans: &[
        Load { pin: Pin::new('A', 13), timer: None },
        Load { pin: Pin::new('A', 14), timer: None },
        Load::new('B', 2, Timer::Two, 4),
    ],
    supply_switch: None,
    servo: None,
    sensor: None,
    resistors: &[(Pin::new('B', 0), true), (Pin::new('B', 1), true)],
    thermistors: &[(Sensor::Bed, 13), (Sensor::Hotend0, 10), (Sensor::Hotend1, 11), (Sensor::Hotend2, 12)],
    application: 0x0800_8000,
    host_ports: &[HostPort { place: 0, base: 0x4001_1000, is_on_apb2: true }],
    // The direction pin of E1-MOT is a slow one.
    spare: Some(Spare {
        socket: "E1-MOT",
        pins: [Pin::new('E', 6), Pin::new('C', 13), Pin::new('E', 5), Pin::new('C', 14)],
        input: ("X-MAX", Pin::new('A', 1)),
    }),
    hse: Hse::Crystal(12_000_000),
    settings: SettingsMemory::Eeprom,
};

/// Fysetc Spider V1.0 to V2.1: FAN0 and FAN1 are PB0 and PB1 (Fysetc's README, pin definition of V1.x).
pub static SPIDER_V1: Wiring = Wiring {
    name: "spider-v1",
    fans: &[
        Load::new('B', 0, Timer::OneComplementary, 2),
        Load::new('B', 1, Timer::OneComplementary, 3),
        Load::new('B', 2, Timer::Two, 4),
    ],
    resistors: &[],
    ..SPIDER
};

/// A socket of the CNC shield. D8 is the one enable line for all; no line leads to a driver's UART.
const fn socket(motor: Motor, step: Pin, dir: Pin) -> Option<Slot> {
    Some(Slot { motor, step, dir, enable: Pin::new('A', 9), uart: None })
}

/// Nucleo-F446RE with a CNC shield v3. Motors 1, 4, 8, 11 are in sockets X, Y, A, Z; the ball screws and the extruder
/// have no socket. On the shield, step and direction are D2 and D5 (X), D3 and D6 (Y), D12 and D13 (A), D4 and D7 (Z).
/// Limits are D9, D10, D11 (Protoneer's shield v3.00, as `protoneer_3.xx_map.h` of grblHAL has it). UM1724, Arduino
/// connectors of the NUCLEO-F446RE, maps these to pins. The ST-LINK drives the oscillator's input with 8 MHz, and has
/// USART2 as a serial port (UM1724, OSC clock and USART communication). No bootloader.
pub static NUCLEO: Wiring = Wiring {
    name: "nucleo",
    slots: per_motor(
        &[
            socket(prototype::M1, Pin::new('A', 10), Pin::new('B', 4)),
            socket(prototype::M4, Pin::new('B', 3), Pin::new('B', 10)),
            socket(prototype::M8, Pin::new('A', 6), Pin::new('A', 5)),
            socket(prototype::M11, Pin::new('B', 5), Pin::new('A', 8)),
        ],
        None,
    ),
    endstops: [(EndstopSet::X, Pin::new('C', 7)), (EndstopSet::Y, Pin::new('B', 6)), (EndstopSet::Z, Pin::new('A', 7))],
    bare_inputs: &[],
    heaters: &[],
    fans: &[],
    supply_switch: None,
    servo: None,
    // CN7 of the morpho connector, pins 1 to 4 (UM1724).
    sensor: Some(SensorPins {
        clock: Pin::new('C', 10),
        miso: Pin::new('C', 11),
        mosi: Pin::new('C', 12),
        select: Pin::new('D', 2),
    }),
    resistors: &[],
    thermistors: &[],
    application: 0x0800_0000,
    host_ports: &[HostPort { place: 1, base: 0x4000_4400, is_on_apb2: false }],
    spare: None,
    hse: Hse::Clock(8_000_000),
    settings: SettingsMemory::Flash,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_functions_share_a_pin() {
        for board in ALL {
            let slots: Vec<Slot> = board.slots.into_iter().flatten().collect();
            let mut pins: Vec<Pin> = slots.iter().flat_map(|s| [s.step, s.dir]).collect();
            pins.extend(slots.iter().filter_map(|s| s.uart));
            // One line may give power to all motors.
            let mut enables: Vec<Pin> = slots.iter().map(|s| s.enable).collect();
            enables.dedup();
            pins.extend(enables);
            pins.extend(board.endstops.map(|(_, pin)| pin));
            pins.extend(board.heaters.iter().map(|(_, load)| load.pin));
            pins.extend(board.fans.iter().map(|load| load.pin));
            pins.extend(board.supply_switch);
            pins.extend(board.servo);
            pins.extend(board.sensor.iter().flat_map(|pins| [pins.clock, pins.miso, pins.mosi, pins.select]));
            if let Some(spare) = board.spare {
                pins.extend(spare.pins);
                pins.push(spare.input.1);
            }
            for (i, a) in pins.iter().enumerate() {
                assert!(!pins[i + 1..].contains(a), "{a} twice");
            }
        }
        assert_eq!(OCTOPUS.slots[0].map(|slot| slot.step.to_string()).as_deref(), Some("PF13"));
    }

    #[test]
    fn every_board_has_a_schematic_here() {
        let keys = corehbot_boards::entries().map(|entry| entry.board.connectors.key);
        assert!(keys.eq(ALL.iter().map(|board| board.name)));
    }

    #[test]
    fn slots_stand_in_the_order_of_the_motors() {
        for board in ALL {
            let motors = board.slots.iter().zip(Motor::ALL);
            assert!(
                motors.filter_map(|(slot, motor)| slot.map(|slot| (slot, motor))).all(|(s, motor)| s.motor == motor)
            );
        }
        let printers = ALL.iter().filter(|board| !board.heaters.is_empty());
        assert!(printers.into_iter().all(|board| board.motors() == prototype::ALL));
        assert_eq!(NUCLEO.motors(), prototype::BELT);
    }
}
