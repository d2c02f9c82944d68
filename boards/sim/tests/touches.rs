//! Touches of the bed: what bounds them, and what is left when one is refused or ended.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "touches/ended.rs"]
mod ended;
#[path = "common/heated.rs"]
mod heated;
#[path = "common/life.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod life;
#[path = "touches/machine.rs"]
mod machine;
#[path = "common/on_bed.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod on_bed;
#[path = "touches/refused.rs"]
mod refused;
