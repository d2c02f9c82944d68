//! The world: the firmware's handles and a machine made of numbers, in virtual time.
//!
//! All of it runs in one thread. Time advances only by the Stepper's alarm, or by a millisecond when
//! nothing moves, so a print takes as long as the computing does. The host at the other end of the line
//! answers at once: time stands still while the printer waits for a line.

use crate::drivers::Drivers;
use corehbot::app::{Memory, StepPorts, assemble};
use corehbot::machine::Ports;
use corehbot::motors::{EndstopSet, MotorSet};
use corehbot::port::{Clock, NoStorage, Pend, Received, Sensor, Serial, StepClock, StepPort, Storage, ThermalPort};
use corehbot::settings::Settings;
use corehbot::units::{Instant, Mm, TICKS_PER_MS, Tick};
use corehbot_rig::Rig;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::pin::pin;
use std::task::{Context, Waker};

/// Who hears every step event, in order. `tick` is motion time (10 MHz) and never falls.
pub trait Sink {
    /// The motors of `steps` step at `tick`, each forward if it is in `forward`.
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet);
}

/// The other end of the serial line.
pub trait Host {
    /// The next bytes to put on the wire, appended to `out`; called whenever the printer waits for input.
    fn send(&mut self, out: &mut Vec<u8>);
    /// Bytes to put on the wire although the printer is busy, appended to `out`; called all the time.
    fn interject(&mut self, _out: &mut Vec<u8>) {}
    /// Whether it opens its line now, so that what came before was somebody else's; called all the time.
    fn opens(&mut self) -> bool {
        false
    }
    /// A whole line from the printer, without its line end.
    fn hear(&mut self, line: &str);
    /// Whether everything was sent and answered.
    fn is_done(&self) -> bool;
}

/// How a print ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Motion time in ticks of 0.1 us.
    pub ticks: u64,
    /// Moves planned.
    pub moves: u32,
    /// Path of the tool, in um.
    pub path_um: u64,
    /// How often the host was too slow for the look-ahead.
    pub underruns: u32,
    /// Fewest moves in the look-ahead while the stream ran, if it was ever full.
    pub low_water: Option<u32>,
    /// Steps emitted by each motor, signed.
    pub counts: [i32; 7],
    /// Whether an emergency stop holds.
    pub halted: bool,
}

/// Why there is no outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldError {
    /// The printer waits for input and the host has nothing to say, for ten virtual minutes.
    Stalled,
}

impl std::fmt::Display for WorldError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stalled => f.write_str("printer and host wait for each other"),
        }
    }
}

impl std::error::Error for WorldError {}

/// With nothing moving and nothing said for this long, nothing will ever happen.
const PATIENCE_MS: u32 = 600_000;

/// Events played between two turns of the Console.
const EVENTS_A_TURN: usize = 128;

/// Time passes by no more than this between two turns of the Console, which a board polls every millisecond.
const TURN: u64 = TICKS_PER_MS as u64;

/// What the ports share.
#[derive(Default)]
struct Shared {
    /// Real time in ticks.
    now: Cell<u64>,
    alarm: Cell<Option<u32>>,
    generator: Cell<bool>,
    stepper: Cell<bool>,
}

/// What is on the way between the printer and one host.
#[derive(Default)]
struct Wire {
    to_printer: RefCell<VecDeque<Received>>,
    to_host: RefCell<Vec<u8>>,
    /// A line that the printer has begun.
    spoken: RefCell<String>,
}

#[derive(Clone, Copy)]
struct Pends<'w>(&'w Shared);

impl Pend for Pends<'_> {
    fn pend_generator(&self) {
        self.0.generator.set(true);
    }

    fn pend_stepper(&self) {
        self.0.stepper.set(true);
    }
}

struct Timer<'w>(&'w Shared);

impl StepClock for Timer<'_> {
    fn now(&self) -> Tick {
        Tick(self.0.now.get() as u32)
    }

    fn alarm(&mut self, at: Tick) {
        self.0.alarm.set(Some(at.0));
    }

    fn silence(&mut self) {
        self.0.alarm.set(None);
    }
}

impl Clock for Timer<'_> {
    fn now(&self) -> Instant {
        Instant(self.0.now.get())
    }
}

struct Line<'w>(&'w Wire);

impl Serial for Line<'_> {
    fn recv(&mut self) -> Option<Received> {
        self.0.to_printer.borrow_mut().pop_front()
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        self.0.to_host.borrow_mut().extend_from_slice(bytes);
        bytes.len()
    }
}

/// Thermistors in a room of 25 C.
struct Room;

/// 100 kOhm under 4.7 kOhm, as on the Octopus: 0.955 of the reference.
const ROOM: u16 = 62594;

impl ThermalPort for Room {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        matches!(sensor, Sensor::Bed | Sensor::Hotend0).then_some(ROOM)
    }
}

struct Pins<'w> {
    rig: Rig,
    forward: MotorSet,
    sink: &'w mut dyn Sink,
}

impl StepPort for Pins<'_> {
    fn dir(&mut self, forward: MotorSet) {
        self.forward = forward;
    }

    fn rise(&mut self, steps: MotorSet, tick: u64) {
        self.rig.step(steps, self.forward);
        self.sink.event(tick, steps, self.forward);
    }

    fn fall(&mut self, _steps: MotorSet) {}

    fn endstops(&mut self) -> EndstopSet {
        self.rig.endstops()
    }
}

