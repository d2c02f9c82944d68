//! Tests of the images, in one program: tests share translations of an image (`src/translation_cache.rs`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod accelerometer;
mod bringup;
mod clock_check;
mod clocks;
mod common;
mod drivers;
mod fans;
mod faults;
mod heat;
mod heat_crashes;
mod heater_registers;
mod inputs;
mod lines;
mod machines;
mod memory;
mod nucleo;
mod nucleo_flash;
mod plant;
mod restart;
mod servo;
mod spider;
mod steps;
mod storage;
mod usb;
mod usbip;
mod wrong_board;
