//! Sockets and inputs: directions of motors, levels of switches, kinds of drivers.

use super::defines::Defines;
use super::look::Look;
use super::others;
use super::parts::board;
use crate::marlin::Given;
use crate::marlin::work::Work;
use crate::translation::Kind;
use toml::Value as Toml;

/// What needs the names and plugs of motors and switches.
pub(super) fn after(work: &mut Work<'_>, defines: &Defines, given: Given) {
    let mut look = Look { work, defines };
    if let Some(entry) = look.entry("MOTHERBOARD") {
        let name = look.defines.find("MOTHERBOARD").map_or("", |define| define.value.as_str());
        let of_file = board(look.defines).map(|board| board.key);
        match (of_file, given.board) {
            (Some(key), Some(board)) if key == board.key => {
                look.work.say(entry, Kind::Taken, format!("board = {key:?}"))
            }
            (_, Some(board)) => look.work.say(entry, Kind::NotNeeded, format!("--board names the {}", board.name)),
            (_, None) => {
                let text = format!("{name} is not supported: --board names the board that the machine gets");
                look.work.say(entry, Kind::Decide, text);
            }
        }
    }
    directions(&mut look);
    for motor in ["X", "X2", "Y", "Y2", "Z", "Z2", "Z3", "Z4", "E0"] {
        drivers(&mut look, motor);
    }
    for axis in ["X", "Y", "Z"] {
        let end = if look.defines.of(&format!("{axis}_HOME_DIR")).is_some_and(|dir| dir > 0.0) { "MAX" } else { "MIN" };
        let path = format!("endstops.{}", axis.to_ascii_lowercase());
        for other in ["MIN", "MAX"] {
            for leaf in ["ENDSTOP_INVERTING", "ENDSTOP_HIT_STATE"] {
                let name = format!("{axis}_{other}_{leaf}");
                if other == end {
                    contact(&mut look, &name, &path);
                } else {
                    look.say(&name, Kind::NotNeeded, "no switch there homes the axis");
                }
            }
        }
    }
    for name in ["Z_MIN_PROBE_ENDSTOP_INVERTING", "Z_MIN_PROBE_ENDSTOP_HIT_STATE"] {
        contact(&mut look, name, "endstops.probe");
    }
    others::after(&mut look);
}

/// Directions. Each motor of an axis follows its INVERT_X_DIR, and INVERT_X2_VS_X_DIR turns the second one over
/// (`X_APPLY_DIR` and its relatives in `Marlin/src/module/stepper.cpp`, `X_DIR_WRITE` in `stepper/indirection.h`). An
/// INVERT_X2_DIR stands for INVERT_X_DIR (`Marlin/src/inc/Conditionals-4-adv.h`).
fn directions(look: &mut Look<'_, '_, '_>) {
    for motor in ["X", "Y", "Z", "E0"] {
        let first = format!("INVERT_{motor}_DIR");
        turned(look, &path_of(motor), &[&first]);
        for part in 2..=4 {
            let (own, over) = (format!("INVERT_{motor}{part}_DIR"), format!("INVERT_{motor}{part}_VS_{motor}_DIR"));
            let base = if look.defines.find(&own).is_some() { &own } else { &first };
            let path = path_of(&format!("{motor}{part}"));
            if look.work.lines.get(&path).is_some() {
                turned(look, &path, &[base, &over]);
            } else {
                look.say(&over, Kind::NotNeeded, "no such motor of the axis");
            }
        }
    }
}

/// The socket of one of Marlin's motors: Z2 is our z1.
fn path_of(motor: &str) -> String {
    match motor.split_at(1) {
        ("E", _) => "motors.e0".to_owned(),
        (axis, part) => {
            let part = part.parse::<usize>().map_or_else(|_| String::new(), |part| (part - 1).to_string());
            format!("motors.{}{part}", axis.to_ascii_lowercase())
        }
    }
}

/// A direction: `!` in front of the socket, if an odd number of defines turns the motor over.
fn turned(look: &mut Look<'_, '_, '_>, path: &str, names: &[&str]) {
    if look.work.lines.get(path).is_some() {
        let is_turned = names.iter().filter(|name| look.defines.has(name)).count() % 2 == 1;
        mark(look, names, path, is_turned);
    }
}

/// A contact: Marlin's level of a switch that has triggered. With `inverting`, or a low one, it closes to ground.
fn contact(look: &mut Look<'_, '_, '_>, name: &str, path: &str) {
    let Some(define) = look.defines.find(name) else { return };
    let closes = define.value == "LOW" || look.defines.has(name);
    let closes = if name.ends_with("HIT_STATE") { define.value == "LOW" } else { closes };
    if look.work.lines.get(path).is_some() {
        mark(look, &[name], path, closes);
    }
}

/// Puts `!` in front of a connector, or of the place for it, and says so of the defines that decide it.
fn mark(look: &mut Look<'_, '_, '_>, names: &[&str], path: &str, is_marked: bool) {
    let plug = look.work.lines.get(path).and_then(Toml::as_str).unwrap_or_default().to_owned();
    let names: Vec<&str> = names.iter().copied().filter(|name| look.entry(name).is_some()).collect();
    if names.is_empty() {
        return;
    }
    let is_open = plug.is_empty();
    let how = match (is_marked, is_open) {
        (false, _) => format!("{path} is without `!`"),
        (true, false) => format!("{path} has `!`"),
        (true, true) => format!("write `!` before the connector in {path}"),
    };
    if is_marked && !is_open {
        look.work.plug(path, &format!("!{plug}"), &format!("to be filled in; `!`: {}", names.join(", ")));
    }
    let kind = if is_marked && is_open { Kind::Approximated } else { Kind::Taken };
    names.into_iter().for_each(|name| look.say(name, kind, how.clone()));
}

/// The kind of a motor's driver.
fn drivers(look: &mut Look<'_, '_, '_>, motor: &str) {
    let name = format!("{motor}_DRIVER_TYPE");
    let Some(driver) = look.defines.find(&name).map(|define| define.value.clone()) else { return };
    if look.work.lines.get(&path_of(motor)).is_none() {
        return look.say(&name, Kind::NotYet, "no motor of its axis has it: it stays off");
    }
    match driver.as_str() {
        "TMC2209" => look.say(&name, Kind::Taken, "the driver there is"),
        _ => {
            let text = format!("{driver}: the motor needs a TMC2209, with a current of its own");
            look.say(&name, Kind::Approximated, text);
        }
    }
}
