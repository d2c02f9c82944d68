//! The clock, and the way to wake another context.

use crate::units::Instant;

/// The Console's clock.
pub trait Clock {
    /// Time since start.
    fn now(&self) -> Instant;
}

/// A way to wake another context: a board pends the interrupt that runs it.
pub trait Wake {
    /// Wakes the StepGenerator's context.
    fn wake_generator(&self);

    /// Wakes the Stepper's context (its alarm may be silent).
    fn wake_stepper(&self);
}
