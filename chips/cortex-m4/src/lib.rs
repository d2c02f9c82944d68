//! Shared by boards with a Cortex-M4 of any maker.
//!
//! Linking this crate provides the critical sections of `masking`: they do not mask priority 0, which is the step
//! interrupt's. All other interrupts have a priority of 0x40 or more.
//!
//! It also provides copies and divisions, which the compiler calls, for those of `compiler_builtins` (`copies`,
//! `division`).
//!
//! `unsafe` stays in `division`, `handover` and `masking`, which are small for that reason, and assembly in `copies`.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
mod copies;
#[cfg(any(test, target_os = "none"))]
mod division;
#[cfg(target_os = "none")]
mod handover;
#[cfg(target_os = "none")]
mod masking;

#[cfg(target_os = "none")]
pub use handover::Handover;

/// The last statement of every interrupt below the step interrupt: waits until its stores have arrived.
///
/// A store may still be in the write buffer when an exception returns. Then the processor may miss the exception that
/// is pending, or take another one (ARM erratum 838869 of the Cortex-M4). The step interrupt would come late. No
/// emulation shows this.
#[cfg(target_os = "none")]
#[inline(always)]
pub fn finish_stores() {
    cortex_m::asm::dsb();
}
