//! Cold extrusion: M302, and filament that is left out of moves because the hotend is too cold for it.

use crate::connectors::Heater;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::notices::Notice;
use crate::port::Pend;
use crate::settings::{Range, ranges};
use crate::units::Celsius;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M302. Without a hotend nothing can be too cold.
    pub(in crate::machine) fn set_cold_extrusion(
        &mut self,
        least: Option<Number>,
        allow: Option<bool>,
    ) -> Answer<'static> {
        let hotend = self.settings.thermal.heater(Heater::Hotend);
        if !hotend.is_fitted {
            let forbids = least.is_some_and(|least| least > Number::ZERO) || allow == Some(false);
            return Answer::Line(if forbids {
                "echo:Cold extrudes are enabled, and cannot be forbidden without a heater"
            } else {
                "echo:Cold extrudes are enabled"
            });
        }
        if least.is_none() && allow.is_none() {
            return Answer::ColdExtrusion(self.allows_cold);
        }
        if let Some(least) = least {
            let range = Range { most: ranges::MIN_EXTRUDE.most.min(hotend.most), ..ranges::MIN_EXTRUDE };
            self.settings.thermal.min_extrude = self.clamps.near(["M302", "S"], least, range);
            self.allows_cold = false;
        }
        if let Some(allow) = allow {
            self.allows_cold = allow;
        }
        self.heat_orders.note_settings();
        Answer::Nothing
    }

    /// Whether no filament may move: the hotend is too cold for it, or nobody knows.
    pub(in crate::machine) fn is_too_cold(&self) -> bool {
        let thermal = &self.settings.thermal;
        thermal.heater(Heater::Hotend).is_fitted
            && !self.allows_cold
            && thermal.min_extrude > Celsius::ZERO
            && self.measured()[Heater::Hotend as usize] < thermal.min_extrude
    }

    /// Tells once a print that filament was left out.
    pub(in crate::machine) async fn tell_of_cold(&mut self) -> Result<(), Interrupt> {
        if self.notices.give(Notice::Cold) {
            self.tell(Answer::Line("echo: cold extrusion prevented")).await?;
        }
        Ok(())
    }
}
