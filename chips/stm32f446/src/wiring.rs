//! The wiring of a board: which pin does what, as data.
//!
//! Nothing here needs the processor, so a board's table is tested on the host.

use corehbot::port::{Motor, MotorSet, Sensor};

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
}

/// A level that tells boards apart: what `pin` reads against its internal resistor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Mark {
    /// An input, with the internal resistor against `is_high`.
    pub pin: Pin,
    /// What it reads if the resistor on the board is the one that we expect.
    pub is_high: bool,
}

/// A Z probe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Probe {
    /// An input.
    pub pin: Pin,
    /// Its level when the probe has triggered.
    pub is_high: bool,
    /// Which way the internal resistor pulls a wire that is open.
    pub pull_up: bool,
}

/// A thermistor to ground, under a resistor to the converter's reference.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Thermistor {
    /// What it measures.
    pub sensor: Sensor,
    /// Its pin.
    pub pin: Pin,
    /// The pin's channel of ADC3.
    pub channel: u8,
}

/// Thermistors that a board may have: a sequence of six or less is in one register (RM0390, 13.13.11).
pub const MOST_THERMISTORS: usize = 5;

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
    /// The Z probe.
    pub probe: Option<Probe>,
    /// The thermistors.
    pub thermistors: &'static [Thermistor],
    /// Heaters and fans: low is off, and they stay low.
    pub loads: &'static [Pin],
    /// Transmitter and receiver of USART2.
    pub serial: [Pin; 2],
    /// Bits a second on USART2.
    pub baud: u32,
    /// Clock and data of I2C1, on which the EEPROM is.
    pub eeprom: Option<[Pin; 2]>,
    /// What tells this board from others that an image of ours might be flashed to.
    pub marks: &'static [Mark],
}

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

/// For every set of motors, the bits to be written to each port: one load of neighbouring words and one store a
/// port, however many motors there are. Lies in RAM, where no flash wait state delays it.
pub struct Words {
    /// The ports; those not needed repeat the first, and their words are 0.
    pub ports: [Port; PORTS],
    /// Bits to set by set of motors and port.
    bits: [[u32; PORTS]; SETS],
}

impl Words {
    /// The words of the motors' pins. Pins beyond [`PORTS`] ports have none, which [`Board::problem`] finds.
    #[must_use]
    pub fn new(pins: [Option<Pin>; Motor::ALL.len()]) -> Self {
        let mut ports = ports_of(&pins);
        let used = ports.1;
        for port in used..PORTS {
            ports.0[port] = ports.0[0];
        }
        let mut bits = [[0; PORTS]; SETS];
        for (set, words) in bits.iter_mut().enumerate() {
            for (motor, pin) in pins.iter().enumerate() {
                if let Some(pin) = pin.filter(|_| set & 1 << motor != 0)
                    && let Some(column) = ports.0[..used].iter().position(|port| *port == pin.port)
                {
                    words[column] |= pin.mask();
                }
            }
        }
        Self { ports: ports.0, bits }
    }

    /// Bits to set in each port for `motors`.
    #[inline]
    #[must_use]
    pub const fn of(&self, motors: MotorSet) -> &[u32; PORTS] {
        &self.bits[motors.0 as usize % SETS]
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
        let single = slots().flat_map(|slot| [slot.step, slot.dir]);
        let single = single.chain(self.loads.iter().copied()).chain(self.endstops).chain(self.serial);
        let single = single.chain(self.eeprom.into_iter().flatten()).chain(self.probe.map(|probe| probe.pin));
        let single = single.chain(self.thermistors.iter().map(|thermistor| thermistor.pin));
        let is_twice = |pin: Pin| single.clone().filter(|other| *other == pin).count() > 1;
        if single.clone().any(is_twice) || slots().any(|slot| single.clone().any(|pin| pin == slot.enable)) {
            return Some("a pin has two jobs");
        }
        let debug = [Pin::new(Port::A, 13), Pin::new(Port::A, 14)];
        if single.clone().chain(slots().map(|slot| slot.enable)).any(|pin| debug.contains(&pin)) {
            return Some("a pin of the debug port has a job");
        }
        if self.thermistors.len() > MOST_THERMISTORS {
            return Some("there are too many thermistors");
        }
        None
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
        let words = Words::new(pins.map(Some));
        for set in 0..SETS {
            let motors = MotorSet(set as u8);
            for port in Port::ALL {
                let written: u32 =
                    words.ports.iter().zip(words.of(motors)).filter(|(p, _)| **p == port).map(|(_, word)| word).sum();
                let wanted = Motor::ALL.into_iter().zip(pins).filter(|(motor, _)| motors.has(*motor));
                assert_eq!(written, bits(wanted.map(|(_, pin)| pin), port), "{motors:?} {port:?}");
            }
        }
    }

    #[test]
    fn ports_without_a_motor_get_no_bits() {
        let mut pins = [None; 7];
        pins[0] = Some(Pin::new(Port::B, 3));
        let words = Words::new(pins);
        assert_eq!(words.ports, [Port::B; PORTS]);
        assert_eq!(words.of(MotorSet::ALL), &[1 << 3, 0, 0, 0]);
    }
}
