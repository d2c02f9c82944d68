//! Faults: one latch for all contexts. The first cause wins, and its record survives the following reset.
//!
//! ```text
//!   guard, driver, watchdog ── set ──▶ Latch ──▶ heaters off, motion ends ──▶ Record in RAM that no reset clears
//!                                                                              │ CRC
//!   greeting, M122 ◀── Past ◀──────────────────── read at the next start ◀─────┘
//! ```
//!
//! | word | means |
//! |---|---|
//! | cause | the kind of fault, a number that never changes its meaning |
//! | subject | the heater, sensor, motor or context with the fault |
//! | record | the last faults, as words in memory that survives a reset |
//! | communication-only mode | after three faults in a minute: hosts get replies, nothing moves or heats |

mod cause;
mod latch;
mod record;

pub use cause::{Cause, Fault};
pub use latch::Latch;
pub use record::{Record, WORDS};
