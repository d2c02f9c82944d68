//! Shared by boards with a Cortex-M4 of any maker.
//!
//! Linking this crate provides the critical sections of `masking`: they do not mask priority 0, which is the step
//! interrupt's. All other interrupts have a priority of 0x40 or more.
//!
//! `unsafe` stays in `handover` and `masking`, which are small for that reason.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
mod handover;
#[cfg(target_os = "none")]
mod masking;

#[cfg(target_os = "none")]
pub use handover::Handover;
