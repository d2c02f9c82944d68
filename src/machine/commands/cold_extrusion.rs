//! Cold extrusion: M302, and filament that is left out of moves because the hotend is too cold for it.

use crate::connectors::Heater;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::notices::{Notice, Notices};
use crate::port::Pend;
use crate::settings::{Range, ranges};
use crate::units::Celsius;

/// Whether filament may move at any temperature.
pub(in crate::machine) struct ColdExtrusion {
    /// M302 P1.
    is_allowed: bool,
}

impl ColdExtrusion {
    /// As after a reset: no filament moves in a hotend that is too cold.
    pub const fn new() -> Self {
        Self { is_allowed: false }
    }

    /// M302. Without a hotend nothing can be too cold.
    pub fn set<P: PortSet, W: Pend>(
        &mut self,
        main_loop: &mut MainLoop<'_, P, W>,
        clamps: &mut Clamps,
        least: Option<Number>,
        allow: Option<bool>,
    ) -> Answer<'static> {
        let hotend = main_loop.settings.thermal.heater(Heater::Hotend);
        if !hotend.is_fitted {
            let forbids = least.is_some_and(|least| least > Number::ZERO) || allow == Some(false);
            return Answer::Line(if forbids {
                "echo:Cold extrudes are enabled, and cannot be forbidden without a heater"
            } else {
                "echo:Cold extrudes are enabled"
            });
        }
        if least.is_none() && allow.is_none() {
            return Answer::ColdExtrusion(self.is_allowed);
        }
        if let Some(least) = least {
            let range = Range { most: ranges::MIN_EXTRUDE.most.min(hotend.most), ..ranges::MIN_EXTRUDE };
            clamps.near(["M302", "S"], least, range, &mut main_loop.heat_settings().min_extrude);
            if clamps.refuses_line() {
                return Answer::Nothing;
            }
            self.is_allowed = false;
        }
        if let Some(allow) = allow {
            self.is_allowed = allow;
        }
        Answer::Nothing
    }

    /// Whether filament must not move: the hotend is too cold, or its temperature is unknown.
    pub fn is_too_cold<P: PortSet, W: Pend>(&self, main_loop: &MainLoop<'_, P, W>) -> bool {
        let thermal = &main_loop.settings.thermal;
        thermal.heater(Heater::Hotend).is_fitted
            && !self.is_allowed
            && thermal.min_extrude > Celsius::ZERO
            && main_loop.heat.believed(Heater::Hotend).is_none_or(|celsius| celsius < thermal.min_extrude)
    }
}

/// Reports once per print that filament was left out.
pub(super) async fn tell_of_cold<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
) -> Result<(), Interrupt> {
    if notices.give(Notice::Cold) {
        main_loop.reply(Answer::Line("echo: cold extrusion prevented")).await?;
    }
    Ok(())
}
