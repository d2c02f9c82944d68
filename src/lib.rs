//! Firmware core for a CoreH-bot 3D printer, and for any other linear machine that a matrix describes: bytes of G-code
//! go in, step events of the motors come out.
//!
//! The core knows no hardware, no clock and no executor: a board gives it bytes and time and takes step
//! events. The same code therefore runs on the host, in QEMU and on a controller, and gives the same steps.
//!
//! ```text
//! bytes -> protocol -> gcode -> machine -> motion::planner ==MoveQueue==> motion::stepgen ==StepQueue==> stepper
//!                                        |                                                                |
//!                                        +--orders--> thermal --duties--> heaters, fans                   +-> pins
//! ```
//!
//! A **room** is a folder or file directly in `src`, with one job. A room may use only rooms of the lines above its
//! own; `tests/layers.rs` checks every `use`:
//!
//! 1. `units`, `text`, `checksum`
//! 2. `surface`, `motors`, `connectors`, `accelerometer`, and `fault`, which uses `connectors`
//! 3. `status`, and `port`
//! 4. `protocol`, `kinematics`, `settings`, which uses `kinematics`, and `gcode`, which uses `settings`
//! 5. `motion`, `driver`, `storage`, `thermal`
//! 6. `machine`
//! 7. `app`
//!
//! **The paper** describes the CoreH-bot (README.md); **the prototype** is the machine in it, with an 80 mm head:
//! [`settings::Settings::prototype`]. Each room explains its other words at its head.
//!
//! # Example
//!
//! A program that embeds the core, `examples/embed.rs`:
//!
//! ```
#![doc = include_str!("../examples/embed.rs")]
//! ```
#![no_std]
#![forbid(unsafe_code)]

// Before the others, which use its macros.
#[macro_use]
pub mod text;

pub mod accelerometer;
pub mod app;
pub mod checksum;
pub mod connectors;
pub mod driver;
pub mod fault;
pub mod gcode;
pub mod kinematics;
pub mod machine;
pub mod motion;
pub mod motors;
pub mod port;
pub mod protocol;
pub mod settings;
pub mod status;
pub mod storage;
pub mod surface;
pub mod thermal;
pub mod units;
