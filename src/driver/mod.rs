//! The drivers: TMC2209s are configured, proved to be so, and watched while they have power.
//!
//! The promise: **a motor whose driver can be talked to has power only after that driver has proved to hold the
//! configuration that the firmware counts on, and loses it as soon as the driver is found without.** A driver that
//! was reset runs by its pins, makes other steps than the firmware counts, and would pull against the other three
//! on the belt.
//!
//! [`Drivers`] is stepped by the Console's main loop (see room `machine`) and never waits: at most one exchange goes on, in the background.
//! Everything that switches power goes through it.
//!
//! # Words
//!
//! - **exchange**: a request to one driver and its reply, if one is due: a datagram each way (`datagram`).
//! - **job**: what is to be done with a driver. **run**: a job on its way, several exchanges one after the other (`run`).
//! - **proof**: a run which has shown that the driver holds its configuration. It counts for a short time and for getting
//!   power once. A **quick proof** reads three registers, of a driver that was configured before.
//! - **look**: one register of a driver whose motor has power is read (`watch`). **poll**: all that tell why a driver failed.

mod config;
mod datagram;
mod drivers;
mod error;
mod reading;
mod registers;
mod run;
mod watch;

pub use config::Config;
pub use drivers::Drivers;
pub use error::{DriverError, Fault, Name, News};
pub use reading::Reading;
pub use registers::Register;
pub use run::Job;