/// Prints what `host` sends on a machine that stands at `start` (x, y, z) as if homed, or somewhere.
///
/// # Errors
/// If printer and host wait for each other.
pub fn run(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    host: &mut dyn Host,
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    run_with(settings, start, NoStorage, &mut [host], sink)
}

/// The same with storage, and with several hosts, each on its own serial line. The firmware takes the settings in the
/// storage, the mechanism stays that of `settings`.
///
/// # Errors
/// If printer and hosts wait for each other.
pub fn run_with(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    storage: impl Storage,
    hosts: &mut [&mut dyn Host],
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    run_on(settings, start, storage, &Drivers::new(), hosts, sink)
}

/// The same on drivers that somebody else holds too.
///
/// # Errors
/// If printer and host wait for each other.
pub fn run_on(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    storage: impl Storage,
    drivers: &Drivers,
    hosts: &mut [&mut dyn Host],
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    let shared = Shared::default();
    let wires: Vec<Wire> = hosts.iter().map(|_| Wire::default()).collect();
    let mut memory = Box::new(Memory::new());
    let pins = Pins { rig: Rig::new(settings, start), forward: MotorSet::NONE, sink };
    let step_ports = StepPorts { pins, clock: Timer(&shared) };
    let ports = Ports {
        serial: wires.iter().map(Line).collect(),
        drivers: drivers.bus(&shared.now),
        clock: Timer(&shared),
        storage,
        sensors: Room,
    };
    let mut parts = assemble(&mut memory, *settings, start, step_ports, ports, Pends(&shared));
    let (status, stepper, generator) = (parts.status, &mut parts.stepper, &mut parts.generator);
    let mut console = pin!(parts.console.run());
    let mut context = Context::from_waker(Waker::noop());
    let mut idle_ms = 0;
    let mut path = Path::default();
    while !(hosts.iter().all(|host| host.is_done()) || status.is_halted()) {
        let _ = console.as_mut().poll(&mut context);
        path.follow(status.planned().1);
        for (host, wire) in hosts.iter_mut().zip(&wires) {
            wire.deliver(*host);
            if host.opens() {
                wire.to_printer.borrow_mut().push_back(Received::Opened);
            }
            wire.take(|bytes| host.interject(bytes));
        }
        let is_silent = wires.iter().all(|wire| wire.to_printer.borrow().is_empty());
        if status.is_awaiting_input() && is_silent {
            let sent = |(host, wire): (&mut &mut dyn Host, &Wire)| wire.take(|bytes| host.send(bytes));
            if hosts.iter_mut().zip(&wires).map(sent).sum::<usize>() > 0 {
                idle_ms = 0;
                continue;
            }
        }
        let mut moved = false;
        let end_of_turn = shared.now.get() + TURN;
        for _ in 0..EVENTS_A_TURN {
            while shared.generator.replace(false) {
                generator.run();
            }
            if !shared.stepper.replace(false) {
                let Some(alarm) = shared.alarm.get() else {
                    break;
                };
                let now = shared.now.get();
                let wait = (alarm.wrapping_sub(now as u32) as i32).max(0).unsigned_abs();
                let due = now + u64::from(wait);
                shared.now.set(due.min(end_of_turn));
                if due > end_of_turn {
                    moved = true;
                    break;
                }
            }
            moved = true;
            stepper.on_alarm();
        }
        if moved {
            idle_ms = 0;
        } else {
            idle_ms += 1;
            shared.now.set(shared.now.get() + u64::from(TICKS_PER_MS));
            if idle_ms > PATIENCE_MS {
                return Err(WorldError::Stalled);
            }
        }
    }
    let _ = console.as_mut().poll(&mut context);
    for (host, wire) in hosts.iter_mut().zip(&wires) {
        wire.deliver(*host);
    }
    Ok(Outcome {
        ticks: stepper.tick(),
        moves: status.planned().0,
        path_um: path.um,
        underruns: status.underruns() + status.overload().0,
        low_water: status.low_water(),
        counts: status.counts(),
        halted: status.is_halted(),
    })
}

/// The firmware's path counter wraps at 4.3 km; this one does not.
#[derive(Default)]
struct Path {
    seen: u32,
    um: u64,
}

impl Path {
    fn follow(&mut self, counter: u32) {
        // It also falls, when a move ends early.
        self.um = self.um.wrapping_add_signed(i64::from(counter.wrapping_sub(self.seen) as i32));
        self.seen = counter;
    }
}

impl Wire {
    /// Hands complete lines to the host.
    fn deliver(&self, host: &mut dyn Host) {
        let mut spoken = self.spoken.borrow_mut();
        for byte in self.to_host.borrow_mut().drain(..) {
            if byte == b'\n' {
                host.hear(&spoken);
                spoken.clear();
            } else {
                spoken.push(char::from(byte));
            }
        }
    }

    /// Takes the bytes that `speak` gives, and says how many.
    fn take(&self, speak: impl FnOnce(&mut Vec<u8>)) -> usize {
        let mut bytes = Vec::new();
        speak(&mut bytes);
        self.to_printer.borrow_mut().extend(bytes.iter().copied().map(Received::Byte));
        bytes.len()
    }
}
