//! The power of the motors: the enable lines of their drivers, and which motors a step turns.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use corehbot::port::{Coupling, MotorPower, MotorSet};

use crate::ports;
use crate::step_pins::{Dirs, Steps};
use crate::stepper::couple_step_pins;
use crate::wiring::{Plugged, Port};

/// The enable lines, which are outputs already.
pub struct EnableLines {
    plugged: &'static Plugged,
    /// Room for the levels of another coupling.
    spare: &'static mut Dirs,
}

/// How often the step pins have taken another coupling, wrapping.
static COUPLINGS: AtomicU32 = AtomicU32::new(0);

/// How often the step pins have taken another coupling, wrapping.
pub fn couplings() -> u32 {
    COUPLINGS.load(Relaxed)
}

impl EnableLines {
    /// The lines of a board. Levels of other couplings go into `spare`.
    pub const fn new(plugged: &'static Plugged, spare: &'static mut Dirs) -> Self {
        Self { plugged, spare }
    }
}

impl MotorPower for EnableLines {
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
}
