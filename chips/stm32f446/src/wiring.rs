//! The wiring of a board: which pin does what, as data.
//!
//! Nothing here needs the processor, so a board's table is tested on the host.

use corehbot::port::{Motor, MotorSet};

pub use crate::serial_port::{SerialPort, Usart};

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
}

/// The pins of a motor driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Slot {
    /// A rising edge is a step.
    pub step: Pin,
    /// High is forward, unless the board says otherwise.
    pub dir: Pin,
    /// Low is on.
    pub enable: Pin,
    /// The driver's UART, if it is connected; a driver without runs as its jumpers say.
    pub uart: Option<Pin>,
}

/// A level that tells boards apart: what `pin` reads against its internal resistor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Mark {
    /// An input, with the internal resistor against `is_high`.
    pub pin: Pin,
    /// What it reads if the resistor on the board is the one that we expect.
    pub is_high: bool,
}

/// A board.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// What the board is called in messages.
    pub name: &'static str,
    /// Rate of the clock at the crystal's pins.
    pub crystal: Crystal,
    /// The drivers by motor; a motor without one is counted, but does not turn.
    pub slots: [Option<Slot>; Motor::ALL.len()],
    /// Motors whose direction line is low for forward.
    pub reversed: MotorSet,
    /// Motors whose step pin is slow and needs a longer pulse.
    pub slow: MotorSet,
    /// Switches of x, y and z: closed to ground at rest, with a pull-up, so that a broken wire reads as pressed.
    pub endstops: [Pin; 3],
    /// Heaters and fans: low is off, and they stay low.
    pub loads: &'static [Pin],
    /// Serial ports on which hosts may be, each USART once.
    pub serial: &'static [SerialPort],
    /// There is a USB connector on PA11 and PA12.
    pub has_usb: bool,
    /// What tells this board from others that an image of ours might be flashed to.
    pub marks: &'static [Mark],
}

/// Lines on which hosts may be at the same time.
pub const LINES: usize = 3;

/// The pins of the USB port (STM32F446 datasheet, table of alternate functions: OTG_FS).
pub const USB: [Pin; 2] = [Pin::new(Port::A, 11), Pin::new(Port::A, 12)];

/// The clock at the crystal's pins.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Crystal {
    /// A crystal of 12 MHz.
    Oscillator12MHz,
    /// A clock of 8 MHz from the ST-LINK.
    Clock8MHz,
}

/// Ports that the step pins, or the direction pins, of all motors may be spread over.
pub const PORTS: usize = 4;

/// Sets of motors.
pub const SETS: usize = 1 << Motor::ALL.len();

/// For every set of motors, the word to be written to each port's BSRR: one load of neighbouring words and one store a
/// port, however many motors there are. Lies in RAM, where no flash wait state delays it.
pub struct Words {
    /// The ports; those not needed repeat the first, and their words are 0.
    pub ports: [Port; PORTS],
    /// Words by set of motors and port.
    words: [[u32; PORTS]; SETS],
}

impl Words {
    /// Words that set the pins of the motors in the set and leave the others. Pins beyond [`PORTS`] ports have
    /// none, which [`Board::problem`] finds.
    #[must_use]
    pub fn pulses(pins: [Option<Pin>; Motor::ALL.len()]) -> Self {
        Self::new(pins, |pin, is_in| if is_in { pin.mask() } else { 0 })
    }

    /// Words that set the pins of the motors in the set and reset those of the others.
    #[must_use]
    pub fn levels(pins: [Option<Pin>; Motor::ALL.len()]) -> Self {
        Self::new(pins, |pin, is_in| if is_in { pin.mask() } else { pin.mask() << 16 })
    }

