//! The step port: what the Stepper's events do to the pins.
//!
//! A table gives the words for all ports at once, in RAM (see [`Words`]). Computing them instead takes an extraction, a shift
//! and an addition for each of seven motors, and pins known when compiling, which would make every type above generic.

use corehbot::port::{EndstopSet, MotorSet, StepPort};
use cortex_m::peripheral::DWT;

use crate::ports::{self, Registers};
use crate::wiring::{Board, PORTS, Pin, Port, Words};

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
    endstops: [Pin; 3],
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
            endstops: board.endstops,
            rose: 0,
        }
    }
}

impl StepPort for StepPins {
    /// A step follows some 20 cycles later at the earliest, 110 ns, where 20 ns are wanted.
    #[inline]
    fn dir(&mut self, forward: MotorSet) {
        let high = MotorSet(forward.0 ^ self.reversed.0);
        let (set, reset) = (self.dirs.of(high), self.dirs.of(MotorSet(!high.0)));
        for (port, (set, reset)) in self.dir_ports.into_iter().zip(set.iter().zip(reset)) {
            ports::store(port, set | reset << 16);
        }
    }

    #[inline]
    fn rise(&mut self, steps: MotorSet, _tick: u64) {
        for (port, word) in self.step_ports.into_iter().zip(self.steps.of(steps)) {
            ports::store(port, *word);
        }
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
        for (port, word) in self.step_ports.into_iter().zip(self.steps.of(steps)) {
            ports::store(port, word << 16);
        }
    }

    #[inline]
    fn endstops(&mut self) -> EndstopSet {
        let [x, y, z] = self.endstops;
        let read = |port: Port| ports::registers(port).idr().read().0;
        let first = read(x.port);
        // One read where one port has them all.
        let of = |pin: Pin| if pin.port == x.port { first } else { read(pin.port) } >> pin.number() & 1;
        EndstopSet((of(x) | of(y) << 1 | of(z) << 2) as u8)
    }
}

const _: () = assert!(EndstopSet::X.0 == 1 && EndstopSet::Y.0 == 2 && EndstopSet::Z.0 == 4);
