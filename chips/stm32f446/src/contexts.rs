//! The contexts: each owns one handle of the core, and no other context touches it.

use core::future::poll_fn;
use core::pin::pin;

use corehbot::app::{StepPorts, StepperKit};
use corehbot::fault::Cause;
use corehbot::port::{LINES, Lines, Pend, Received, Serial as _};
use corehbot::status::Status;
use corehbot::{machine, motion, thermal};
use corehbot_cortex_m4::{Handover, finish_stores};
use corehbot_stepgen::generate;
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m_rt::exception;
use embassy_executor::{Executor, SpawnError, SpawnToken, Spawner};
use embassy_stm32::interrupt;
use embassy_stm32::pac::Interrupt;
use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::{Duration, Ticker, Timer};
use static_cell::StaticCell;

use crate::accelerometer::SpiSensor;
use crate::assembly::Handles;
use crate::board_storage::BoardStorage;
use crate::drivers::Drivers;
use crate::heat::BoardHeat;
use crate::host_serial::HostSerial;
use crate::step_pins::{DirRow, Dirs, Row, StepPins, Steps};
use crate::step_timer::{BoardClock, StepTimer};
use crate::usb::{self, UsbPort};
use crate::{fault, heater_timer, pin_scrub, priorities, reset_reason, storm, watchdog};

/// An interrupt that runs the StepGenerator: its device, the second CAN controller, is never switched on.
pub const GENERATOR_IRQ: Interrupt = Interrupt::CAN2_SCE;

/// The ports of a board, except the step ports.
pub type BoardPorts = machine::Ports<HostSerial, Drivers, BoardClock, BoardStorage, SpiSensor>;
type Stepper = motion::Stepper<'static, StepPins, StepTimer, IrqPend>;
/// Heat, with the ports of a board.
pub type ThermalControl = thermal::ThermalControl<'static, BoardHeat, IrqPend>;
/// Steps to be.
pub type StepGenerator = motion::StepGenerator<'static>;
/// Everything else, with the ports of a board.
pub type Console = machine::Console<'static, BoardPorts, IrqPend>;

/// The Stepper itself, which its interrupt finds so with one load less.
static STEPPER: Handover<Stepper> = Handover::new();
static GENERATOR: Handover<&'static mut StepGenerator> = Handover::new();
static THERMAL: Handover<(&'static mut ThermalControl, &'static Status)> = Handover::new();
static EXECUTOR: StaticCell<Executor> = StaticCell::new();
static CONSOLE_WAKER: AtomicWaker = AtomicWaker::new();

/// Makes the Stepper, which lives with its interrupt.
#[inline(never)]
pub fn give_stepper(kit: StepperKit<'static>, ports: StepPorts<StepPins, StepTimer>) {
    STEPPER.fill(kit.make(ports, IrqPend));
}

/// Hands the handles to their contexts and starts them. The processor never sleeps if it must stay `awake`.
pub fn start(handles: Handles, usb: Option<UsbPort>, awake: bool) -> ! {
    let Handles { generator, thermal, console, status } = handles;
    GENERATOR.fill(generator);
    thermal.port().begin();
    THERMAL.fill((thermal, status));
    priorities::enable();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        spawn(spawner, run_console(console));
        spawn(spawner, keep_time());
        spawn(spawner, pin_scrub::run(status));
        if let Some(port) = usb {
            spawn(spawner, usb::serve(port));
        }
        if awake {
            spawn(spawner, stay_awake());
        }
    })
}

/// A message that hosts get again and again.
pub type Message = heapless::String<192>;

/// Communication-only mode: sends hosts the message, and runs nothing else until M999 comes.
pub fn only_talk(lines: Lines<HostSerial>, usb: Option<UsbPort>, message: Message) -> ! {
    priorities::enable();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        spawn(spawner, talk(lines, message));
        // The cycle counter times the calls of interrupts, and it may stand still while the processor sleeps.
        spawn(spawner, stay_awake());
        if let Some(port) = usb {
            spawn(spawner, usb::serve(port));
        }
    })
}

fn spawn<S>(spawner: Spawner, task: Result<SpawnToken<S>, SpawnError>) {
    match task {
        Ok(task) => spawner.spawn(task),
        Err(_) => fault::give_up(Cause::Panic, "a task runs once"),
    }
}

/// Polls the Console whenever [`wake_console`] asks for it. When the Console ends, the machine restarts.
#[embassy_executor::task]
async fn run_console(console: &'static mut Console) {
    let mut run = pin!(console.run());
    poll_fn(|context| {
        CONSOLE_WAKER.register(context.waker());
        run.as_mut().poll(context)
    })
    .await;
    fault::begin_anew()
}

