//! Critical sections that leave the step interrupt alone.
//!
//! The usual way, PRIMASK, would delay steps for as long as any queue or waker works. BASEPRI masks from a priority on:
//! everything except the Stepper, which in turn touches nothing that a critical section guards.

use core::arch::asm;
use core::sync::atomic::{Ordering, compiler_fence};

use critical_section::RawRestoreState;

/// Priorities 0x10 and less urgent are masked; 0 is not (ARM DDI 0403E, B1.4.3).
const MASKED: u32 = 0x10;

struct Basepri;
critical_section::set_impl!(Basepri);

// SAFETY: all contexts run on one core, and those that use critical sections have priorities from 0x40 on
// (each chip's table of priorities):
// - while BASEPRI is 0x10, no such interrupt can start. Only the Stepper runs between acquire and release, and it uses
//   no critical section;
// - BASEPRI_MAX never lowers the mask, and `release` restores what `acquire` found, so sections nest;
// - the fences keep the compiler from moving memory accesses out of the section.
unsafe impl critical_section::Impl for Basepri {
    unsafe fn acquire() -> RawRestoreState {
        let before: u32;
        // SAFETY: reads and writes BASEPRI only; the caller keeps to acquire/release order.
        unsafe {
            asm!("mrs {}, BASEPRI", out(reg) before, options(nomem, nostack, preserves_flags));
            asm!("msr BASEPRI_MAX, {}", in(reg) MASKED, options(nomem, nostack, preserves_flags));
        }
        compiler_fence(Ordering::SeqCst);
        before
    }

    unsafe fn release(before: RawRestoreState) {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: `before` is the value that `acquire` read.
        unsafe { asm!("msr BASEPRI, {}", in(reg) before, options(nomem, nostack, preserves_flags)) };
    }
}
