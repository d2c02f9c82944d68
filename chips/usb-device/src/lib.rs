//! A driver of OTG_FS, the Synopsys core (DWC2) of STM32 chips, as a device at full speed, for [`embassy_usb_driver`].
//! It has control, bulk and interrupt endpoints of up to 64 bytes a packet. On it there is a serial port.
//!
//! Clocks, pins, session and interrupt belong to the chip. This crate reaches the core by [`Registers`] alone. So it
//! runs on a chip and on the model in `chips/usb-model` alike, and has no `unsafe`.
//!
//! It is not `embassy-usb-synopsys-otg` 0.3.3, because that one ends a print in these cases. `tests/` has each of them.
//! This one is smaller too: it has no high speed, no isochronous endpoints and no host mode.
//!
//! - A host's odd packet is an assertion in the interrupt, and a flush is waited for without end.
//! - A suspend from before a reset wedges the enumeration.
//! - Clear-halt leaves the data toggle as it was.
//! - A stall leaves a packet in flight behind.
//!
//! Rules:
//! - Nothing that a host sends is an assertion, an index or a wait without end.
//! - Every wait for the core has a bound (`wait::POLLS`); the driver goes on after it.
//! - Words go to a transmit FIFO in one piece (errata sheet ES0298, transmit data FIFO).
//! - The interrupt touches the receive FIFO, the flags and endpoint 0; all else belongs to the task.
//!
//! | file | has |
//! |---|---|
//! | `bits` | addresses and bits of registers |
//! | [`registers`] | access to them |
//! | `wait` | waits with a bound |
//! | [`shape`] | the core of a chip, and the shapes of endpoints |
//! | [`state`] | what interrupt and task share |
//! | `stop` | ends what an IN endpoint sends |
//! | `receive` | entries of the receive FIFO |
//! | `stop_out` | ends what OUT endpoints may get |
//! | [`interrupt`] | the interrupt |
//! | [`driver`] | endpoints are given out |
//! | [`bus`] | reset, suspend, resume; endpoints on, off, halted |
//! | [`endpoint`] | packets of bulk and interrupt endpoints |
//! | [`control`] | endpoint 0 |
//! | [`port`] | a serial port on this or any other driver |
//! | `requests` | the host's requests to it |
//! | `descriptors` | its descriptors |
#![no_std]
#![forbid(unsafe_code)]
#![allow(async_fn_in_trait, reason = "the traits are embassy's")]

mod bits;
pub mod bus;
pub mod control;
mod descriptors;
pub mod driver;
pub mod endpoint;
pub mod interrupt;
pub mod port;
mod receive;
pub mod registers;
mod requests;
pub mod shape;
pub mod state;
mod stop;
mod stop_out;
mod wait;

pub use driver::Driver;
pub use interrupt::on_interrupt;
pub use port::{Device, Port};
pub use registers::Registers;
pub use requests::Identity;
pub use shape::Config;
pub use state::State;
