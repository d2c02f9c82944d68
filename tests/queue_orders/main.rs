//! The StepQueue's orders of stores: the step interrupt comes in at every place, and loses or invents nothing.
//!
//! The files of the queue are compiled here on a memory of our own ([`motion::atomic`]). The crates that explore
//! threads (loom, shuttle) do not fit. Either of two threads may wait at any place, but an interrupt runs to its end,
//! and its reader relies on that.

mod motion;

mod motors {
    pub use corehbot::motors::*;
}

mod port {
    pub use corehbot::port::*;
}
