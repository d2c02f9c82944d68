//! Emulator: runs the exact image that a user flashes, and records its pins.
//!
//! A model of the chip (the `rigless` crate) executes the release ELF file instruction by instruction in virtual time.
//! Around it stand the board ([`wiring`], [`board`]) with its motor drivers ([`driver_line`]) and hosts on the serial
//! lines ([`mod@line`]), and an accelerometer ([`sensor`], [`sensor_bus`]). The firmware feels the endstops of the
//! simulated machine, the host simulator's ([`mechanics`]). In place of a scripted host, a real one may come through a
//! pseudo-terminal ([`terminal`]). A stand-in for its [`bootloader`] runs before the image. The record ([`steps`],
//! [`safety`], [`clock_rules`], [`unmodelled_accesses`]) is then compared with the steps of the host simulator
//! ([`compare`]).
//!
//! README.md lists the limits of the emulator. Nothing is here without the feature `processor`.
#![cfg(feature = "processor")]

pub mod board;
pub mod bootloader;
pub mod cable;
pub mod calendar;
pub mod chip;
pub mod cli;
pub mod clock_rules;
pub mod clock_tree;
pub mod compare;
pub mod decoder;
pub mod driver_line;
pub mod eeprom;
pub mod firmware;
pub mod flash;
pub mod flash_interface;
pub mod half_periods;
pub mod heat_pins;
pub mod line;
pub mod loads;
pub mod mechanics;
pub mod run;
pub mod safety;
pub mod sensor;
pub mod sensor_bus;
pub mod servo_line;
pub mod small_timers;
pub mod steps;
pub mod terminal;
pub mod tick;
pub mod timer;
mod translation_cache;
pub mod trap;
pub mod uart_decoder;
pub mod unmodelled_accesses;
pub mod usb_discovery;
pub mod usb_habits;
pub mod usb_line;
pub mod usb_port;
pub mod usbip;
pub mod watch;
pub mod wiring;
