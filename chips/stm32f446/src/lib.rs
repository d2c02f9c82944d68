//! What boards with an STM32F446 share: everything but pins.
//!
//! A board is a [`Board`](wiring::Board), a table of pins, and calls `run` with it and with the memory that it has for settings.
//!
//! | priority | context | runs |
//! |---|---|---|
//! | 0x00 | TIM2 | Stepper; nothing masks it |
//! | 0x40 | USART2, DMA1 stream 5, TIM3 | bytes, embassy's time |
//! | 0x80 | CAN2_SCE, pended by software | StepGenerator |
//! | thread | embassy executor | Console, watchdog |
//!
//! `unsafe` stays in `fault`, `flash`, `last_words` and `priorities`.
#![cfg_attr(target_os = "none", no_std)]

pub mod flash_pages;
pub mod memory;
pub mod wiring;

#[cfg(target_os = "none")]
mod bus;
#[cfg(target_os = "none")]
mod clocks;
#[cfg(target_os = "none")]
mod contexts;
#[cfg(target_os = "none")]
mod eeprom;
#[cfg(target_os = "none")]
mod enable_lines;
#[cfg(target_os = "none")]
mod fault;
#[cfg(target_os = "none")]
mod flash;
#[cfg(target_os = "none")]
mod last_words;
#[cfg(target_os = "none")]
mod ports;
#[cfg(target_os = "none")]
mod priorities;
#[cfg(target_os = "none")]
mod receiver;
#[cfg(target_os = "none")]
mod safe_levels;
#[cfg(target_os = "none")]
mod serial;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod step_pins;
#[cfg(target_os = "none")]
mod step_timer;
#[cfg(target_os = "none")]
mod thermistors;
#[cfg(target_os = "none")]
mod watchdog;

#[cfg(target_os = "none")]
pub use eeprom::eeprom;
#[cfg(target_os = "none")]
pub use flash::flash;
#[cfg(target_os = "none")]
pub use start::run;