    fn new(pins: [Option<Pin>; Motor::ALL.len()], word: impl Fn(Pin, bool) -> u32) -> Self {
        let mut ports = ports_of(&pins);
        let used = ports.1;
        for port in used..PORTS {
            ports.0[port] = ports.0[0];
        }
        let mut words = [[0; PORTS]; SETS];
        for (set, words) in words.iter_mut().enumerate() {
            for (motor, pin) in pins.iter().enumerate() {
                if let Some(pin) = *pin
                    && let Some(column) = ports.0[..used].iter().position(|port| *port == pin.port)
                {
                    words[column] |= word(pin, set & 1 << motor != 0);
                }
            }
        }
        Self { ports: ports.0, words }
    }

    /// The word of each port for `motors`.
    #[inline]
    #[must_use]
    pub const fn of(&self, motors: MotorSet) -> &[u32; PORTS] {
        &self.words[motors.0 as usize % SETS]
    }
}

/// The ports of `pins` in the order of the motors, and how many there are.
fn ports_of(pins: &[Option<Pin>]) -> ([Port; PORTS], usize) {
    let mut ports = [Port::A; PORTS];
    let mut used = 0;
    for pin in pins.iter().flatten() {
        if !ports[..used].contains(&pin.port) && used < PORTS {
            ports[used] = pin.port;
            used += 1;
        }
    }
    (ports, used)
}

impl Board {
    /// Step pins by motor.
    #[must_use]
    pub fn step_pins(&self) -> [Option<Pin>; Motor::ALL.len()] {
        self.slots.map(|slot| slot.map(|slot| slot.step))
    }

    /// Direction pins by motor.
    #[must_use]
    pub fn dir_pins(&self) -> [Option<Pin>; Motor::ALL.len()] {
        self.slots.map(|slot| slot.map(|slot| slot.dir))
    }

    /// The outputs of `port` and the levels at which nothing moves and nothing heats, as a word for BSRR.
    #[must_use]
    pub fn safe_levels(&self, port: Port) -> u32 {
        let slots = || self.slots.iter().flatten();
        let high = slots().map(|slot| slot.enable);
        let low = slots().flat_map(|slot| [slot.step, slot.dir]).chain(self.loads.iter().copied());
        bits(high, port) | bits(low, port) << 16
    }

    /// The enable lines of `motors` in `port`.
    #[must_use]
    pub fn enable_lines(&self, motors: MotorSet, port: Port) -> u32 {
        let slots = Motor::ALL.into_iter().zip(self.slots).filter(|(motor, _)| motors.has(*motor));
        bits(slots.filter_map(|(_, slot)| slot).map(|slot| slot.enable), port)
    }

    /// The UART of `motor`'s driver.
    #[must_use]
    pub fn uart(&self, motor: Motor) -> Option<Pin> {
        self.slots[motor as usize].and_then(|slot| slot.uart)
    }

    /// Motors whose driver has a UART.
    #[must_use]
    pub fn uarts(&self) -> MotorSet {
        let motors = Motor::ALL.into_iter().filter(|motor| self.uart(*motor).is_some());
        motors.fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(motor)))
    }

    /// What is wrong with the table, if anything: to be asked by a test.
    #[must_use]
    pub fn problem(&self) -> Option<&'static str> {
        let is_spread = |pins: [Option<Pin>; Motor::ALL.len()]| {
            let (ports, used) = ports_of(&pins);
            pins.iter().flatten().any(|pin| !ports[..used].contains(&pin.port))
        };
        if is_spread(self.step_pins()) || is_spread(self.dir_pins()) {
            return Some("step or direction pins are on too many ports");
        }
        let slots = || self.slots.iter().flatten();
        let single = slots().flat_map(|slot| [slot.step, slot.dir]).chain(slots().filter_map(|slot| slot.uart));
        let single = single.chain(self.loads.iter().copied()).chain(self.endstops);
        let single = single.chain(self.serial.iter().flat_map(|port| [port.tx, port.rx]));
        let single = single.chain(USB.into_iter().filter(|_| self.has_usb));
        let is_twice = |pin: Pin| single.clone().filter(|other| *other == pin).count() > 1;
        if single.clone().any(is_twice) || slots().any(|slot| single.clone().any(|pin| pin == slot.enable)) {
            return Some("a pin has two jobs");
        }
        let debug = [Pin::new(Port::A, 13), Pin::new(Port::A, 14)];
        if single.clone().chain(slots().map(|slot| slot.enable)).any(|pin| debug.contains(&pin)) {
            return Some("a pin of the debug port has a job");
        }
        let is_usart_twice = |port: &SerialPort| self.serial.iter().filter(|p| p.usart == port.usart).count() > 1;
        if self.serial.iter().any(is_usart_twice) || self.serial.len() + usize::from(self.has_usb) > LINES {
            return Some("there are more lines to hosts than can be served");
        }
        self.serial.iter().find_map(SerialPort::problem)
    }
}

