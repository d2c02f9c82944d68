//! Kits: the parts of the handles. A board with little stack makes them one by one, each in the place where it stays.

use super::memory::Memory;
use crate::kinematics::Groupings;
use crate::machine::{Console, HostMemory, PortSet, Ports};
use crate::motion::{Entry, Link, MoveMemory, SpanMemory, StepCounts, StepGenerator, Stepper, StepsIn, StepsOut};
use crate::port::{StepClock, StepPort, ThermalPort, Wake};
use crate::settings::Settings;
use crate::status::Status;
use crate::thermal::{Orders, OrdersIn, ThermalControl};
use crate::units::Mm;
use heapless::spsc::Consumer;

/// The two ports of the step interrupt.
pub struct StepPorts<P: StepPort, C: StepClock> {
    /// Step and direction lines.
    pub pins: P,
    /// Step timer.
    pub clock: C,
}

/// A kit for each handle, and the shared status.
pub struct Kits<'m, W: Wake> {
    /// To be made first: the generator asks which of its groups are slow.
    pub stepper: StepperKit<'m>,
    /// For the generator's interrupt.
    pub generator: GeneratorKit<'m>,
    /// For the thermal interrupt.
    pub thermal: ThermalKit<'m>,
    /// For the Console's task.
    pub console: ConsoleKit<'m, W>,
    /// For all contexts, to read.
    pub status: &'m Status,
    /// The step counts of the motors.
    pub counts: StepCounts<'m>,
}

impl<'m, W: Wake> Kits<'m, W> {
    /// The kits of a machine with these settings.
    pub fn new(memory: &'m mut Memory, settings: &Settings, wake: W) -> Self {
        let Memory { moves, events, spans, planned, hosts, orders, groupings, status } = memory;
        *groupings = Groupings::new(&settings.mechanism);
        let (groupings, status): (&'m Groupings, &'m Status) = (groupings, status);
        let (moves_in, moves) = moves.split();
        let (events_in, events) = events.split();
        let (orders, orders_in) = orders.split();
        let counts = events.counts(status);
        Self {
            stepper: StepperKit { events, status },
            generator: GeneratorKit { moves, events: events_in, spans, status, groupings },
            thermal: ThermalKit { orders: orders_in, status },
            console: ConsoleKit { planned, hosts, orders, groupings, link: Link::new(moves_in, status, counts, wake) },
            status,
            counts,
        }
    }
}

/// The parts of a [`Stepper`].
pub struct StepperKit<'m> {
    events: StepsOut<'m>,
    status: &'m Status,
}

impl<'m> StepperKit<'m> {
    /// Makes it.
    pub fn make<P: StepPort, C: StepClock, W: Wake>(self, ports: StepPorts<P, C>, wake: W) -> Stepper<'m, P, C, W> {
        Stepper::new(self.events, self.status, ports.pins, ports.clock, wake)
    }
}

/// The parts of a [`StepGenerator`].
pub struct GeneratorKit<'m> {
    moves: Consumer<'m, Entry>,
    events: StepsIn<'m>,
    spans: &'m mut SpanMemory,
    status: &'m Status,
    groupings: &'m Groupings,
}

impl<'m> GeneratorKit<'m> {
    /// Makes it.
    #[must_use]
    pub fn make(self) -> StepGenerator<'m> {
        StepGenerator::new(self.moves, self.events, self.spans, self.status, self.groupings)
    }
}

/// The parts of a [`ThermalControl`].
pub struct ThermalKit<'m> {
    orders: OrdersIn<'m>,
    status: &'m Status,
}

impl<'m> ThermalKit<'m> {
    /// Makes it.
    pub fn make<H: ThermalPort, W: Wake>(self, settings: &Settings, port: H, wake: W) -> ThermalControl<'m, H, W> {
        ThermalControl::new(&settings.thermal, self.orders, self.status, port, wake)
    }
}

/// The parts of a [`Console`].
pub struct ConsoleKit<'m, W: Wake> {
    planned: &'m mut MoveMemory,
    hosts: &'m mut HostMemory,
    orders: Orders<'m>,
    groupings: &'m Groupings,
    link: Link<'m, W>,
}

impl<'m, W: Wake> ConsoleKit<'m, W> {
    /// Makes the Console, which goes back to these `settings` with M502. If `start` (x, y, z) is known, the machine
    /// stands there as if homed.
    pub fn make<P: PortSet>(
        self,
        settings: &'m Settings,
        start: Option<[Mm; 3]>,
        ports: Ports<P>,
    ) -> Console<'m, P, W> {
        Console::new(settings, start, (self.planned, self.hosts), self.orders, self.groupings, self.link, ports)
    }
}
