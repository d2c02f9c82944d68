//! The machine: what each command does, from the line that asked for it to the `ok` that answers it.
//!
//! The [`Console`] is one `async` function that is polled whenever something may have changed; it needs no
//! executor and no waker. Every wait in it turns the same crank: take bytes in, see to emergencies, hand
//! released moves on, send replies out.

mod angle;
mod answer;
mod arc;
mod autoreport;
mod clamps;
mod console;
mod driver_report;
mod drivers;
mod execute;
mod flow;
mod halted;
mod homing;
mod hosts;
mod keeping;
mod limits;
mod message;
mod modal;
mod motion;
mod pause;
mod ports;
mod power;
mod report;
mod retraction;
mod sensors;
mod setting;
mod shaping;
mod slowdown;
mod tuning;

pub use console::{Console, PortSet, Ports, Restart};
