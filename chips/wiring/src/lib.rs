//! The wiring of a board: the job of each pin, as data. A [`Board`] is a table; [`Plugged`] is the board with a machine
//! plugged into it.
//!
//! Nothing here needs the processor or names a register. So the images, the command and a browser read the same table,
//! and it is tested on the host.
//!
//! | file | job |
//! |---|---|
//! | `lib` | a board's table |
//! | `problem` | the rules that a table keeps |
//! | `plugged` | a board with a machine |
//! | `input` | inputs for contacts, and their circuits |
//! | `image` | the boards of an image |
//! | `serial_port` | USARTs for hosts |
//! | `port_writes` | the words that set the pins of motors, by groups |
//!
//! A board's resources are limited: [`LINES`](corehbot::port::LINES) to hosts (`src/port.rs` of the core; a kind of
//! UART is a [`Usart`]), [`MOST_THERMISTORS`] of the [`Sensor`]s, [`USB`] on its pins. [`Board::problem`] reports what
//! a table has too much of.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod image;
mod input;
mod plugged;
pub mod port_writes;
mod problem;
mod serial_port;
#[cfg(test)]
mod tests;

pub use image::Image;
pub use input::{Circuit, Contact, Input};
pub use plugged::Plugged;
pub use serial_port::{SerialPort, Usart};

use core::ops::RangeInclusive;

use corehbot::connectors::BoardConnectors;
use corehbot::port::{Output, OutputSet, Sensor};

/// A GPIO port.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Port {
    /// GPIOA.
    A,
    /// GPIOB.
    B,
    /// GPIOC.
    C,
    /// GPIOD.
    D,
    /// GPIOE.
    E,
    /// GPIOF.
    F,
    /// GPIOG.
    G,
}

impl Port {
    /// Every port.
    pub const ALL: [Self; 7] = [Self::A, Self::B, Self::C, Self::D, Self::E, Self::F, Self::G];
}

/// A pin of the processor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pin {
    /// Its port.
    pub port: Port,
    /// Its number in the port.
    number: u8,
}

impl Pin {
    /// Pin `number` of `port`; a port has 16.
    #[must_use]
    pub const fn new(port: Port, number: u8) -> Self {
        assert!(number < 16, "a port has 16 pins");
        Self { port, number }
    }

    /// Its number in the port.
    #[must_use]
    pub const fn number(self) -> usize {
        self.number as usize
    }

    /// Its bit in the registers of the port.
    #[must_use]
    pub const fn mask(self) -> u32 {
        1 << self.number
    }

    /// Whether it is SWDIO or SWCLK.
    #[must_use]
    pub fn is_of_debug_port(self) -> bool {
        DEBUG.contains(&self)
    }

    /// Whether it is supplied by the power switch (PC13 to PC15), good for 2 MHz and 3 mA (STM32F446 datasheet, pin
    /// definitions).
    #[must_use]
    pub const fn is_slow(self) -> bool {
        matches!(self.port, Port::C) && self.number >= 13
    }
}

/// The pins of a motor driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Slot {
    /// A rising edge is a step.
    pub step: Pin,
    /// High is forward, unless the board says otherwise.
    pub dir: Pin,
    /// Low is on; several drivers may share one line.
    pub enable: Pin,
    /// The driver's UART, if it is connected; a driver without runs as its jumpers say.
    pub uart: Option<Pin>,
}

impl Slot {
    /// The slot with these pins, each a port and a number, of a driver that has a UART.
    #[must_use]
    pub const fn new(step: (Port, u8), dir: (Port, u8), enable: (Port, u8), uart: (Port, u8)) -> Self {
        let (step, dir) = (Pin::new(step.0, step.1), Pin::new(dir.0, dir.1));
        Self { step, dir, enable: Pin::new(enable.0, enable.1), uart: Some(Pin::new(uart.0, uart.1)) }
    }

    /// Whether a line of it is one of the debug port: it is left to that port until a machine has a motor here.
    #[must_use]
    pub fn is_of_debug_port(&self) -> bool {
        self.step.is_of_debug_port() || self.dir.is_of_debug_port()
    }
}

/// Levels that tell boards apart: `pins` read against their internal resistors.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Mark {
    /// Inputs, one after the other with its internal resistor.
    pub pins: &'static [Pin],
    /// The internal resistor pulls up, else down.
    pub is_pulled_up: bool,
    /// Whether one of them is high on the expected board.
    pub is_high: bool,
}

