//! M710: the fan of the controller.

use super::fan_speed::FULL;
use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Grammar;
use crate::machine::reports::heat_settings_report::report_controller_fan;
use crate::settings::{FanRole, Range, ThermalSettings, ranges};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[710])
    .grammar(&Grammar::numbers(b"SD"))
    .does("S D, R", "controller fan: speed, run-on in s; R restores; or reports")
    .examples(&[
        ("M710", &["  M710 S255 D60"]),
        ("M710 S128 D30", &[]),
        ("M710 S999 D9999", &["echo:M710 ignored: D9999 is out of range (0 to 3600), stays 60"]),
        ("M710 S999", &["echo:M710 S999 is out of range, set to 255"]),
        ("M710 I1", &["echo:M710 I is not supported by this firmware"]),
        ("M710 R", &[]),
        ("M710 D", &["echo:line ignored: D needs a number"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let (speed, run_on, resets) = (command.number(b'S'), command.number(b'D'), command.has(b'R'));
    let other: Option<&[u8]> = if command.has(b'I') { Some(b"I") } else { command.has(b'A').then_some(b"A") };
    if speed.or(run_on).is_none() && !resets && other.is_none() {
        return Answer::words(&|to, facts| report_controller_fan(to, &facts.settings.thermal));
    }
    let defaults = main_loop.settings.defaults().thermal;
    let thermal = main_loop.heat_settings();
    let ThermalSettings { mut fans, fan_run_on_s: mut run_on_s, .. } = *thermal;
    let controllers = fans.iter_mut().zip(&defaults.fans).filter(|(fan, _)| fan.role == FanRole::Controller);
    for (fan, default) in controllers {
        if resets {
            fan.most = default.most.max(fan.least);
        }
        if let Some(speed) = speed {
            let least = fan.least.max(ranges::MAX_DUTY.least);
            let range = Range { least: least.saturating_mul_int(255), ..FULL };
            if let Some(speed) = clamps.near_of(["M710", "S"], speed, range, None) {
                fan.most = (speed / 255).max(least);
            }
        }
    }
    if resets {
        run_on_s = defaults.fan_run_on_s;
    }
    if let Some(seconds) = run_on {
        clamps.whole(["M710", "D"], seconds, ranges::RUN_ON_S, &mut run_on_s);
    }
    if !clamps.refuses_line() {
        (thermal.fans, thermal.fan_run_on_s) = (fans, run_on_s);
    }
    other.map_or(Answer::Nothing, |word| Answer::NotObeyed("M710", word))
}
