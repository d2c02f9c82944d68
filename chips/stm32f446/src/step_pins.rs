//! The step port: what the Stepper's events do to the pins.
//!
//! A table gives the words for all ports at once, in RAM (see [`Words`]). Computing them instead takes an
//! extraction, a shift and an addition for each of seven motors, and pins known when compiling, which would
//! make every type above generic.

use corehbot::port::{EndstopSet, MotorSet, StepPort};
use cortex_m::peripheral::DWT;

use crate::ports::{self, Registers};
use crate::wiring::{Board, Pin};
use crate::words::{PORTS, Words};

/// A step pulse is high for so many cycles of 180 MHz, 133 ns. TMC2209 datasheet rev 1.09, section 13.1: t_SH >=
/// max(t_FILTSD, t_CLK + 20 ns), which is 103 ns with the internal clock of 12 MHz and 118 ns at its slowest.
const PULSE: u32 = 24;

/// The same for a step pin on PC13, PC14 or PC15, which is good for 2 MHz (STM32F446 datasheet, pin definitions,
/// note on the power switch): 300 ns.
const SLOW_PULSE: u32 = 54;

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

/// One store a port, with nothing between them, however the compiler feels about loops.
#[inline(always)]
fn store(ports: &[Registers; PORTS], words: &[u32; PORTS], shift: u32) {
    let ([a, b, c, d], [x, y, z, w]) = (*ports, *words);
    ports::store(a, x << shift);
    ports::store(b, y << shift);
    ports::store(c, z << shift);
    ports::store(d, w << shift);
}

impl StepPort for StepPins {
    /// A step follows some 20 cycles later at the earliest, 110 ns, where 20 ns are wanted.
    #[inline]
    fn dir(&mut self, forward: MotorSet) {
        let high = MotorSet(forward.0 ^ self.reversed.0);
        store(&self.dir_ports, self.dirs.of(high), 0);
    }

    #[inline]
    fn rise(&mut self, steps: MotorSet, _tick: u64) {
        store(&self.step_ports, self.steps.of(steps), 0);
        self.rose = DWT::cycle_count();
    }

    #[inline]
    fn fall(&mut self, steps: MotorSet) {
        let pulse = if steps.0 & self.slow.0 == 0 { PULSE } else { SLOW_PULSE };
        // If the counter stands still, this is the whole pulse.
        let rest = pulse.saturating_sub(DWT::cycle_count().wrapping_sub(self.rose));
        if rest > 0 {
            cortex_m::asm::delay(rest);
        }
        store(&self.step_ports, self.steps.of(steps), 16);
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
    masks: [u32; 3],
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
            masks: pins.map(Pin::mask),
            is_one_port: pins.iter().all(|pin| pin.port == pins[0].port),
            probe: board.probe.map(|probe| ProbeInput {
                port: ports::registers(probe.pin.port),
                mask: probe.pin.mask(),
                triggered: if probe.is_high { probe.pin.mask() } else { 0 },
            }),
        }
    }

    /// A function of its own, to keep the step path below a KiB.
    #[inline(never)]
    fn read(&self) -> EndstopSet {
        let [x, y, z] = self.ports;
        let first = x.idr().read().0;
        let (second, third) = if self.is_one_port { (first, first) } else { (y.idr().read().0, z.idr().read().0) };
        let [x, y, z] = self.masks;
        let mut set = u8::from(first & x != 0);
        set |= u8::from(second & y != 0) << 1;
        set |= u8::from(third & z != 0) << 2;
        if let Some(probe) = &self.probe
            && probe.port.idr().read().0 & probe.mask == probe.triggered
        {
            set |= EndstopSet::PROBE.0;
        }
        EndstopSet(set)
    }

    const fn all(&self) -> EndstopSet {
        match self.probe {
            Some(_) => EndstopSet::SWITCHES.with(EndstopSet::PROBE),
            None => EndstopSet::SWITCHES,
        }
    }
}
