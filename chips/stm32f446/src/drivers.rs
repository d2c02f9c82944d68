//! The wires to the motor drivers.

use corehbot::port::{BusError, DriverBus, Frame, Motor, MotorSet};

use crate::driver_uart::DriverUart;
use crate::wiring::Plugged;

/// Talks to the drivers that have a UART.
pub struct Drivers {
    plugged: &'static Plugged,
    uart: DriverUart,
}

impl Drivers {
    /// The drivers of a board.
    pub fn start(plugged: &'static Plugged) -> Self {
        Self { plugged, uart: DriverUart::start(plugged.board) }
    }
}

impl DriverBus for Drivers {
    fn lines(&self) -> MotorSet {
        self.plugged.uarts()
    }

    fn begin(&mut self, motor: Motor, request: &Frame, reply: usize) {
        self.uart.begin(self.plugged.uart(motor), request, reply);
    }

    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        self.uart.outcome()
    }
}
