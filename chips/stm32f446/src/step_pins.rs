//! The step port: what the Stepper's events do to the pins.
//!
//! A table gives the words for all ports at once, in RAM (see [`Words`]). Computing them instead takes an
//! extraction, a shift and an addition for each of seven motors, and pins known when compiling, which would
//! make every type above generic.

use corehbot::kinematics::Groups;
use corehbot::motors::MOST_GROUPS;
use corehbot::port::{EndstopSet, GroupSet, MotorSet, StepPort};

use crate::ports::{self, Registers};
use crate::wiring::{Board, Pin};
use crate::words::{PORTS, Words};

/// A step pulse has to be high for so many cycles of 180 MHz, 133 ns. TMC2209 datasheet rev 1.09, section 13.1: t_SH >=
/// max(t_FILTSD, t_CLK + 20 ns), which is 103 ns with the internal clock of 12 MHz and 118 ns at its slowest. What the
/// Stepper does meanwhile takes longer: [`IN_BETWEEN`].
const PULSE: u32 = 24;

/// Cycles between the last store of a rise and the first of a fall, at the least: 27 instructions (docs/performance.md).
/// Loads, and the step timer's alarm, which is written and its counter read on a bus of 45 MHz, make it more: the
/// shortest pulse of the image in the emulator is 247 ns.
const IN_BETWEEN: u32 = 27;
const _: () = assert!(IN_BETWEEN >= PULSE);

/// What a pulse on a step pin on PC13, PC14 or PC15 takes beyond that, which is good for 2 MHz (STM32F446 datasheet, pin
/// definitions, note on the power switch): 300 ns altogether.
const SLOW_REST: u32 = 54 - IN_BETWEEN;

/// Step and direction pins of all motors, and the endstop inputs.
pub struct StepPins {
    step_ports: [Registers; PORTS],
    /// What lowers all step lines. Most are low, but sorting them out would take longer.
    low: [u32; PORTS],
    /// Groups with a motor whose step pin is slow.
    slow: GroupSet,
    steps: Words,
    dirs: &'static Words,
    dir_ports: [Registers; PORTS],
    endstops: Endstops,
}

impl StepPins {
    /// The pins of `board`, which are outputs already, for these groups of motors.
    pub fn new(board: &Board, dirs: &'static Words, groups: &Groups) -> Self {
        let steps = Words::pulses(board.step_pins(), groups);
        Self {
            step_ports: steps.ports.map(ports::registers),
            low: steps.of(ALL).map(|word| word << 16),
            slow: groups_of(board.slow, groups),
            steps,
            dirs,
            dir_ports: dirs.ports.map(ports::registers),
            endstops: Endstops::new(board),
        }
    }
}

/// All groups.
const ALL: GroupSet = GroupSet((1 << MOST_GROUPS) - 1);

/// One store a port, with nothing between them, however the compiler feels about loops.
#[inline(always)]
fn store(ports: &[Registers; PORTS], words: &[u32; PORTS]) {
    let ([a, b, c, d], [x, y, z, w]) = (*ports, *words);
    ports::store(a, x);
    ports::store(b, y);
    ports::store(c, z);
    ports::store(d, w);
}

/// The groups that any of `slow` belongs to.
fn groups_of(slow: MotorSet, groups: &Groups) -> GroupSet {
    let each = (0..MOST_GROUPS).map(|group| 1 << group);
    GroupSet(each.filter(|group| groups.motors(GroupSet(*group)).0 & slow.0 != 0).sum())
}

impl StepPort for StepPins {
    /// A step follows some 15 cycles later at the earliest, 83 ns, where 20 ns are wanted.
    #[inline]
    fn dir(&mut self, forward: GroupSet) {
        store(&self.dir_ports, self.dirs.of(forward));
    }

    #[inline(always)]
    fn rise(&mut self, steps: GroupSet, _tick: u64) {
        store(&self.step_ports, self.steps.of(steps));
    }

    #[inline(always)]
    fn fall(&mut self, steps: GroupSet) {
        if steps.0 & self.slow.0 != 0 {
            cortex_m::asm::delay(SLOW_REST);
        }
        store(&self.step_ports, &self.low);
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
