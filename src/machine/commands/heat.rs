//! Heaters and fans, each by its command.

use super::fans::set_fan;
use super::heater_settings::set_model;
use super::heating::{await_heaters, await_readings, heat_and_wait, model_of, set_target};
use super::self_test::test_heaters;
use super::states::States;
use super::tuning::tune;
use crate::connectors::HEATERS;
use crate::gcode::HeatCommand;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;
use crate::settings::ThermalSettings;
use core::pin::pin;

/// Carries out a command about heat.
pub(super) async fn carry_out<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &HeatCommand,
) -> Result<Answer<'static>, Interrupt> {
    let States { clamps, notices, .. } = states;
    Ok(match *command {
        HeatCommand::HeaterTarget { heater, target } => {
            let code = ["M104", "M140", "M141"][heater as usize];
            set_target(main_loop, notices, clamps, code, (heater, target))
                .map_or_else(|answer| answer, |_| Answer::Nothing)
        }
        HeatCommand::HeaterWait { heater, target, cools } => {
            return heat_and_wait(main_loop, notices, clamps, (heater, target), cools).await;
        }
        HeatCommand::AwaitHeaters => return await_heaters(main_loop, notices).await,
        HeatCommand::ReportTemperatures => {
            await_readings(main_loop, [true; HEATERS]).await?;
            Answer::Temperatures
        }
        HeatCommand::FanSpeed { fan, speed } => return set_fan(main_loop, notices, clamps, fan, speed).await,
        HeatCommand::TuneHeater(ref words) => return apart(pin!(tune(main_loop, clamps, words))).await,
        HeatCommand::HeaterModel { heater, is_named, ref words } => match model_of(&main_loop.settings.thermal, heater)
        {
            Ok(heater) => change_heat(main_loop, |s, _| set_model(heater, is_named, words, s, clamps)),
            Err(answer) => answer,
        },
        HeatCommand::SelfTest => return test_heaters(main_loop).await,
    })
}

/// Changes settings of heaters or fans, given the default settings, and reports them.
fn change_heat<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    change: impl FnOnce(&mut ThermalSettings, &ThermalSettings) -> Answer<'static>,
) -> Answer<'static> {
    let defaults = main_loop.settings.defaults().thermal;
    change(main_loop.heat_settings(), &defaults)
}
