//! The step port: what the Stepper's events do to the pins.
//!
//! A table gives the words for all ports at once, in RAM (see [`Words`]). Computing them instead takes an
//! extraction, a shift and an addition for each of seven motors, and pins known when compiling, which would
//! make every type above generic.

use core::array;

use corehbot::port::{EndstopSet, MotorSet, StepPort};
use cortex_m::peripheral::DWT;

use crate::ports::{self, Registers};
use crate::wiring::{Board, PORTS, Words};

/// A step pulse is high for so many cycles of 180 MHz, 133 ns. TMC2209 datasheet rev 1.09, section 13.1: t_SH >=
/// max(t_FILTSD, t_CLK + 20 ns), which is 103 ns with the internal clock of 12 MHz and 118 ns at its slowest.
const PULSE: u32 = 24;

/// The same for a step pin on PC13, PC14 or PC15, which is good for 2 MHz (STM32F446 datasheet, pin definitions,
/// note on the power switch): 300 ns.
const SLOW_PULSE: u32 = 54;

/// Looks at the cycle counter that together take longer than a pulse, even if the counter stood still: a read
/// of it is two cycles or more, a comparison and a branch three.
const LOOKS: u32 = SLOW_PULSE / 5 + 1;

/// Step and direction pins of all motors, and the endstop inputs.
pub struct StepPins {
    steps: &'static Words,
    dirs: &'static Words,
    step_ports: [Registers; PORTS],
    dir_ports: [Registers; PORTS],
    reversed: MotorSet,
    slow: MotorSet,
    endstops: Endstops,
    /// The cycle counter when the step lines rose.
    rose: u32,
}

impl StepPins {
    /// The pins of `board`, which are outputs already.
    pub fn new(board: &Board, steps: &'static Words, dirs: &'static Words) -> Self {
        Self {
            steps,
            dirs,
            step_ports: steps.ports.map(ports::registers),
            dir_ports: dirs.ports.map(ports::registers),
            reversed: board.reversed,
            slow: board.slow,
            endstops: Endstops::new(board),
            rose: 0,
        }
    }
}

/// One store a port.
#[inline(always)]
fn store(ports: &[Registers; PORTS], words: [u32; PORTS]) {
    for (port, word) in ports.iter().zip(words) {
        ports::store(*port, word);
    }
}

impl StepPort for StepPins {
    /// A step follows some 20 cycles later at the earliest, 110 ns, where 20 ns are wanted.
    #[inline]
    fn dir(&mut self, forward: MotorSet) {
        let high = MotorSet(forward.0 ^ self.reversed.0);
        let (set, reset) = (self.dirs.of(high), self.dirs.of(MotorSet(!high.0)));
        store(&self.dir_ports, array::from_fn(|port| set[port] | reset[port] << 16));
    }

    #[inline]
    fn rise(&mut self, steps: MotorSet, _tick: u64) {
        store(&self.step_ports, *self.steps.of(steps));
        self.rose = DWT::cycle_count();
    }

    #[inline]
    fn fall(&mut self, steps: MotorSet) {
        let pulse = if steps.0 & self.slow.0 == 0 { PULSE } else { SLOW_PULSE };
        for _ in 0..LOOKS {
            if DWT::cycle_count().wrapping_sub(self.rose) >= pulse {
                break;
            }
        }
        store(&self.step_ports, self.steps.of(steps).map(|word| word << 16));
    }

    #[inline]
    fn endstops(&mut self) -> EndstopSet {
        self.endstops.read()
    }

    fn inputs(&self) -> EndstopSet {
        self.endstops.all()
    }
}

const _: () = assert!(EndstopSet::X.0 == 1 && EndstopSet::Y.0 == 2 && EndstopSet::Z.0 == 4);

/// The switches of x, y and z, and the probe.
struct Endstops {
    ports: [Registers; 3],
    numbers: [u8; 3],
    /// One read gets the switches.
    is_one_port: bool,
    probe: Option<ProbeInput>,
}

/// The probe's input.
struct ProbeInput {
    port: Registers,
    mask: u32,
    /// What the port reads in `mask` when it has triggered.
    triggered: u32,
}

impl Endstops {
    fn new(board: &Board) -> Self {
        let pins = board.endstops;
        Self {
            ports: pins.map(|pin| ports::registers(pin.port)),
            numbers: pins.map(|pin| pin.number() as u8),
            is_one_port: pins.iter().all(|pin| pin.port == pins[0].port),
            probe: board.probe.map(|probe| ProbeInput {
                port: ports::registers(probe.pin.port),
                mask: probe.pin.mask(),
                triggered: if probe.is_high { probe.pin.mask() } else { 0 },
            }),
        }
    }

    #[inline]
    fn read(&self) -> EndstopSet {
        let first = self.ports[0].idr().read().0;
        let inputs = if self.is_one_port {
            [first; 3]
        } else {
            [first, self.ports[1].idr().read().0, self.ports[2].idr().read().0]
        };
        let levels = inputs.into_iter().zip(self.numbers).enumerate();
        let set = levels.fold(0, |set, (bit, (input, number))| set | ((input >> number & 1) as u8) << bit);
        let probe = match &self.probe {
            Some(probe) if probe.port.idr().read().0 & probe.mask == probe.triggered => EndstopSet::PROBE,
            _ => EndstopSet::NONE,
        };
        EndstopSet(set).with(probe)
    }

    const fn all(&self) -> EndstopSet {
        match self.probe {
            Some(_) => EndstopSet::SWITCHES.with(EndstopSet::PROBE),
            None => EndstopSet::SWITCHES,
        }
    }
}
