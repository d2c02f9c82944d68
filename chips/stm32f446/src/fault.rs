//! Faults: heaters low, drivers off, a note for later, reset. Nothing continues with outputs live.

use core::panic::PanicInfo;

use corehbot::fault::{Cause, Fault};
use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;

use crate::panic_path::{Calls, word};
use crate::{reset_reason, safe_levels, stack_guard};

/// The part of CFSR about the MPU (ARM DDI 0403E, B3.2.15).
const MEMORY: u32 = 0xFF;

/// MMARVALID: MMFAR holds the address.
const MEMORY_ADDRESS: u32 = 1 << 7;

/// STKERR and MSTKERR: the stacked registers are not those of the interrupted code.
const NOT_PUSHED: u32 = 1 << 12 | 1 << 4;

/// First action of every handler: stops all other contexts, sets heaters low and switches drivers off.
#[inline(always)]
fn make_safe() {
    cortex_m::interrupt::disable();
    safe_levels::assume();
}

/// The way that all faults end; the outputs are safe already.
fn end((cause, value, limit): (Cause, u32, u32), reason: core::fmt::Arguments<'_>) -> ! {
    let (value, limit) = (value.cast_signed(), limit.cast_signed());
    reset_reason::note(Fault { cause, subject: 0, value, limit });
    reset_reason::leave(reason);
    SCB::sys_reset()
}

/// The user wants a reset. If the thermal context has noted a reason, it is reported after the reset.
pub fn begin_anew() -> ! {
    make_safe();
    reset_reason::end_series();
    SCB::sys_reset()
}

/// The user has seen that faults come in a series, and wants to try again.
pub fn begin_anew_after_series() -> ! {
    make_safe();
    reset_reason::forget();
    SCB::sys_reset()
}

/// The firmware cannot continue.
pub fn give_up(cause: Cause, reason: &str) -> ! {
    make_safe();
    end((cause, 0, 0), format_args!("{reason}"))
}

/// The place and the message of a panic are not read ([`panic_path`](crate::panic_path)). The values are the second and
/// the third call: the first one is the core library's own.
#[panic_handler]
#[inline(never)]
fn on_panic(_: &PanicInfo<'_>) -> ! {
    make_safe();
    let calls = Calls::here();
    let [value, limit] = [1, 2].map(|place| calls.clone().nth(place).unwrap_or_default());
    end((Cause::Panic, value, limit), format_args!("a panic, called at{calls}"))
}

/// The crystal has stopped (RM0390, 6.2.7), or memory is at fault.
// SAFETY: the handler never returns and shares only atomics with the interrupted code.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    make_safe();
    end((Cause::ClockFailed, 0, 0), format_args!("the crystal has stopped"))
}

/// An interrupt or exception that was never enabled.
// SAFETY: as for NonMaskableInt.
#[exception]
unsafe fn DefaultHandler(irq: i16) -> ! {
    make_safe();
    end((Cause::Panic, irq.cast_unsigned().into(), 0), format_args!("interrupt {irq}, which nobody enabled"))
}

/// A HardFault may come from a full stack that cannot take another push: the handler takes a fresh one before it runs
/// Rust code.
// SAFETY: cortex-m-rt wants the handler under this name. Nothing returns from it, so it may forget the
// stack and the registers; `_stack_start` is the end of the stack in RAM (memory.x).
#[unsafe(no_mangle)]
#[unsafe(naked)]
pub unsafe extern "C" fn HardFault() -> ! {
    core::arch::naked_asm!(
        "mrs r0, MSP",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr MSP, r1",
        "b {describe}",
        describe = sym describe,
    )
}

extern "C" fn describe(stack: u32) -> ! {
    make_safe();
    // SAFETY: SCB is a fixed address; the registers are only read.
    let scb = unsafe { &*SCB::PTR };
    let (cause, bus, memory) = (scb.cfsr.read(), scb.bfar.read(), scb.mmfar.read());
    let counter = if cause & NOT_PUSHED == 0 { counter(stack) } else { 0 };
    if cause & MEMORY != 0 && stack_guard::is_overflow(stack) {
        let text =
            format_args!("a stack overflow: CFSR {cause:08x} MMFAR {memory:08x} PC {counter:08x} SP {stack:08x}");
        end((Cause::StackOverflow, memory, counter), text)
    }
    let address = if cause & MEMORY_ADDRESS != 0 { memory } else { bus };
    let text = format_args!("a hard fault: CFSR {cause:08x} FAR {address:08x} PC {counter:08x} SP {stack:08x}");
    end((Cause::HardFault, cause, counter), text)
}

/// The program counter that the core pushed at `stack`, or 0 if that is outside of RAM.
fn counter(stack: u32) -> u32 {
    /// Offset of the program counter in the exception frame (ARM DDI 0403E, B1.5.6).
    const OFFSET: u32 = 24;
    stack.checked_add(OFFSET).and_then(word).unwrap_or_default()
}
