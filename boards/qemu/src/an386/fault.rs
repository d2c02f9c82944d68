//! The last words: a panic or a fault is reported on the emulator's standard error and ends the run.

use core::fmt::Write as _;
use core::panic::PanicInfo;

use semihosting::io::{self, Write as _};
use semihosting::process;

/// Exit status: the run could not continue.
const FAILED: i32 = 1;
/// Exit status: a panic, as std has it.
const PANICKED: i32 = 101;
/// Exit status: a fault of the processor.
const FAULTED: i32 = 102;

/// Turns `core::fmt` output into semihosting writes; a failure cannot be reported anywhere.
struct Stderr(io::Stderr);

impl core::fmt::Write for Stderr {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        self.0.write_all(text.as_bytes()).map_err(|_| core::fmt::Error)
    }
}

/// The run cannot continue: prints the reason and ends it.
pub fn give_up(reason: core::fmt::Arguments<'_>) -> ! {
    report(reason);
    process::exit(FAILED)
}

/// Prints a message for the person at the emulator.
fn report(message: core::fmt::Arguments<'_>) {
    if let Ok(stderr) = io::stderr() {
        let _ = writeln!(Stderr(stderr), "{message}");
    }
}

#[panic_handler]
fn on_panic(info: &PanicInfo<'_>) -> ! {
    report(format_args!("{info}"));
    process::exit(PANICKED)
}

/// A HardFault may come from a full stack that cannot take another push. So the handler fetches the initial stack
/// pointer from the vector table (at 0 on this board) before it runs Rust code.
// SAFETY: cortex-m-rt wants the handler under this name. Nothing returns from it, so it may forget the stack and the
// registers, and `describe` gets the core's values in them.
#[unsafe(no_mangle)]
#[unsafe(naked)]
pub unsafe extern "C" fn HardFault() -> ! {
    core::arch::naked_asm!(
        "mrs r0, MSP",
        "movs r1, #0",
        "ldr r1, [r1]",
        "msr MSP, r1",
        "b {describe}",
        describe = sym describe,
    )
}

extern "C" fn describe(stack: usize) -> ! {
    // SAFETY: SCB is a fixed address; the registers are only read.
    let scb = unsafe { &*cortex_m::peripheral::SCB::PTR };
    report(format_args!(
        "HardFault: CFSR {:#010x} HFSR {:#010x} BFAR {:#010x} SP {stack:#010x}",
        scb.cfsr.read(),
        scb.hfsr.read(),
        scb.bfar.read(),
    ));
    process::exit(FAULTED)
}
