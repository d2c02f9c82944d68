//! Tuning among the other work of thermal control.

use super::super::tune::Tune;
use super::ThermalControl;
use crate::connectors::Heater;
use crate::port::{ThermalPort, Wake};
use crate::status::Tuning;
use crate::units::Celsius;

impl<H: ThermalPort, W: Wake> ThermalControl<'_, H, W> {
    /// The tuning that is under way, and its heater.
    pub(super) fn tuning(&self) -> Option<(Heater, &Tune)> {
        let (heater, tune) = self.tune.as_ref()?;
        self.heaters[*heater as usize].is_tuned().then_some((*heater, tune))
    }

    /// Whether the board drives a fan that cools what is printed.
    fn has_part_fan(&self) -> bool {
        self.parts.iter().take(self.port.fans()).any(|is_part| *is_part)
    }

    /// Begins a tuning, which ends the one of another heater.
    pub(super) fn begin_tuning(&mut self, heater: Heater, target: Celsius, cycles: u8) {
        self.stop_tuning();
        let has_fan = heater == Heater::Hotend && self.has_part_fan();
        let tune = self.heaters[heater as usize].tune(target, cycles, has_fan);
        self.tune = tune.map(|tune| (heater, tune));
    }

    /// Ends the tuning, and switches its heater off.
    pub(super) fn stop_tuning(&mut self) {
        if let Some((heater, _)) = self.tuning() {
            self.heaters[heater as usize].set_target(Celsius::ZERO);
            self.status.heat().set_tuning(Tuning::None);
        }
    }

    /// Reports the progress of a tuning; a finished one switches its heater off.
    pub(super) fn report_tuning(&mut self) {
        let Some((heater, tune)) = self.tuning() else { return };
        let state = tune.state();
        let is_done = matches!(state, Tuning::Done | Tuning::DoneWithoutFan);
        if let (true, Ok(tuned)) = (is_done, tune.find()) {
            self.status.heat().set_tuned(&tuned);
        }
        self.status.heat().set_tuning(state);
        if is_done || matches!(state, Tuning::Failed(_)) {
            self.heaters[heater as usize].set_target(Celsius::ZERO);
        }
    }
}
