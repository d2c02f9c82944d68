//! The queue's own files, and their needs from their room.
#![allow(
    dead_code,
    unreachable_pub,
    unused_imports,
    clippy::redundant_pub_crate,
    reason = "a part of a room, of which not all is used here"
)]

pub mod atomic;
mod explore;
mod interrupt;
mod orders;

#[path = "../../../src/motion/queue/mod.rs"]
pub mod queue;

#[path = "../../../src/motion/ticks.rs"]
pub mod ticks;
