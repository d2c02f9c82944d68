//! The contexts: each owns one handle of the core, and nobody else touches it.

use core::future::poll_fn;
use core::pin::pin;
use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::app::Parts;
use corehbot::port::Pend;
use corehbot::{machine, motion};
use corehbot_cortex_m4::Handover;
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m_rt::exception;
use embassy_executor::{Executor, Spawner};
use embassy_stm32::interrupt;
use embassy_stm32::pac::Interrupt;
use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::{Duration, Ticker};
use static_cell::StaticCell;

use crate::drivers::Drivers;
use crate::host_serial::HostSerial;
use crate::memory::BoardStorage;
use crate::step_pins::StepPins;
use crate::step_timer::{BoardClock, StepTimer};
use crate::thermistors::Thermistors;
use crate::usb::{self, UsbPort};
use crate::watchdog::Watchdog;
use crate::{fault, priorities};

/// An interrupt that runs the StepGenerator: its device, the second CAN controller, is never switched on.
pub const GENERATOR_IRQ: Interrupt = Interrupt::CAN2_SCE;

/// The ports of a board, but for those of the steps.
pub type BoardPorts = machine::Ports<HostSerial, Drivers, BoardClock, BoardStorage>;
/// The core with the ports of a board.
pub type BoardParts = Parts<'static, StepPins, StepTimer, BoardPorts, Thermistors, IrqPend>;
type Stepper = motion::Stepper<'static, StepPins, StepTimer, IrqPend>;
type StepGenerator = motion::StepGenerator<'static>;
type Console = machine::Console<'static, BoardPorts, IrqPend>;

/// The Stepper itself, which its interrupt finds so with one load less.
static STEPPER: Handover<Stepper> = Handover::new();
static GENERATOR: Handover<&'static mut StepGenerator> = Handover::new();
static EXECUTOR: StaticCell<Executor> = StaticCell::new();
static CONSOLE_WAKER: AtomicWaker = AtomicWaker::new();

/// How often the StepGenerator has run, wrapping: its sign of life.
pub static BEATS: AtomicU32 = AtomicU32::new(0);

/// Hands the parts to their contexts and lets them loose.
/// The processor never sleeps if it must stay `awake`.
pub fn start(parts: &'static mut BoardParts, usb: Option<UsbPort>, watchdog: Watchdog, awake: bool) -> ! {
    // SAFETY: it stays where it was put together for ever, but nobody uses it there.
    STEPPER.fill(unsafe { core::ptr::read(&parts.stepper) });
    GENERATOR.fill(&mut parts.generator);
    priorities::enable();
    let console = &mut parts.console;
    EXECUTOR.init(Executor::new()).run(|spawner| spawn(spawner, console, usb, watchdog, awake))
}

fn spawn(spawner: Spawner, console: &'static mut Console, usb: Option<UsbPort>, watchdog: Watchdog, awake: bool) {
    match (run_console(console, watchdog), keep_time()) {
        (Ok(console), Ok(time)) => {
            spawner.spawn(console);
            spawner.spawn(time);
        }
        _ => fault::give_up("a task runs once"),
    }
    match usb.map(usb::serve) {
        Some(Ok(serve)) => spawner.spawn(serve),
        Some(Err(_)) => fault::give_up("a task runs once"),
        None => {}
    }
    match awake.then(stay_awake) {
        Some(Ok(stay)) => spawner.spawn(stay),
        Some(Err(_)) => fault::give_up("a task runs once"),
        None => {}
    }
}

/// Polls the Console whenever [`wake_console`] asks for it, and feeds the watchdog if all contexts live. When the Console
/// ends, the machine begins anew.
#[embassy_executor::task]
async fn run_console(console: &'static mut Console, mut watchdog: Watchdog) {
    let mut run = pin!(console.run());
    poll_fn(|context| {
        CONSOLE_WAKER.register(context.waker());
        let poll = run.as_mut().poll(context);
        watchdog.look();
        poll
    })
    .await;
    fault::begin_anew()
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

/// Has the Console look at the world again. Not for the Stepper, which no critical section holds off.
pub fn wake_console() {
    CONSOLE_WAKER.wake();
}

/// A step is due, or software wants the Stepper to look.
// In a section of its own name, and so not one of the functions whose common parts are put into functions of their own to
// save flash.
#[exception]
#[unsafe(link_section = ".text.SysTick")]
fn SysTick() {
    // SAFETY:
    // - `start` fills the place before anybody who could set the alarm or pend this exception runs: the Stepper, the
    //   Console, the StepGenerator and the watchdog all begin later;
    // - nobody else uses the place, and an exception does not interrupt itself.
    unsafe { STEPPER.with_alone(|stepper| stepper.on_alarm()) };
}

/// Software has a move to turn into steps, or room for steps.
#[interrupt]
fn CAN2_SCE() {
    GENERATOR.with(|generator| generator.run(&IrqPend));
    BEATS.store(BEATS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    wake_console();
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
