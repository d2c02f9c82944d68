//! The contexts: each owns one handle of the core, and no other context touches it.

use core::future::poll_fn;
use core::pin::pin;

use corehbot::fault::{Cause, Fault};
use corehbot::port::{LINES, Lines, Received, Serial as _};
use corehbot::status::Status;
use corehbot_cortex_m4::{Handover, finish_stores};
use corehbot_stepgen::generate;
use embassy_executor::{Executor, SpawnError, SpawnToken, Spawner};
use embassy_stm32::interrupt;
use static_cell::StaticCell;

use crate::assembly::Handles;
use crate::console_waker::{self, wake_console};
use crate::handles::{Console, StepGenerator, ThermalControl};
use crate::host_serial::HostSerial;
use crate::usb::{self, UsbPort};
use crate::wake::IrqWake;
use crate::{
    clock_check, fault, heater_timer, interrupt_storm, pin_scrub, priorities, ram_walk, reset_reason, time, watchdog,
};

static GENERATOR: Handover<&'static mut StepGenerator> = Handover::new();
static THERMAL: Handover<(&'static mut ThermalControl, &'static Status)> = Handover::new();
/// Lines and message of [`talk`]. The task would hold them twice.
static TALKER: StaticCell<(Lines<HostSerial>, Message)> = StaticCell::new();
static EXECUTOR: StaticCell<Executor> = StaticCell::new();

/// Hands the handles to their contexts and starts them. The processor never sleeps if it must stay `awake`.
pub fn start(handles: Handles, usb: Option<UsbPort>, awake: bool) -> ! {
    let Handles { generator, thermal, console, status } = handles;
    GENERATOR.fill(generator);
    thermal.port().begin();
    THERMAL.fill((thermal, status));
    priorities::enable();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        spawn(spawner, run_console(console));
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
        spawn(spawner, talk(TALKER.init((lines, message))));
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
        console_waker::register(context.waker());
        run.as_mut().poll(context)
    })
    .await;
    fault::begin_anew()
}

/// Sends the message every two seconds, and waits for M999.
#[embassy_executor::task]
async fn talk(talker: &'static mut (Lines<HostSerial>, Message)) {
    /// Time between two polls in ms; messages are 40 polls apart.
    const LOOK: u32 = 50;
    let (lines, message) = talker;
    let mut heard = [0_u32; LINES];
    loop {
        lines.iter_mut().for_each(|line| _ = line.send(message.as_bytes()));
        for _ in 0..40 {
            // A line that was masked is not heard again before a reset.
            if interrupt_storm::fault().is_none() {
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
            time::pass(LOOK).await;
        }
    }
}

/// Leaves the executor no time to sleep.
#[embassy_executor::task]
async fn stay_awake() {
    loop {
        embassy_futures::yield_now().await;
    }
}

/// Software has a move to turn into steps, or room for steps.
#[interrupt]
fn CAN2_SCE() {
    if GENERATOR.with(|generator| generate(generator, &IrqWake)) {
        wake_console();
    }
    finish_stores();
}

/// A control period begins.
#[interrupt]
fn TIM5() {
    heater_timer::acknowledge();
    THERMAL.with(|(thermal, status)| {
        if let Some(fault) = interrupt_storm::fault() {
            status.fault().set(fault);
        }
        if !clock_check::is_right() {
            status.fault().set(Fault::plain(Cause::ClockFailed));
        }
        thermal.period();
        // M999 or the watchdog may reset at any time from now on.
        if let Some(fault) = status.fault().fault() {
            reset_reason::note(fault);
        }
    });
    ram_walk::walk_on();
    if let Some(second) = heater_timer::count_period() {
        reset_reason::set_uptime(second);
    }
    finish_stores();
}
