//! The drivers: they are configured, the configuration is proved, and they are watched while they have power.
//!
//! The promise: **A motor with a reachable driver gets power only after the driver has proved its configuration. It
//! loses power as soon as the configuration is lost.** A driver that was reset is configured by its pins. It makes
//! other steps than the firmware counts, and would pull against the other three on the belt.
//!
//! The main loop steps [`Drivers`] (see room `machine`), which never waits: at most one exchange is under way, in the
//! background. All switching of power goes through it. It knows no registers: those are the [`Chip`]'s, and the
//! [`Tmc2209`] is one.
//!
//! # Words
//!
//! - **exchange**: a request to one driver and its reply, if it has one.
//! - **job**: a task for a driver. **run**: a job in progress, several exchanges one after the other (`run`).
//! - **proof**: a run that shows that the driver has its configuration. It is valid for a short time and for one
//!   power-up. A **quick proof** reads three registers of a driver that was configured before.
//! - **look**: one register of a driver with power is read (`watch`). **poll**: all registers that show why a driver
//!   failed are read.

mod chip;
mod drivers;
mod error;
mod reading;
mod run;
mod tmc2209;
mod watch;

pub use chip::{Check, Chip, Held, Scripts, Shown, Step};
pub use drivers::Drivers;
pub use error::{DriverError, Fault, News};
pub use reading::{LOADS, Reading, Registers};
pub use run::DriverJob;
pub use tmc2209::{Register, Tmc2209};
