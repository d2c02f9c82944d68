//! Commands as words of Marlin, in its units.

use super::lines::{Command, Word};
use crate::marlin::source::Source;
use std::collections::BTreeMap;

const AXES: [char; 4] = ['X', 'Y', 'Z', 'E'];

/// A minute in s.
const MINUTE: f64 = 60.0;

/// Commands with a number for each axis, Marlin's name for them, and the number that they are divided by.
const AXIS_NUMBERS: [(&str, &str, f64); 4] =
    [("M203", "M203", MINUTE), ("M201", "M201", 1.0), ("M566", "M205", MINUTE), ("M906", "M906", PEAK)];

/// The peak of a sine, for its root mean square of 1: M906 is the peak current (RepRapFirmware, M906).
const PEAK: f64 = core::f64::consts::SQRT_2;

/// Single words that have the same meaning.
const SAME: [(&str, char, &str, &str); 9] = [
    ("M204", 'P', "M204", "P"),
    ("M204", 'T', "M204", "T"),
    ("M302", 'S', "M302", "S"),
    ("M572", 'S', "M900", "K"),
    ("M550", 'P', "M115", "MACHINE_TYPE"),
    ("M376", 'H', "M420", "Z"),
    ("G31", 'X', "M851", "X"),
    ("G31", 'Y', "M851", "Y"),
    ("M593", 'S', "M593", "X D"),
];

/// Kinematics by their numbers in M669 K (RepRapFirmware, M669).
const KINEMATICS: [(i64, &str); 3] = [(0, "Cartesian"), (1, "CoreXY"), (2, "CoreXZ")];

/// Microsteps without an M350 (RepRapFirmware, M350).
const MICROSTEPS: f64 = 16.0;

/// All words.
pub(super) fn words(commands: &[Command], source: &mut Source) {
    let mut has_kinematics = false;
    steps(commands, source);
    for command in commands {
        let code = command.code.as_str();
        if let Some((_, other, by)) = AXIS_NUMBERS.iter().find(|(known, ..)| *known == code) {
            for axis in AXES {
                if let Some((word, number)) = command.word(axis).and_then(|word| Some((word, word.number()?))) {
                    source.number(word.item, other, &axis.to_string(), number / by);
                }
            }
        }
        for (_, letter, other, key) in SAME.iter().filter(|(known, ..)| *known == code) {
            if let Some(word) = command.word(*letter) {
                let first = word.value.split(':').next().unwrap_or_default();
                source.word(word.item, other, key, first);
                if let ("M593", Some(axis_key)) = (*other, key.strip_prefix("X ")) {
                    source.word(word.item, other, &format!("Y {axis_key}"), first);
                }
            }
        }
        match code {
            "M208" => ends(command, source),
            "M584" => motors(command, source),
            // The nozzle's height at the touch; an offset has the other sign.
            "G31" => {
                if let Some((word, height)) = command.word('Z').and_then(|word| Some((word, word.number()?))) {
                    source.number(word.item, "M851", "Z", -height);
                }
            }
            "M669" => has_kinematics |= kinematics(command, source),
            "M667" => {
                if let Some((word, is_core)) = command.word('S').and_then(|word| Some((word, word.number()?))) {
                    let name = if is_core == 0.0 { "Cartesian" } else { "CoreXY" };
                    source.word(word.item, "M115", "KINEMATICS", name);
                    has_kinematics = true;
                }
            }
            "M569" => modes(command, commands, source),
            _ => {}
        }
    }
    if !has_kinematics && !source.items.is_empty() {
        // Without M669 the machine is Cartesian (RepRapFirmware, M669).
        source.word(0, "M115", "KINEMATICS", "Cartesian");
    }
}

