//! The app: puts the rooms together and gives a board its four handles.
//!
//! | handle | context on a board | what it does |
//! |---|---|---|
//! | [`Stepper`] | step-timer interrupt, highest priority, never masked | plays step events on the pins |
//! | [`StepGenerator`] | software-pended interrupt, low priority | turns moves into step events |
//! | [`ThermalControl`] | an interrupt of its own, every 20 ms, above the Console | heaters, fans, guards, watchdog |
//! | [`Console`] | thread or lowest executor | everything else |
//!
//! Each lives in one context, and nobody else holds it.

use crate::kinematics::Groups;
use crate::machine::{Console, PortSet, Ports};
use crate::motion::{Link, MoveMemory, MoveQueue, SpanMemory, StepCounts, StepGenerator, StepQueue, Stepper};
use crate::port::{Clock, DriverBus, Pend, Serial, StepClock, StepPort, Storage, ThermalPort};
use crate::settings::Settings;
use crate::status::Status;
use crate::thermal::{OrderQueue, ThermalControl};
use crate::units::Mm;

/// All memory that the handles share, 33 KiB; the Console and the StepGenerator themselves come on top.
pub struct Memory {
    /// Console to StepGenerator: moves that left the look-ahead, 3.4 KiB.
    moves: MoveQueue,
    /// StepGenerator to Stepper: step events, 4 KiB.
    events: StepQueue,
    /// The StepGenerator's: the trajectory as far back as shapers reach, 9 KiB.
    spans: SpanMemory,
    /// The Console's: the look-ahead, 16 KiB.
    planned: MoveMemory,
    /// Console to ThermalControl, 2 KiB.
    orders: OrderQueue,
    groups: Groups,
    status: Status,
}

// As much as the fields' comments say, on a computer of 64 bits; on a board some are smaller.
const _: () = assert!(size_of::<MoveQueue>() <= 3448);
// This one is of as many bytes everywhere. Another length changes the comments of its field and of `Memory`, and the budget of
// RAM in xtask/src/build/contents.rs.
const _: () = assert!(size_of::<StepQueue>() == 4100);
const _: () = assert!(size_of::<SpanMemory>() <= 9 * 1024 && size_of::<MoveMemory>() <= 16 * 1024);

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

impl Memory {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            moves: MoveQueue::new(),
            events: StepQueue::new(),
            spans: SpanMemory::new(),
            planned: MoveMemory::new(),
            orders: OrderQueue::new(),
            groups: Groups::NONE,
            status: Status::new(),
        }
    }
}

/// The two ports of the step interrupt.
pub struct StepPorts<P: StepPort, C: StepClock> {
    /// Step and direction lines.
    pub pins: P,
    /// Step timer.
    pub clock: C,
}

/// The handles.
pub struct Parts<'m, P: StepPort, C: StepClock, Q: PortSet, H: ThermalPort, W: Pend> {
    /// For the step interrupt.
    pub stepper: Stepper<'m, P, C, W>,
    /// For the generator's interrupt.
    pub generator: StepGenerator<'m>,
    /// For the thermal interrupt.
    pub thermal: ThermalControl<'m, H, W>,
    /// For the Console's task.
    pub console: Console<'m, Q, W>,
    /// For everybody, to look at.
    pub status: &'m Status,
    /// What the motors have done.
    pub counts: StepCounts<'m>,
}

/// Puts a machine together that stands at `start` (x, y, z) if that is known, as if homed. Settings in its
/// storage stand over `settings`, but for the mechanism, which a machine keeps.
pub fn assemble<
    'm,
    P: StepPort,
    C: StepClock,
    S: Serial,
    D: DriverBus,
    K: Clock,
    T: Storage,
    H: ThermalPort,
    W: Pend + Copy,
>(
    memory: &'m mut Memory,
    settings: Settings,
    start: Option<[Mm; 3]>,
    step_ports: StepPorts<P, C>,
    thermal_port: H,
    ports: Ports<S, D, K, T>,
    pend: W,
) -> Parts<'m, P, C, Ports<S, D, K, T>, H, W> {
    let Memory { moves, events, spans, planned, orders, groups, status } = memory;
    *groups = Groups::new(&settings.mechanism);
    let (groups, status): (&'m Groups, &'m Status) = (groups, status);
    let (moves_in, moves_out) = moves.split();
    let (events_in, events_out) = events.split();
    let (orders, orders_in) = orders.split();
    let counts = events_out.counts(status);
    let link = Link::new(moves_in, status, counts, pend);
    Parts {
        stepper: Stepper::new(events_out, status, step_ports.pins, step_ports.clock, pend),
        generator: StepGenerator::new(moves_out, events_in, spans, status, groups),
        thermal: ThermalControl::new(&settings.thermal, orders_in, status, thermal_port, pend),
        console: Console::new(settings, start, planned, orders, groups, link, ports),
        status,
        counts,
    }
}
