//! Tuning among the other work of thermal control.

use super::ThermalControl;
use crate::port::{ThermalPort, Wake};
use crate::status::Tuning;
use crate::units::Celsius;

impl<H: ThermalPort, W: Wake> ThermalControl<'_, H, W> {
    /// Ends each tuning, and switches its heater off.
    pub(super) fn stop_tuning(&mut self) {
        for heater in self.heaters.iter_mut().filter_map(|heater| heater.tuning().is_some().then_some(heater)) {
            heater.set_target(Celsius::ZERO);
            self.status.heat().set_tuning(Tuning::None);
        }
    }

    /// Reports the progress of a tuning; a finished one switches its heater off.
    pub(super) fn report_tuning(&mut self) {
        for heater in &mut self.heaters {
            let Some(tune) = heater.tuning() else { continue };
            let state = tune.state();
            let is_done = matches!(state, Tuning::Done | Tuning::DoneWithoutFan);
            if let (true, Ok(tuned)) = (is_done, tune.find()) {
                self.status.heat().set_tuned(&tuned);
            }
            self.status.heat().set_tuning(state);
            if is_done || matches!(state, Tuning::Failed(_)) {
                heater.set_target(Celsius::ZERO);
            }
        }
    }
}