impl Mark {
    /// A resistor on the board pulls one of `pins` up, against the internal one.
    #[must_use]
    pub const fn up(pins: &'static [Pin]) -> Self {
        Self { pins, is_pulled_up: false, is_high: true }
    }

    /// A resistor on the board pulls all of `pins` down, against the internal ones.
    #[must_use]
    pub const fn down(pins: &'static [Pin]) -> Self {
        Self { pins, is_pulled_up: true, is_high: false }
    }

    /// Nothing on the board pulls one of `pins` up against the internal resistor.
    #[must_use]
    pub const fn not_up(pins: &'static [Pin]) -> Self {
        Self { pins, is_pulled_up: false, is_high: false }
    }
}

/// Pins that only the package with 144 pins has. On both Octopuses they are the enable lines of M0, M1, M2, M4 and M5,
/// with 10 kOhm to 3.3 V (BTT's schematic). In a smaller package nothing is connected to them, and the internal
/// resistor alone gives the level. Read with a pull-down of 30 to 50 kOhm (STM32F446 datasheet, I/O static
/// characteristics), an enable line has 2.5 V or more, and its driver stays off. No register tells packages apart
/// (RM0390, device electronic signature).
pub const OF_144_PINS: Mark = Mark::up(
    const {
        &[
            Pin::new(Port::F, 14),
            Pin::new(Port::F, 15),
            Pin::new(Port::G, 5),
            Pin::new(Port::G, 2),
            Pin::new(Port::F, 1),
        ]
    },
);

/// An input for a thermistor to ground, under a resistor to the converter's reference. Which kind is plugged in is a
/// setting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ThermistorPin {
    /// The sensor on this pin.
    pub sensor: Sensor,
    /// Its pin.
    pub pin: Pin,
    /// The pin's channel of ADC3.
    pub channel: u8,
}

/// A timer that ends the pulses of heaters by itself, in one-pulse mode (see `heater_timer`).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HeaterTimer {
    /// TIM3.
    Three,
    /// TIM5.
    Five,
    /// TIM12.
    Twelve,
}

impl HeaterTimer {
    /// How many channels it has (RM0390, main features of the timers).
    #[must_use]
    pub const fn channels(self) -> u8 {
        match self {
            Self::Three | Self::Five => 4,
            Self::Twelve => 2,
        }
    }
}

/// A heater output on a channel of such a timer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeaterPin {
    /// The output printed next to it on the board.
    pub output: Output,
    /// Its pin, which is one of [`Board::loads`] too: high heats.
    pub pin: Pin,
    /// The timer.
    pub timer: HeaterTimer,
    /// The pin's channel of it, from 1.
    pub channel: u8,
}

/// The source of a fan's duty.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FanTimer {
    /// TIM1.
    One,
    /// TIM1 by its complementary outputs.
    OneComplementary,
    /// TIM2, which keeps the time too and so modulates at 15 Hz.
    Two,
    /// TIM4.
    Four,
    /// TIM9.
    Nine,
    /// No timer: the fan is on while its duty is not 0. Its channel is 0.
    None,
}

impl FanTimer {
    /// Its number, if its frequency may change.
    #[must_use]
    pub const fn number(self) -> Option<u8> {
        match self {
            Self::One | Self::OneComplementary => Some(1),
            Self::Four => Some(4),
            Self::Nine => Some(9),
            Self::Two | Self::None => None,
        }
    }

    /// Its channels for fans (RM0390, main features of the timers).
    #[must_use]
    pub const fn channels(self) -> RangeInclusive<u8> {
        match self {
            Self::One | Self::Four => 1..=4,
            Self::OneComplementary => 1..=3,
            // Time has the first two, and one fan is all that any board has there.
            Self::Two => 4..=4,
            Self::Nine => 1..=2,
            Self::None => 0..=0,
        }
    }
}

/// A fan output.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FanPin {
    /// Its pin, which is one of [`Board::loads`] too: high blows.
    pub pin: Pin,
    /// The timer.
    pub timer: FanTimer,
    /// The pin's channel of it, from 1.
    pub channel: u8,
}

/// The line that switches the power supply of a machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SupplySwitch {
    /// An output.
    pub pin: Pin,
    /// Its level at which the supply is on.
    pub is_on_high: bool,
}

/// The connector of an accelerometer, on SPI3.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SensorPins {
    /// SCK.
    pub clock: Pin,
    /// From the sensor, its SDO.
    pub miso: Pin,
    /// To the sensor, its SDA.
    pub mosi: Pin,
    /// CS, an output: low selects the sensor.
    pub select: Pin,
}

