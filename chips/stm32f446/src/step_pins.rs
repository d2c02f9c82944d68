//! The step port: which edges the Stepper's events make on the pins, and how long a pulse is.
//!
//! Nothing waits for the end of a pulse: it lasts while the Stepper fetches the next event and sets its alarm.
//! [`PULSE`] is the shortest allowed pulse, and `cargo xtask bench` counts it in the image. Only motors on slow pins
//! (`Plugged::slow`) get a wait ([`SLOW_REST`]).
//!
//! For a driver that needs a longer pulse, raise `STEP_PULSE_NS` (`src/port.rs` of the core). Then either mark its
//! motors as slow, or let [`StepPins::fall_quick`] wait. Two steps of a motor must be far enough apart for such a
//! pulse. That holds for planned steps (`MIN_STEP_INTERVAL`, asserted below), and for late steps that follow each other
//! at once (`motion/stepper.rs` of the core, docs/explanation/time.md).
//!
//! A table gives the words for all ports at once, in RAM (see [`StepWrites`]). Computing them instead takes an
//! extraction, a shift and an addition for each of seven motors, and pins known when compiling, which would
//! make every type above generic.

use core::sync::atomic::{Ordering::AcqRel, compiler_fence};

use corehbot::kinematics::SETS;
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::motors::{Coupling, MOST_GROUPS};
use corehbot::port::{EndstopSet, GroupSet, STEP_PULSE_NS, StepPort};
use corehbot::units::TICKS_PER_MS;

use crate::ports::{self, Registers};
use crate::wiring::port_writes::{DIR_PORTS, DirWrites, QUICK, STEP_PORTS, StepWrites};
use crate::wiring::{Contact, Plugged};

/// Minimum length of a step pulse in cycles of 180 MHz. The Stepper's work during a pulse takes longer. The bench
/// counts these cycles in the image (`octopus_step_pulse_cycles`), and fails if they are fewer.
const PULSE: u32 = (STEP_PULSE_NS * CYCLES_PER_US).div_ceil(1000);

/// Extra pulse length of a slow step pin (`Pin::is_slow`: good for 2 MHz): 300 ns altogether.
const SLOW_REST: u32 = 54 - PULSE;

/// Cycles of 180 MHz.
const CYCLES_PER_US: u32 = 180;

// High for a pulse and low for as long, also on a slow pin, before the next step of the same motor.
const _: () =
    assert!(2 * (PULSE + SLOW_REST) as u64 * TICKS_PER_MS as u64 <= MIN_STEP_INTERVAL * 1000 * CYCLES_PER_US as u64);

/// Step and direction pins of all motors, and the endstop inputs.
// The order matters: the fields for a quick step come first.
#[repr(C)]
pub struct StepPins {
    quick: [Quick; QUICK],
    steps: StepWrites,
    step_ports: [Registers; STEP_PORTS],
    /// Values that lower all step lines. Most lines are low, but selecting the high ones would take longer.
    low: [u32; STEP_PORTS],
    /// Groups with a motor on a slow step pin.
    held: GroupSet,
    dirs: &'static mut Dirs,
    endstops: Endstops,
    /// Groups that need a closer look.
    slow: GroupSet,
}

/// Direction pins: their ports, and the values to store there.
// In this order: both are within reach of short instructions.
#[repr(C)]
pub struct Dirs {
    ports: [Registers; DIR_PORTS],
    writes: DirWrites,
}

impl Dirs {
    /// The direction pins of the motors, in this coupling.
    pub fn new(plugged: &Plugged, coupling: &Coupling) -> Self {
        let writes = DirWrites::levels(plugged.dir_pins(), plugged.reversed, coupling);
        Self { ports: writes.ports.map(ports::registers), writes }
    }
}

/// The step writes of a coupling.
pub struct Steps {
    writes: StepWrites,
    /// Groups with a motor on a slow step pin.
    held: GroupSet,
    /// The same, and groups with a motor on a port that quick steps do not reach.
    slow: GroupSet,
}

