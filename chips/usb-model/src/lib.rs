//! A model of OTG_FS, the USB core of the STM32F446 (a Synopsys DWC2), in device mode at full speed. It has no clock
//! and no processor: a program reads and writes its registers, and a host sends it tokens.
//!
//! Sources: RM0390 rev 6, section 31, for registers and sequences; ES0298 rev 7 for the errata; USB 2.0, chapter 8, for
//! the bus. The driver of the firmware is written from the same sources, but by itself: neither takes a constant from
//! the other.
//!
//! | file | has |
//! |---|---|
//! | [`breach`] | what the manual forbids: the model notes each case |
//! | `bits` | addresses and bits of registers |
//! | `fifo` | the receive FIFO and its entries |
//! | `endpoint` | the state of an endpoint |
//! | [`core`](mod@core) | the core, as its program sees it: registers and the interrupt line; `endpoints` has theirs |
//! | `bus` | the core, as a host sees it: tokens, handshakes, reset, suspend |
//! | [`host`] | a host: transfers in stages, with toggles and retries |
//!
//! Not modelled: isochronous endpoints, DMA (the F446's OTG_FS has none), link power management, host mode, and the
//! times of the bus. A start of frame comes only when the host sends it.
#![forbid(unsafe_code)]

mod bits;
pub mod breach;
mod bus;
pub mod core;
mod endpoint;
mod fifo;
pub mod host;

pub use breach::Breach;
pub use bus::{Handshake, InAnswer};
pub use core::UsbCore;
