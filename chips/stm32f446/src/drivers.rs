//! The motor drivers: their enable lines, and the UART of each.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use corehbot::connectors::BoardConnectors;

use corehbot::port::{BusError, Coupling, DriverBus, Frame, Motor, MotorSet};

use crate::driver_uart::DriverUart;
use crate::ports;
use crate::servo;
use crate::step_pins::{Dirs, Steps};
use crate::stepper::couple_step_pins;
use crate::supply;
use crate::wiring::{Plugged, Port};

/// Switches drivers on and off, and talks to the drivers that have a UART.
pub struct Drivers {
    plugged: &'static Plugged,
    /// Why no motor gets power.
    refusal: Option<&'static str>,
    uart: DriverUart,
    /// Room for the levels of another coupling.
    spare: &'static mut Dirs,
}

/// How often the step pins have taken another coupling, wrapping.
static COUPLINGS: AtomicU32 = AtomicU32::new(0);

/// How often the step pins have taken another coupling, wrapping.
pub fn couplings() -> u32 {
    COUPLINGS.load(Relaxed)
}

impl Drivers {
    /// The drivers of a board; their enable lines are outputs already. `refusal` says why they must stay off, if they
    /// must. Levels of other couplings go into `spare`.
    pub fn start(plugged: &'static Plugged, refusal: Option<&'static str>, spare: &'static mut Dirs) -> Self {
        Self { plugged, refusal, uart: DriverUart::start(plugged.board), spare }
    }
}

impl DriverBus for Drivers {
    /// First finds all words and then stores them, with nothing except a step in between: all changing lines change
    /// within a microsecond or two.
    fn enable(&mut self, on: MotorSet) {
        let words = Port::ALL.map(|port| {
            let low = self.plugged.enable_lines(on, port);
            let high = self.plugged.enable_lines(MotorSet::ALL, port) & !low;
            high | low << 16
        });
        critical_section::with(|_| {
            for (port, word) in Port::ALL.into_iter().zip(words) {
                ports::store(ports::registers(port), word);
            }
        });
    }

    fn couple(&mut self, coupling: &Coupling) {
        let mut steps = Steps::new(self.plugged, coupling);
        *self.spare = Dirs::new(self.plugged, coupling);
        couple_step_pins(&mut steps, &mut self.spare);
        COUPLINGS.store(couplings().wrapping_add(1), Relaxed);
    }

    fn lines(&self) -> MotorSet {
        self.plugged.uarts()
    }

    fn begin(&mut self, motor: Motor, request: &Frame, reply: usize) {
        self.uart.begin(self.plugged.uart(motor), request, reply);
    }

    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        self.uart.outcome()
    }

    fn servo(&mut self, micros: Option<u16>) {
        if self.plugged.servo.is_some() {
            servo::order(micros);
        }
    }

    fn connectors(&self) -> &'static BoardConnectors {
        self.plugged.board.connectors
    }

    fn refusal(&self) -> Option<&'static str> {
        self.refusal
    }

    fn warning(&self) -> Option<&'static str> {
        supply::warning()
    }
}