impl Steps {
    /// The step pins of the motors, in this coupling.
    pub fn new(plugged: &Plugged, coupling: &Coupling) -> Self {
        let slow = plugged.slow();
        let each = (0..MOST_GROUPS).map(|group| 1 << group);
        let held = GroupSet(each.filter(|group| coupling.motors(GroupSet(*group)).0 & slow.0 != 0).sum());
        let writes = StepWrites::pulses(plugged.step_pins(), slow, coupling);
        let slow = GroupSet(held.0 | writes.beyond_quick().0);
        Self { writes, held, slow }
    }
}

/// A port of quick steps, and the values that lower its step lines.
#[repr(C)]
struct Quick {
    port: Registers,
    low: u32,
}

impl StepPins {
    /// The pins of the motors, which are outputs already, in this coupling.
    pub fn new(plugged: &Plugged, dirs: &'static mut Dirs, coupling: &Coupling) -> Self {
        let Steps { writes: steps, held, slow } = Steps::new(plugged, coupling);
        let low = steps.of(ALL).map(|word| word << 16);
        let quick = |port: usize| Quick { port: ports::registers(steps.ports[port]), low: low[port] };
        Self {
            quick: [quick(0), quick(1), quick(2)],
            step_ports: steps.ports.map(ports::registers),
            low,
            steps,
            held,
            dirs,
            endstops: Endstops::new(plugged),
            slow,
        }
    }

    /// Takes another coupling and returns the previous one. Ports and idle levels belong to the pins, and stay.
    pub fn couple(&mut self, steps: &mut Steps, dirs: &mut &'static mut Dirs) {
        core::mem::swap(&mut self.steps, &mut steps.writes);
        core::mem::swap(&mut self.held, &mut steps.held);
        core::mem::swap(&mut self.slow, &mut steps.slow);
        core::mem::swap(&mut self.dirs, dirs);
    }
}

/// A few words, so few that they are copied in some 20 cycles.
pub type Row = [u32; 4];

/// The same of direction pins.
pub type DirRow = [u32; DIR_PORTS];

/// Number of rows that differ in another coupling: the values for each set of groups, and the groups with a waited
/// pulse.
pub const COUPLED_ROWS: usize = SETS + 1;

impl StepPins {
    /// The words for edges and for reading inputs, row by row; `None` after the last. The words of direction pins come
    /// from [`dir_row`](Self::dir_row).
    #[must_use]
    pub fn row(&self, number: usize) -> Option<Row> {
        let Some(number) = number.checked_sub(SETS) else {
            return Some(*self.steps.of(GroupSet(number as u8)));
        };
        let [a, b, c] = &self.quick;
        Some(match number {
            0 => [self.held.0.into(), 0, 0, 0],
            1 => self.low,
            // One by one: a loop would take three times as long.
            2 => {
                let [a, b, c, d] = self.step_ports;
                [address(a), address(b), address(c), address(d)]
            }
            3 => [address(a.port), address(b.port), address(c.port), 0],
            4 => [a.low, b.low, c.low, 0],
            _ => {
                let input = self.endstops.0.get(number - 5)?;
                [address(input.port), input.mask, input.triggered, 0]
            }
        })
    }

    /// The values for direction pins for a set of groups, and their ports; `None` after the last.
    #[must_use]
    pub fn dir_row(&self, number: usize) -> Option<DirRow> {
        match number {
            0..SETS => Some(*self.dirs.writes.of(GroupSet(number as u8))),
            SETS => Some(self.dirs.ports.map(address)),
            _ => None,
        }
    }
}

/// Where a port's registers are.
fn address(port: Registers) -> u32 {
    port.as_ptr() as u32
}

/// All groups.
const ALL: GroupSet = GroupSet((1 << MOST_GROUPS) - 1);

/// One store a port. Short rather than fast: directions and slow steps are rare.
#[inline(never)]
fn store(ports: &[Registers; STEP_PORTS], words: &[u32; STEP_PORTS]) {
    ports.iter().zip(words).for_each(|(port, word)| ports::store(*port, *word));
}

