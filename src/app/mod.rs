//! The app: puts the rooms together and gives a board its four handles.
//!
//! | handle | context on a board | task |
//! |---|---|---|
//! | [`Stepper`] | step-timer interrupt, highest priority, never masked | plays step events on the pins |
//! | [`StepGenerator`] | software-pended interrupt, low priority | turns moves into step events |
//! | [`ThermalControl`] | an interrupt of its own, every 20 ms, above the Console | heaters, fans, guards, watchdog |
//! | [`Console`] | thread or lowest executor | everything else |
//!
//! Each lives in one context, which alone owns it. [`assemble`] makes them all at once, [`Kits`] one by one.

mod kits;
mod memory;

pub use kits::{ConsoleKit, GeneratorKit, Kits, StepPorts, StepperKit, ThermalKit};
pub use memory::Memory;

use crate::machine::{Console, PortSet, Ports};
use crate::motion::{StepCounts, StepGenerator, Stepper};
use crate::port::{StepClock, StepPort, ThermalPort, Wake};
use crate::settings::Settings;
use crate::status::Status;
use crate::thermal::ThermalControl;
use crate::units::Mm;

/// The handles.
pub struct Parts<'m, P: StepPort, C: StepClock, Q: PortSet, H: ThermalPort, W: Wake> {
    /// For the step interrupt.
    pub stepper: Stepper<'m, P, C, W>,
    /// For the generator's interrupt.
    pub generator: StepGenerator<'m>,
    /// For the thermal interrupt.
    pub thermal: ThermalControl<'m, H, W>,
    /// For the Console's task.
    pub console: Console<'m, Q, W>,
    /// For all contexts, to read.
    pub status: &'m Status,
    /// The step counts of the motors.
    pub counts: StepCounts<'m>,
}

/// Puts a machine together that stands at `start` (x, y, z) if that is known, as if homed. Settings in its storage
/// override `settings`, except the mechanism, which a machine keeps.
pub fn assemble<'m, P: StepPort, C: StepClock, Q: PortSet, H: ThermalPort, W: Wake + Copy>(
    memory: &'m mut Memory,
    settings: &'m Settings,
    start: Option<[Mm; 3]>,
    step_ports: StepPorts<P, C>,
    thermal_port: H,
    ports: Ports<Q>,
    wake: W,
) -> Parts<'m, P, C, Q, H, W> {
    let Kits { stepper, generator, thermal, console, status, counts } = Kits::new(memory, settings, wake);
    Parts {
        stepper: stepper.make(step_ports, wake),
        generator: generator.make(),
        thermal: thermal.make(settings, thermal_port, wake),
        console: console.make(settings, start, ports),
        status,
        counts,
    }
}
