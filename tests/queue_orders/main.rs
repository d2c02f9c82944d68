//! The StepQueue's orders of stores: the step interrupt comes in at every place, and loses or invents nothing.
//!
//! The files of the queue are compiled here on a memory of our own ([`motion::atomic`]). The crates that explore
//! threads (loom, shuttle) do not fit. Either of two threads may wait at any place, but an interrupt runs to its end,
//! and its reader relies on that.
//!
//! The queue's files find their room and the rooms below it behind `crate::`. So this is a program of its own: behind
//! `crate::` the other tests have their own modules, and the queue has this memory.

mod motion;

mod motors {
    pub use corehbot::motors::*;
}

mod port {
    pub use corehbot::port::*;
}
