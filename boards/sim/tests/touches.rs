//! Touches of the bed: what bounds them, and what is left when one is refused or ended.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "touches/ended.rs"]
mod ended;
#[path = "touches/heat.rs"]
mod heat;
#[path = "common/heated.rs"]
mod heated;
#[path = "touches/known.rs"]
mod known;
#[path = "common/life.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod life;
#[path = "touches/machine.rs"]
mod machine;
#[path = "common/on_bed.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod on_bed;
#[path = "touches/reach.rs"]
mod reach;
#[path = "touches/refused.rs"]
mod refused;
