//! M302: the temperature below which no filament moves.

use crate::connectors::Heater;
use crate::gcode::{Entry, Grammar, Number, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::shortest;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
use crate::settings::{Range, ranges};
use crate::units::Celsius;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[302])
    .grammar(&Grammar::numbers(b"SP"))
    .does("S P", "least temperature for filament; P1 allows any; or reports")
    .examples(&[
        ("M302", &["echo:Cold extrudes are enabled"]),
        ("M302 S170", &["echo:Cold extrudes are enabled, and cannot be forbidden without a heater"]),
        ("M302 P0", &["echo:Cold extrudes are enabled, and cannot be forbidden without a heater"]),
        ("M302 S0", &["echo:Cold extrudes are enabled"]),
        ("M302 P", &["echo:line ignored: P needs a number"]),
    ]);

/// Without a hotend nothing can be too cold. P0 forbids, any other P allows.
pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { cold, clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let (least, allow) = (command.number(b'S'), command.number(b'P').map(|allow| allow != Number::ZERO));
    let hotend = main_loop.settings.thermal.heater(Heater::Hotend);
    if !hotend.is_fitted {
        let forbids = least.is_some_and(|least| least > Number::ZERO) || allow == Some(false);
        return Answer::Line(if forbids {
            packed!("echo:Cold extrudes are enabled, and cannot be forbidden without a heater")
        } else {
            packed!("echo:Cold extrudes are enabled")
        });
    }
    if least.is_none() && allow.is_none() {
        let least = main_loop.settings.thermal.min_extrude;
        let state = if cold.is_allowed() || least <= Celsius::ZERO { "enabled" } else { "disabled" };
        main_loop.say(text!("echo:Cold extrudes are {state} (min temp {}C)", shortest(least)));
        return Answer::Said;
    }
    if let Some(least) = least {
        let range = Range { most: ranges::MIN_EXTRUDE.most.min(hotend.most), ..ranges::MIN_EXTRUDE };
        clamps.near(["M302", "S"], least, range, &mut main_loop.heat_settings().min_extrude);
        if clamps.refuses_line() {
            return Answer::Nothing;
        }
        cold.allow(false);
    }
    if let Some(allow) = allow {
        cold.allow(allow);
    }
    Answer::Nothing
}