/// Sends the message every two seconds, and waits for M999.
#[embassy_executor::task]
async fn talk(mut lines: Lines<HostSerial>, message: Message) {
    /// Time between two polls; messages are 40 polls apart.
    const LOOK: Duration = Duration::from_millis(50);
    let mut heard = [0_u32; LINES];
    loop {
        lines.iter_mut().for_each(|line| _ = line.send(message.as_bytes()));
        for _ in 0..40 {
            // A line that was masked is not heard again before a reset.
            if storm::fault().is_none() {
                watchdog::feed();
            }
            for (line, last) in lines.iter_mut().zip(&mut heard) {
                while let Some(received) = line.recv() {
                    let Received::Byte(byte) = received else { continue };
                    *last = *last << 8 | u32::from(byte.to_ascii_uppercase());
                    if *last == u32::from_be_bytes(*b"M999") {
                        fault::begin_anew_after_series();
                    }
                }
            }
            Timer::after(LOOK).await;
        }
    }
}

/// Wakes the Console every millisecond.
#[embassy_executor::task]
async fn keep_time() {
    let mut ticker = Ticker::every(Duration::from_millis(1));
    loop {
        ticker.next().await;
        wake_console();
    }
}

/// Leaves the executor no time to sleep.
#[embassy_executor::task]
async fn stay_awake() {
    loop {
        embassy_futures::yield_now().await;
    }
}

/// Asks for a poll of the Console. Not for the Stepper, which no critical section of `critical_section` holds off.
pub fn wake_console() {
    CONSOLE_WAKER.wake();
}

// The section of the handler below begins with a line of flash, so that the handler takes as few lines as it can
// wherever the linker puts it (`octopus_isr_flash_lines` of `cargo xtask bench`).
core::arch::global_asm!(".pushsection .text.SysTick, \"ax\", %progbits", ".p2align 4", ".popsection");

/// A step is due, or software wants the Stepper to look.
// In a section of its own name. So the tool that moves common parts of functions into shared functions, to save flash,
// leaves this one alone.
#[exception]
#[unsafe(link_section = ".text.SysTick")]
fn SysTick() {
    // SAFETY:
    // - `give_stepper` fills the place before any code runs that could set the alarm or pend this exception: the
    //   Stepper, the Console, the StepGenerator and ThermalControl all begin later;
    // - no other code uses the place, and an exception does not interrupt itself.
    unsafe { STEPPER.with_alone(|stepper| stepper.on_alarm()) };
}

/// A row of the step pins' words, copied while nothing interrupts, which is all that ever holds off the Stepper.
pub fn step_pins_row(number: usize) -> Option<Row> {
    cortex_m::interrupt::free(|_| {
        // SAFETY: [`start`] is called after `give_stepper`; no other context runs now, and no caller of this works with
        // the Stepper.
        unsafe { STEPPER.with_alone(|stepper| stepper.port().row(number)) }
    })
}

/// The same of the direction pins.
pub fn step_pins_dir_row(number: usize) -> Option<DirRow> {
    // SAFETY: as for [`step_pins_row`].
    cortex_m::interrupt::free(|_| unsafe { STEPPER.with_alone(|stepper| stepper.port().dir_row(number)) })
}

/// Gives the step pins another coupling, returns the previous one, and sets the direction lines again. At rest: it
/// moves 128 words, some 2 us.
pub fn couple_step_pins(steps: &mut Steps, dirs: &mut &'static mut Dirs) {
    // SAFETY: as for [`step_pins_row`].
    cortex_m::interrupt::free(|_| unsafe {
        STEPPER.with_alone(|stepper| stepper.recouple(|pins| pins.couple(steps, dirs)))
    });
}

/// Software has a move to turn into steps, or room for steps.
#[interrupt]
fn CAN2_SCE() {
    if GENERATOR.with(|generator| generate(generator, &IrqPend)) {
        wake_console();
    }
    finish_stores();
}

/// A control period begins.
#[interrupt]
fn TIM5() {
    heater_timer::acknowledge();
    THERMAL.with(|(thermal, status)| {
        if let Some(fault) = storm::fault() {
            status.fault().set(fault);
        }
        thermal.period();
        // M999 or the watchdog may reset at any time from now on.
        if let Some(fault) = status.fault().fault() {
            reset_reason::note(fault);
        }
    });
    if let Some(second) = heater_timer::count_period() {
        reset_reason::set_uptime(second);
    }
    finish_stores();
}

/// Pends the interrupts of the contexts.
#[derive(Clone, Copy)]
pub struct IrqPend;

impl Pend for IrqPend {
    #[inline]
    fn pend_generator(&self) {
        NVIC::pend(GENERATOR_IRQ);
    }

    #[inline]
    fn pend_stepper(&self) {
        SCB::set_pendst();
    }
}