/// The same for quick steps, however the compiler feels about loops. Each port and its word are loaded when it is their
/// turn, for all at once would take longer up to the first store. The second port is 5 cycles later than the first, 28
/// ns.
#[inline(always)]
fn rise_in_turn([a, b, c]: &[Quick; QUICK], [x, y, z, _]: &[u32; STEP_PORTS]) {
    ports::store(a.port, *x);
    compiler_fence(AcqRel);
    ports::store(b.port, *y);
    compiler_fence(AcqRel);
    ports::store(c.port, *z);
    compiler_fence(AcqRel);
}

impl StepPort for StepPins {
    /// A step follows some 15 cycles later at the earliest, 83 ns; 20 ns are needed. The second pass stores the same
    /// values to three ports again. That gives a slow direction pin its time, 150 ns more.
    #[inline]
    fn dir(&mut self, forward: GroupSet) {
        let Dirs { ports, writes } = &*self.dirs;
        let words = writes.of(forward);
        if let (Some(ports), Some(words)) = (ports.first_chunk(), words.first_chunk()) {
            store(ports, words);
        }
        if let (Some(ports), Some(words)) = (ports.last_chunk(), words.last_chunk()) {
            store(ports, words);
        }
    }

    #[inline(always)]
    fn rise(&mut self, steps: GroupSet, _tick: u64) {
        store(&self.step_ports, self.steps.of(steps));
    }

    #[inline(always)]
    fn fall(&mut self, steps: GroupSet) {
        if steps.0 & self.held.0 != 0 {
            cortex_m::asm::delay(SLOW_REST);
        }
        store(&self.step_ports, &self.low);
    }

    fn slow_groups(&self) -> GroupSet {
        self.slow
    }

    #[inline(always)]
    fn rise_quick(&mut self, steps: GroupSet, _tick: u64) {
        rise_in_turn(&self.quick, self.steps.of(steps));
    }

    #[inline(always)]
    fn fall_quick(&mut self, _steps: GroupSet) {
        let [a, b, c] = &self.quick;
        ports::store(a.port, a.low);
        ports::store(b.port, b.low);
        ports::store(c.port, c.low);
    }

    #[inline]
    fn endstops(&mut self) -> EndstopSet {
        self.endstops.read()
    }

    fn inputs(&self) -> EndstopSet {
        self.endstops.all()
    }
}

const _: () = assert!(EndstopSet::X.0 == 1 && EndstopSet::Y.0 == 2 && EndstopSet::Z.0 == 4 && EndstopSet::PROBE.0 == 8);

/// An input: it has triggered when its port reads `triggered` in `mask`.
#[derive(Clone, Copy)]
struct Input {
    port: Registers,
    mask: u32,
    triggered: u32,
}

/// The switches of x, y and z, and the probe.
struct Endstops([Input; 4]);

impl Endstops {
    fn new(plugged: &Plugged) -> Self {
        let input = |contact: Contact| {
            let (pin, is_high) = (contact.input.pin, contact.is_high_when_triggered());
            let mask = pin.mask();
            Input { port: ports::registers(pin.port), mask, triggered: if is_high { mask } else { 0 } }
        };
        let [x, y, z] = plugged.endstops.map(input);
        // An input of no bits that would have to read 1 never triggers.
        let none = Input { mask: 0, triggered: 1, ..x };
        Self([x, y, z, plugged.probe.map_or(none, input)])
    }

    /// A function of its own, to keep the step path below a KiB.
    #[inline(never)]
    fn read(&self) -> EndstopSet {
        // From the last to the first, so that the first one's bit ends up lowest.
        self.0.iter().rev().fold(EndstopSet(0), |set, input| {
            EndstopSet(set.0 << 1 | u8::from(input.port.idr().read().0 & input.mask == input.triggered))
        })
    }

    const fn all(&self) -> EndstopSet {
        let [.., probe] = &self.0;
        if probe.mask == 0 { EndstopSet::SWITCHES } else { EndstopSet::SWITCHES.with(EndstopSet::PROBE) }
    }
}