/// Steps and microsteps. Another M350 behind M92 changes the steps of a mm with it.
fn steps(commands: &[Command], source: &mut Source) {
    let mut micro: BTreeMap<char, f64> = AXES.map(|axis| (axis, MICROSTEPS)).into();
    let mut said: Vec<(Word, char, f64, f64)> = Vec::new();
    for command in commands {
        for axis in AXES {
            let Some((word, number)) = command.word(axis).and_then(|word| Some((word, word.number()?))) else {
                continue;
            };
            match command.code.as_str() {
                "M350" => {
                    micro.insert(axis, number);
                    source.number(word.item, "M122", &axis.to_string(), number);
                }
                "M92" => said.push((word.clone(), axis, number, micro.get(&axis).copied().unwrap_or(MICROSTEPS))),
                _ => {}
            }
        }
    }
    for (word, axis, number, before) in said {
        let now = micro.get(&axis).copied().unwrap_or(MICROSTEPS);
        source.number(word.item, "M92", &axis.to_string(), if before > 0.0 { number * now / before } else { number });
    }
}

/// Ends of axes: `X0:230`, or `X0 S1` and `X230 S0`.
fn ends(command: &Command, source: &mut Source) {
    let is_least = command.number('S') == Some(1.0);
    for axis in ['X', 'Y', 'Z'] {
        let Some(word) = command.word(axis) else { continue };
        match word.numbers()[..] {
            [least, most] => {
                source.number(word.item, "M211", &format!("Min {axis}"), least);
                source.number(word.item, "M211", &format!("Max {axis}"), most);
            }
            [only] => {
                source.number(word.item, "M211", &format!("{} {axis}", if is_least { "Min" } else { "Max" }), only)
            }
            _ => {}
        }
    }
}

/// The drivers of an axis: the second one is a motor of its own.
fn motors(command: &Command, source: &mut Source) {
    for axis in AXES {
        let Some(word) = command.word(axis) else { continue };
        let drivers = word.value.split(':').count();
        if axis == 'E' {
            source.number(word.item, "M115", "EXTRUDER_COUNT", drivers as f64);
            continue;
        }
        for part in 1..drivers {
            source.word(word.item, "M584", &format!("I{part} {axis}"), "");
        }
    }
}

fn kinematics(command: &Command, source: &mut Source) -> bool {
    let Some((word, number)) = command.word('K').and_then(|word| Some((word, word.number()?))) else { return false };
    let known = KINEMATICS.iter().find(|(known, _)| *known as f64 == number);
    let name = known.map_or_else(|| format!("K{number}"), |(_, name)| (*name).to_owned());
    source.word(word.item, "M115", "KINEMATICS", &name);
    true
}

/// The motor that has a driver: its axis, and its number on that axis.
pub(super) fn motor_of(driver: &str, commands: &[Command]) -> Option<(char, usize)> {
    let maps: Vec<&Command> = commands.iter().filter(|command| command.code == "M584").collect();
    if maps.is_empty() {
        // Without a map the first four drivers are x, y, z and e (RepRapFirmware, M584).
        let number = driver.trim_start_matches("0.").parse::<usize>().ok()?;
        return AXES.get(number).map(|axis| (*axis, 0));
    }
    // `0.3` is driver 3 of the main board.
    let plain = |name: &str| name.trim().trim_start_matches("0.").to_owned();
    let of = |command: &&&Command, axis: char| {
        let word = command.word(axis)?;
        word.value.split(':').position(|name| plain(name) == plain(driver)).map(|part| (axis, part))
    };
    AXES.iter().find_map(|axis| maps.iter().find_map(|command| of(&command, *axis)))
}

/// stealthChop of a driver: D3 is it, D2 is spreadCycle (RepRapFirmware, M569).
fn modes(command: &Command, commands: &[Command], source: &mut Source) {
    let driver = command.word('P').map(|word| word.value.clone()).unwrap_or_default();
    let Some((axis, part)) = motor_of(&driver, commands) else { return };
    let motor = if part == 0 { axis.to_string() } else { format!("I{part} {axis}") };
    if let Some((word, mode)) = command.word('D').and_then(|word| Some((word, word.number()?))) {
        source.word(word.item, "M569", &motor, if mode == 3.0 { "1" } else { "0" });
    }
}