/// The bits of those `pins` that are in `port`.
fn bits(pins: impl Iterator<Item = Pin>, port: Port) -> u32 {
    pins.filter(|pin| pin.port == port).fold(0, |bits, pin| bits | pin.mask())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_the_bits_of_exactly_the_motors_asked_for() {
        let pins =
            [(Port::F, 13), (Port::G, 0), (Port::F, 9), (Port::G, 4), (Port::F, 11), (Port::C, 13), (Port::E, 2)];
        let pins = pins.map(|(port, number)| Pin::new(port, number));
        let (pulses, levels) = (Words::pulses(pins.map(Some)), Words::levels(pins.map(Some)));
        for set in 0..SETS {
            let motors = MotorSet(set as u8);
            for port in Port::ALL {
                let written = |words: &Words| -> u32 {
                    words.ports.iter().zip(words.of(motors)).filter(|(p, _)| **p == port).map(|(_, word)| word).sum()
                };
                let of = |is_in: bool| {
                    let chosen = Motor::ALL.into_iter().zip(pins).filter(move |(motor, _)| motors.has(*motor) == is_in);
                    bits(chosen.map(|(_, pin)| pin), port)
                };
                assert_eq!(written(&pulses), of(true), "{motors:?} {port:?}");
                assert_eq!(written(&levels), of(true) | of(false) << 16, "{motors:?} {port:?}");
            }
        }
    }

    fn board(uart: Option<Pin>) -> Board {
        let pin = |number| Pin::new(Port::B, number);
        let slot = Slot { step: pin(0), dir: pin(1), enable: pin(2), uart };
        let mut slots = [None; Motor::ALL.len()];
        slots[Motor::M8 as usize] = Some(slot);
        Board {
            name: "",
            crystal: Crystal::Clock8MHz,
            slots,
            reversed: MotorSet::NONE,
            slow: MotorSet::NONE,
            endstops: [pin(3), pin(4), pin(5)],
            loads: &[],
            serial: &[],
            has_usb: false,
            marks: &[],
        }
    }

    #[test]
    fn a_uart_pin_has_no_other_job() {
        assert_eq!((board(None).problem(), board(None).uarts()), (None, MotorSet::NONE));
        let free = board(Some(Pin::new(Port::B, 8)));
        assert_eq!((free.problem(), free.uarts()), (None, MotorSet::of(Motor::M8)));
        for taken in [1, 2, 5] {
            assert_eq!(board(Some(Pin::new(Port::B, taken))).problem(), Some("a pin has two jobs"));
        }
        assert!(board(Some(Pin::new(Port::A, 14))).problem().is_some());
    }

    #[test]
    fn ports_without_a_motor_get_no_bits() {
        let mut pins = [None; 7];
        pins[0] = Some(Pin::new(Port::B, 3));
        let words = Words::pulses(pins);
        assert_eq!(words.ports, [Port::B; PORTS]);
        assert_eq!(words.of(MotorSet::ALL), &[1 << 3, 0, 0, 0]);
    }
}