/// Thermistors that a board may have: a sequence of six or less is in one register (RM0390, 13.13.11).
pub const MOST_THERMISTORS: usize = 5;

/// A board.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// The board's name in messages.
    pub name: &'static str,
    /// The names of its connectors: driver sockets in the order of `sockets`, inputs in the order of `inputs`.
    pub connectors: &'static BoardConnectors,
    /// Rate of the clock at the crystal's pins.
    pub crystal: Crystal,
    /// The driver sockets: first the sockets for the prototype's motors, in the order of
    /// [`Motor::ALL`](corehbot::port::Motor::ALL).
    pub sockets: &'static [Slot],
    /// Inputs for switches, probes and other contacts: first the inputs for the prototype's x, y and z. Two connectors
    /// may lead to one pin by different circuits; a machine uses one of them.
    pub inputs: &'static [Input],
    /// The thermistors.
    pub thermistors: &'static [ThermistorPin],
    /// All heaters and fans: low is off. Outputs without a timer stay low.
    pub loads: &'static [Pin],
    /// Heater outputs that may heat.
    pub heaters: &'static [HeaterPin],
    /// Fan outputs, FAN0 and so on.
    pub fans: &'static [FanPin],
    /// Pins that may switch the power supply, in the order of the connectors' `supply_switches`. None has another job.
    pub supply_pins: &'static [Pin],
    /// The line of a servo, for a BLTouch. TIM3 makes its pulses, so no heater is on that timer.
    pub servo: Option<Pin>,
    /// The connector of an accelerometer.
    pub accelerometer: Option<SensorPins>,
    /// Serial ports on which hosts may be, each USART once.
    pub serial: &'static [SerialPort],
    /// There is a USB connector on PA11 and PA12.
    pub has_usb: bool,
    /// Clock and data of I2C1, on which the EEPROM is.
    pub eeprom: Option<[Pin; 2]>,
    /// Its processor has 144 pins, with the resistors of [`OF_144_PINS`].
    pub has_144_pins: bool,
    /// Marks that tell this board from others with such a processor that might get an image of ours.
    pub marks: &'static [Mark],
}

/// The pins of the USB port (STM32F446 datasheet, table of alternate functions: OTG_FS).
pub const USB: [Pin; 2] = [Pin::new(Port::A, 11), Pin::new(Port::A, 12)];

/// The pins of the debug port: SWDIO and SWCLK (STM32F446 datasheet, pin definitions).
pub const DEBUG: [Pin; 2] = [Pin::new(Port::A, 13), Pin::new(Port::A, 14)];

/// The ports of all heaters, which faults look at first. In LQFP100 and LQFP144 the timers' channels are on more ports
/// (STM32F446 datasheet, table of alternate functions); no board here has a heater there.
pub const HEATER_PORTS: [Port; 3] = [Port::A, Port::B, Port::C];

/// The clock at the crystal's pins.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Crystal {
    /// A crystal of 12 MHz.
    Oscillator12MHz,
    /// A clock of 8 MHz from the ST-LINK.
    Clock8MHz,
}

impl Board {
    /// The outputs of `port` and the levels at which nothing moves and nothing heats, as a word for BSRR.
    #[must_use]
    pub fn safe_levels(&self, port: Port) -> u32 {
        let sockets = || self.sockets.iter();
        let high = sockets().map(|slot| slot.enable);
        let low = sockets().flat_map(|slot| [slot.step, slot.dir]).chain(self.loads.iter().copied());
        bits(high, port) | bits(low, port) << 16
    }

    /// The heater outputs that may heat.
    #[must_use]
    pub fn outputs(&self) -> OutputSet {
        self.heaters.iter().fold(OutputSet::NONE, |set, heater| set.with(heater.output))
    }

    /// The lower of the two bits of each heater pin of `port` in its mode register. RM0390, 7.4.1: 01 is an output. All
    /// heater pins are on [`HEATER_PORTS`], or there is a [`problem`](Self::problem).
    #[must_use]
    pub fn heater_outputs(&self, port: Port) -> u32 {
        let pins = self.heaters.iter().map(|heater| heater.pin).filter(|pin| pin.port == port);
        pins.fold(0, |word, pin| word | 1 << (2 * pin.number()))
    }
}

/// The bits of those `pins` that are in `port`.
pub(crate) fn bits(pins: impl Iterator<Item = Pin>, port: Port) -> u32 {
    pins.filter(|pin| pin.port == port).fold(0, |bits, pin| bits | pin.mask())
}
