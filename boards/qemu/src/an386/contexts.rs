//! The contexts: each owns one handle of the core, and no other context touches it.

use core::future::poll_fn;
use core::pin::pin;
use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::app::Parts;
use corehbot::driver::Tmc2209;
use corehbot::kinematics::Groups;
use corehbot::machine;
use corehbot::motion::{self, StepCounts};
use corehbot::port::{AnyBoard, Coupling, MotorPower, MotorSet, NoAccelerometer, NoBus, NoServo, NoStorage, Wake};
use corehbot::thermal::{self, PERIOD_MS};
use corehbot_cortex_m4::Handover;
use corehbot_rig::thermal_plant::Heat;
use corehbot_stepgen::generate;
use cortex_m::peripheral::{NVIC, Peripherals, SCB};
use embassy_executor::InterruptExecutor;

use super::console_waker::{register, wake_console};
use super::fault::give_up;
use super::irq::{self, Irq};
use super::serial::{self, UartSerial};
use super::time::{self, BoardClock, StepTimer};
use super::trace::{self, TracePort};

/// The ports of this board, except the step ports.
pub enum BoardPorts {}

impl machine::PortSet for BoardPorts {
    type Serial = UartSerial;
    type Motors = Motors;
    type Drivers = NoBus;
    type Chip = Tmc2209;
    type Servo = NoServo;
    type Board = AnyBoard;
    type Clock = BoardClock;
    type Storage = NoStorage;
    type Accelerometer = NoAccelerometer;
}

/// The core with the ports of this board.
pub type BoardParts = Parts<'static, TracePort, StepTimer, BoardPorts, Heat, BoardWake>;
type Stepper = motion::Stepper<'static, TracePort, StepTimer, BoardWake>;
type StepGenerator = motion::StepGenerator<'static>;
type ThermalControl = thermal::ThermalControl<'static, Heat, BoardWake>;
type Console = machine::Console<'static, BoardPorts, BoardWake>;

static STEPPER: Handover<&'static mut Stepper> = Handover::new();
static GENERATOR: Handover<&'static mut StepGenerator> = Handover::new();
static THERMAL: Handover<(&'static mut ThermalControl, StepCounts<'static>, Groups)> = Handover::new();
static EXECUTOR: InterruptExecutor = InterruptExecutor::new();
/// Milliseconds since start, wrapping.
static MILLISECONDS: AtomicU32 = AtomicU32::new(0);

/// Hands the parts to their contexts and enables the interrupts.
pub fn start(parts: &'static mut BoardParts, groups: Groups) {
    let Some(mut peripherals) = Peripherals::take() else { give_up(format_args!("start-up runs once")) };
    STEPPER.fill(&mut parts.stepper);
    GENERATOR.fill(&mut parts.generator);
    THERMAL.fill((&mut parts.thermal, parts.counts, groups));
    irq::prioritise(&mut peripherals.NVIC, &mut peripherals.SCB);
    irq::enable();
    time::start(peripherals.SYST);
    serial::start();
    match run_console(&mut parts.console) {
        Ok(task) => EXECUTOR.start(Irq::Console).spawn(task),
        Err(_) => give_up(format_args!("the Console runs once")),
    }
}

/// Stops stepping and brings the trace to its end.
pub fn finish() {
    NVIC::mask(Irq::StepTimer);
    trace::finish();
}

/// Polls the Console whenever [`wake_console`] asks for it.
#[embassy_executor::task]
async fn run_console(console: &'static mut Console) {
    let mut run = pin!(console.run());
    poll_fn(|context| {
        register(context.waker());
        run.as_mut().poll(context)
    })
    .await;
    // The emulator resets the machine, which loads the image and reads its job again.
    SCB::sys_reset()
}

/// Interrupt: a step is due, or software wants the Stepper to look.
pub extern "C" fn on_step_timer() {
    StepTimer::acknowledge();
    // SAFETY: `start` fills the place before it enables this interrupt, no other code uses it, and an interrupt does
    // not interrupt itself.
    unsafe { STEPPER.with_alone(|stepper| stepper.on_alarm()) };
}

/// Interrupt of software: there is a move to turn into steps, or room for steps.
pub extern "C" fn on_generator() {
    if GENERATOR.with(|generator| generate(generator, &BoardWake)) {
        wake_console();
    }
}

/// Interrupt of software: a control period of the heaters has passed.
pub extern "C" fn on_thermal() {
    THERMAL.with(|(thermal, counts, groups)| {
        thermal.period();
        // Counting walks through the queue of step events.
        if thermal.port().plant().is_some() {
            let counts = groups.motor_counts(counts.read());
            let extruded = groups.mechanism().extruder().map_or(0, |motor| counts[motor.index()]);
            thermal.port().advance(extruded, f64::from(PERIOD_MS) / 1000.0);
        }
    });
}

/// Interrupt of software: a task of the executor was woken.
pub extern "C" fn on_console() {
    // SAFETY: this is the executor's interrupt handler, and `InterruptExecutor::start` enables it.
    unsafe { EXECUTOR.on_interrupt() };
}

/// Interrupt: a millisecond has passed.
#[cortex_m_rt::exception]
fn SysTick() {
    time::beat();
    wake_console();
    let ms = MILLISECONDS.load(Ordering::Relaxed).wrapping_add(1);
    MILLISECONDS.store(ms, Ordering::Relaxed);
    if ms.is_multiple_of(PERIOD_MS) {
        NVIC::pend(Irq::Thermal);
    }
}

/// SimWake the software interrupts.
#[derive(Clone, Copy)]
pub struct BoardWake;

impl Wake for BoardWake {
    fn wake_generator(&self) {
        NVIC::pend(Irq::Generator);
    }

    fn wake_stepper(&self) {
        NVIC::pend(Irq::StepTimer);
    }
}

/// The motors of the emulated machine, which always have power.
pub struct Motors;

impl MotorPower for Motors {
    fn enable(&mut self, _on: MotorSet) {}

    fn couple(&mut self, coupling: &Coupling) {
        cortex_m::interrupt::free(|_| {
            STEPPER.with(|stepper| stepper.recouple(|port| port.couple(coupling)));
        });
    }
}
