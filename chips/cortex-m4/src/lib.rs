//! What boards with a Cortex-M4 share, whoever made the chip.
//!
//! Linking this crate provides the critical sections of `masking`: they leave priority 0 alone, which is the
//! step interrupt's. Everybody else has a priority of 0x40 or more.
//!
//! `unsafe` stays in `handover` and `masking`, which are small for that reason.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
mod handover;
#[cfg(target_os = "none")]
mod masking;

#[cfg(target_os = "none")]
pub use handover::Handover;
