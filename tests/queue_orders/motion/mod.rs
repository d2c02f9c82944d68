//! The queue's own files, and what they need of the room that they come from.
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

/// Counts of steps, which nobody asks for here.
pub mod step_counts {
    use super::queue::StepQueue;
    use crate::status::Status;
    use std::marker::PhantomData;

    pub struct StepCounts<'m>(PhantomData<&'m ()>);

    impl<'m> StepCounts<'m> {
        pub const fn new(_: &'m StepQueue, _: &'m Status) -> Self {
            Self(PhantomData)
        }
    }
}

/// What the queue needs of the room that fills it.
pub mod stepgen {
    /// The steps of a group that are known, in whose place there is nothing here.
    pub mod step_time_buffer {
        pub struct StepTimeReader {
            pub tick: u32,
        }

        impl StepTimeReader {
            pub fn advance(&mut self) {
                self.advance_by(1);
            }

            pub fn advance_by(&mut self, count: usize) {
                self.tick = self.tick.wrapping_add(count as u32);
            }

            pub fn following(&self) -> &[u32] {
                &[]
            }
        }

        pub fn is_before(a: u32, b: u32) -> bool {
            (a.wrapping_sub(b)).cast_signed() < 0
        }
    }

    pub mod group_stepper {
        /// As far as the generator makes steps ahead; here only in a bound at compile time.
        pub const NEAR: u32 = 1 << 18;
    }
}
