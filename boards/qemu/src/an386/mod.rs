//! The board: the contexts' priorities, and the start-up that hands everything out.
//!
//! | priority | context | runs |
//! |---|---|---|
//! | 0x00 | APB timer 0 | Stepper; nothing masks it |
//! | 0x40 | UART 0, SysTick | bytes, milliseconds |
//! | 0x80 | software interrupt | StepGenerator |
//! | 0xA0 | software interrupt, every 20 ms | ThermalControl, and the plant that it heats |
//! | 0xC0 | software interrupt | Console, a task of an embassy executor |
//! | thread | [`idle`] | virtual time |
//!
//! `unsafe` stays in `registers`, `irq`, `vectors`, `contexts`, `fault`, `stack` and `idle`.

mod console_waker;
mod contexts;
mod copies;
mod fault;
mod idle;
mod irq;
mod job;
mod registers;
mod serial;
mod stack;
mod time;
mod trace;
mod vectors;

use corehbot::app::{self, Memory, StepPorts};
use corehbot::kinematics::{Groups, MotorTable};
use corehbot::machine::Ports;
use corehbot::port::{AnyBoard, Lines, NoAccelerometer, NoBus, NoServo, NoStorage};
use corehbot::settings::Settings;
use corehbot::status::Status;
use corehbot_rig::Rig;
use corehbot_rig::bed::BedPlant;
use corehbot_rig::thermal_plant::Heat;
use defmt_semihosting as _;
use semihosting::process;
use static_cell::{ConstStaticCell, StaticCell};

defmt::timestamp!("{=u64:us}", time::micros());

static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::new());
static MACHINE: StaticCell<Settings> = StaticCell::new();
static PARTS: StaticCell<contexts::BoardParts> = StaticCell::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    if job::is_asked_for(copies::ASKED) {
        copies::check();
    }
    let status = start_up();
    defmt::info!("ready; stack: {} of {} bytes used", stack::used(), stack::size());
    stack::forget();
    idle::run(status);
    contexts::finish();
    let overload = status.overload();
    defmt::info!(
        "{} moves; times the host was too slow: {}, the generator: {}, the stepper: {}",
        status.planned().0,
        overload.underruns,
        overload.starved,
        overload.events.count
    );
    defmt::info!("last byte at tick {}, last step at tick {}", serial::last_byte(), trace::last_step());
    defmt::info!("stack: {} of {} bytes used", stack::used(), stack::size());
    process::exit(0)
}

/// Builds and starts the machine. A separate function, so that its temporaries do not stay on the stack.
#[inline(never)]
fn start_up() -> &'static Status {
    let job = job::read();
    let settings: &Settings = MACHINE.init(job.settings);
    let rig = Rig::new(&job.settings, job.start);
    let table = MotorTable::new(&Groups::new(&job.settings.mechanism).coupling());
    let step_ports = StepPorts {
        pins: trace::TracePort::new(rig, BedPlant::of(&job.settings), table, job.trace),
        clock: time::StepTimer,
    };
    let groups = Groups::new(&job.settings.mechanism);
    let heat = Heat::new(&job.settings);
    let ports = Ports {
        serial: Lines::from_array([serial::UartSerial::new()]),
        motors: contexts::Motors,
        drivers: NoBus,
        servo: NoServo,
        board: AnyBoard,
        clock: time::BoardClock,
        storage: NoStorage,
        accelerometer: NoAccelerometer,
    };
    // In this form the parts are built in their place; they are too large to be carried about.
    let parts = PARTS
        .init_with(|| app::assemble(MEMORY.take(), settings, job.start, step_ports, heat, ports, contexts::BoardWake));
    if let Some(mesh) = &job.mesh {
        parts.console.lay_mesh(mesh);
    }
    let status = parts.status;
    contexts::start(parts, groups);
    status
}
