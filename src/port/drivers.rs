//! The motors: their power, and the wires on which their drivers are configured.

use crate::motors::{Coupling, Motor, MotorSet};

/// The power of the motors, and which of them a step turns.
pub trait MotorPower {
    /// Powers exactly the motors of `on`, all that change in one transaction.
    fn enable(&mut self, on: MotorSet);

    /// From now on a step of a group turns these motors: the step pins take it, and their direction lines are set again
    /// ([`Stepper::recouple`](crate::motion::Stepper::recouple)). Nothing moves during the change.
    fn couple(&mut self, coupling: &Coupling);
}

/// The wires on which drivers are configured.
///
/// One exchange, a request and its reply, runs at a time, in parallel with all other work: nothing here blocks, and no
/// caller awaits it.
pub trait DriverBus {
    /// Motors with a driver that can be reached; the others run as their jumpers say.
    fn lines(&self) -> MotorSet;

    /// Sends the request to the driver of a motor that is in [`lines`](Self::lines), and then listens for `reply`
    /// bytes. An exchange under way is dropped.
    fn begin(&mut self, motor: Motor, request: &Frame, reply: usize);

    /// The outcome of the exchange, once; `None` while it is under way. Every exchange ends by itself in bounded time.
    fn outcome(&mut self) -> Option<Result<Frame, BusError>>;
}

/// For machines with drivers that run as their jumpers say.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoBus;

impl DriverBus for NoBus {
    fn lines(&self) -> MotorSet {
        MotorSet::NONE
    }

    fn begin(&mut self, _motor: Motor, _request: &Frame, _reply: usize) {}

    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        Some(Err(BusError::Silent))
    }
}

/// The bytes of one direction of an exchange; the longest datagram has eight (TMC2209 datasheet rev 1.09,
/// section 4.1).
pub type Frame = heapless::Vec<u8, 8>;

/// Why an exchange with a driver failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BusError {
    /// No answer, or one that stopped in the middle: no motor supply, no driver, no wire.
    Silent,
    /// The received signal is no byte: a stop bit is low.
    Garbled,
}
