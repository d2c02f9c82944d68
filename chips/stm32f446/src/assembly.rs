//! Assembly: one function makes each handle of the core, in the place where the handle stays. So no two handles are on
//! the stack at once. Their contexts begin later.

use corehbot::app::{ConsoleKit, GeneratorKit, Kits, Memory, StepPorts, ThermalKit};
use corehbot::settings::Settings;
use corehbot::status::Status;
use static_cell::{ConstStaticCell, StaticCell};

use crate::board_heat::BoardHeat;
use crate::handles::{BoardPorts, Console, StepGenerator, ThermalControl};
use crate::step_pins::StepPins;
use crate::step_timer::StepTimer;
use crate::stepper::give_stepper;
use crate::wake::IrqWake;

static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::new());
static GENERATOR: StaticCell<StepGenerator> = StaticCell::new();
static THERMAL: StaticCell<ThermalControl> = StaticCell::new();
static CONSOLE: StaticCell<Console> = StaticCell::new();

/// The handles, except the Stepper, which is in its interrupt's place already.
pub struct Handles {
    /// For the generator's interrupt.
    pub generator: &'static mut StepGenerator,
    /// For the thermal interrupt.
    pub thermal: &'static mut ThermalControl,
    /// For the Console's task.
    pub console: &'static mut Console,
    /// Shared by all contexts.
    pub status: &'static Status,
}

/// Puts the machine together.
#[inline(never)]
pub fn assemble(
    settings: &'static Settings,
    step_ports: StepPorts<StepPins, StepTimer>,
    heat: BoardHeat,
    ports: BoardPorts,
) -> Handles {
    let Kits { stepper, generator, thermal, console, status, .. } = Kits::new(MEMORY.take(), settings, IrqWake);
    give_stepper(stepper, step_ports);
    Handles {
        generator: make_generator(generator),
        thermal: make_thermal(thermal, settings, heat),
        console: make_console(console, settings, ports),
        status,
    }
}

#[inline(never)]
fn make_generator(kit: GeneratorKit<'static>) -> &'static mut StepGenerator {
    GENERATOR.init_with(|| kit.make())
}

#[inline(never)]
fn make_thermal(kit: ThermalKit<'static>, settings: &Settings, heat: BoardHeat) -> &'static mut ThermalControl {
    THERMAL.init_with(|| kit.make(settings, heat, IrqWake))
}

#[inline(never)]
fn make_console(
    kit: ConsoleKit<'static, IrqWake>,
    settings: &'static Settings,
    ports: BoardPorts,
) -> &'static mut Console {
    CONSOLE.init_with(|| kit.make(settings, None, ports))
}
