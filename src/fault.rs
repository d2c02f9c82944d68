//! Faults: one latch for all contexts. The first cause wins, and what it was outlives the reset that follows.
//!
//! ```text
//!   guard, driver, watchdog ── set ──▶ Latch ──▶ heaters off, motion ends ──▶ Record in RAM that no reset clears
//!                                                                              │ CRC
//!   greeting, M122 ◀── Past ◀──────────────────── read at the next start ◀─────┘
//! ```
//!
//! | word | means |
//! |---|---|
//! | cause | what went wrong, a number that never changes its meaning |
//! | subject | which heater, sensor, motor or context it went wrong with |
//! | record | the last faults, as words for memory that keeps them over a reset |
//! | communication-only mode | after three faults in a minute: hosts are answered, nothing moves or heats |

mod cause;
mod latch;
mod record;

pub use cause::{Cause, Fault};
pub use latch::Latch;
pub use record::{Record, WORDS};
