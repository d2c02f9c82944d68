//! The machine: what each command does, from the line that asked for it to the `ok` that answers it.
//!
//! The [`Console`] is one `async` function that is polled whenever something may have changed; it needs no
//! executor and no waker. Every wait in it turns the same crank: take bytes in, see to emergencies, hand
//! released moves on, send replies out.

mod commands;
mod console;
mod hosts;
mod interrupt;
mod numbers;
mod ports;
mod power;
mod reports;
mod state;
mod stream;

pub use console::{Console, PortSet, Ports};
pub use interrupt::Restart;
