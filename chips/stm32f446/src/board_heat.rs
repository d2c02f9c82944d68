//! Heat: a board's heaters, fans and sensors, as the core's thermal port.

use corehbot::port::{OUTPUTS, OutputSet, Sensor, ThermalPort};
use corehbot::units::Celsius;
use cortex_m::peripheral::DWT;

use crate::fans::Fans;
use crate::heater_timer::HeaterTimer;
use crate::reference_voltage::ReferenceVoltage;
use crate::tachometers::Tachometers;
use crate::thermistors::Thermistors;
use crate::wiring::{Contact, Plugged, SupplySwitch};
use crate::{ports, reset_reason, watchdog};

/// Heaters, fans and sensors of a board, and its watchdog.
pub struct BoardHeat {
    outputs: OutputSet,
    thermistors: Thermistors,
    reference: Option<ReferenceVoltage>,
    timer: HeaterTimer,
    fans: Fans,
    supply_switch: Option<SupplySwitch>,
    filament: Option<Contact>,
    tachometers: Tachometers,
    /// All sensors that were asked for in this period have delivered.
    is_sampled: bool,
    /// The cycle counter when the watchdog was fed last.
    cycles: u32,
}

impl BoardHeat {
    /// Takes the timers, converters and pins, with everything off except the power supply. The supply stays off too if
    /// it was switched off before the reset, because a heater did not go off otherwise.
    pub fn start(plugged: &Plugged, is_supplied: bool) -> Self {
        let board = plugged.board;
        let thermistors = Thermistors::start(board.thermistors);
        let reference = (!board.thermistors.is_empty()).then(ReferenceVoltage::start);
        if let Some(switch) = plugged.supply_switch {
            ports::put(switch.pin, is_supplied == switch.is_on_high);
            // Modes change only here: a later change of the register would race with interrupts and lose their changes.
            ports::make_output(switch.pin);
        }
        Self {
            outputs: board.outputs(),
            thermistors,
            reference,
            timer: HeaterTimer::start(board.heaters),
            fans: Fans::start(board.fans, plugged.frequencies),
            supply_switch: plugged.supply_switch,
            filament: plugged.filament,
            tachometers: Tachometers::start(plugged.tachometers),
            is_sampled: true,
            cycles: DWT::cycle_count(),
        }
    }

    /// Starts the first control period.
    pub fn begin(&mut self) {
        self.heat(&[0; OUTPUTS]);
    }
}

impl ThermalPort for BoardHeat {
    /// Takes 22 us at the most in a control period, and 0.2 ms if the converter has stopped.
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        let sample = self.thermistors.sample(sensor);
        self.is_sampled &= sample.is_some() || !self.thermistors.has(sensor);
        sample
    }

    fn reference(&mut self) -> Option<u16> {
        self.reference.as_mut()?.read()
    }

    fn mcu(&mut self) -> Option<Celsius> {
        self.reference.as_ref()?.celsius()
    }

    fn outputs(&self) -> OutputSet {
        self.outputs
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.timer.heat(duties);
        self.thermistors.forget();
        if let Some(reference) = &mut self.reference {
            reference.begin();
        }
    }

    fn fans(&self) -> usize {
        self.fans.len()
    }

    fn set_fan(&mut self, fan: usize, duty: u16) {
        self.fans.set_fan(fan, duty);
    }

    fn tachometer(&self, fan: usize) -> Option<u16> {
        self.tachometers.pulses(fan)
    }

    fn filament(&self) -> Option<bool> {
        self.filament.map(|contact| ports::is_high(contact.input.pin) == contact.is_high_when_triggered())
    }

    fn has_supply_switch(&self) -> bool {
        self.supply_switch.is_some()
    }

    fn switch_supply(&mut self, on: bool) {
        if let Some(switch) = self.supply_switch {
            if !on {
                reset_reason::note_supply_off();
            }
            ports::put(switch.pin, on == switch.is_on_high);
        }
    }

    /// Feeds the watchdog, unless a wired sensor has delivered nothing since the last time: without temperatures
    /// nothing is safe. Does not feed it either if the cycle counter stands still, because steps have no time then. (A
    /// debugger that detaches may have switched the counter off.)
    fn feed_watchdog(&mut self) {
        let cycles = DWT::cycle_count();
        let has_time = cycles != core::mem::replace(&mut self.cycles, cycles);
        if core::mem::replace(&mut self.is_sampled, true) && has_time {
            watchdog::feed();
        }
    }
}
