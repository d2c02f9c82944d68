//! Motors: the mechanism, the sockets and the drivers.

use super::Given;
use super::work::Work;
use crate::translation::{Kind, Verdict};
use corehbot::connectors::BoardConnectors;
use corehbot::motors::{MOTORS, MotorName};
use std::collections::BTreeSet;
use toml::Value as Toml;

/// How motors move a machine.
#[derive(PartialEq, Eq, Debug)]
pub struct Kinematics {
    /// Its name on command lines, and in M115 without case.
    pub name: &'static str,
    /// The rows of the motors of x, y and z.
    rows: [[i64; 3]; 3],
}

/// Marlin's kinematics that have a matrix, with the signs of its planner (`Planner::_populate_block`).
const KINEMATICS: [Kinematics; 9] = [
    Kinematics { name: "cartesian", rows: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] },
    Kinematics { name: "corexy", rows: [[1, 1, 0], [1, -1, 0], [0, 0, 1]] },
    Kinematics { name: "coreyx", rows: [[1, 1, 0], [-1, 1, 0], [0, 0, 1]] },
    Kinematics { name: "corexz", rows: [[1, 0, 1], [0, 1, 0], [1, 0, -1]] },
    Kinematics { name: "corezx", rows: [[1, 0, 1], [0, 1, 0], [-1, 0, 1]] },
    Kinematics { name: "coreyz", rows: [[1, 0, 0], [0, 1, 1], [0, 1, -1]] },
    Kinematics { name: "corezy", rows: [[1, 0, 0], [0, 1, 1], [0, -1, 1]] },
    Kinematics { name: "markforged_xy", rows: [[1, 1, 0], [0, 1, 0], [0, 0, 1]] },
    Kinematics { name: "markforged_yx", rows: [[1, 0, 0], [1, 1, 0], [0, 0, 1]] },
];

impl Kinematics {
    /// All of them.
    pub const ALL: &'static [Self] = &KINEMATICS;

    /// The one of that name.
    #[must_use]
    pub fn called(name: &str) -> Option<&'static Self> {
        let plain = |name: &str| name.to_ascii_lowercase().replace(['_', '-', ' '], "");
        Self::ALL.iter().find(|known| plain(known.name) == plain(name))
    }
}

/// A motor.
struct Motor {
    name: String,
    /// The word for it in M906 and the like: `X`, `I1 Z`, `E`.
    word: String,
    row: [i64; 4],
}

impl Motor {
    /// The group of driver settings that holds for it.
    const fn group(&self) -> &'static str {
        match self.row {
            [0, 0, 0, _] => "drivers.e",
            [0, 0, _, _] => "drivers.z",
            _ => "drivers.belt",
        }
    }
}

/// All motors.
pub(super) struct Motors {
    motors: Vec<Motor>,
    /// Whether one of them pushes filament.
    pub has_extruder: bool,
}

impl Motors {
    /// Whether one motor moves both axes.
    pub fn share(&self, one: usize, other: usize) -> bool {
        self.motors.iter().any(|motor| motor.row[one] != 0 && motor.row[other] != 0)
    }
}

const AXES: [char; 3] = ['X', 'Y', 'Z'];

/// Translates the mechanism and the sockets.
pub(super) fn motors(work: &mut Work<'_>, given: Given) -> Motors {
    let kinematics = kinematics(work, given.kinematics);
    let mut motors = Vec::new();
    for (letter, [x, y, z]) in AXES.into_iter().zip(kinematics.rows) {
        for part in 0..count(work, letter) {
            let (word, name) = match part {
                0 => (letter.to_string(), letter.to_ascii_lowercase().to_string()),
                _ => (format!("I{part} {letter}"), format!("{}{part}", letter.to_ascii_lowercase())),
            };
            motors.push(Motor { name, word, row: [x, y, z, 0] });
        }
    }
    let has_extruder = has_extruder(work);
    if has_extruder {
        motors.push(Motor { name: "e0".to_owned(), word: "E".to_owned(), row: [0, 0, 0, 1] });
    }
    if motors.len() > MOTORS {
        let text = format!("{} motors: the firmware drives {MOTORS}", motors.len());
        work.notes.push(Verdict::new(Kind::Decide, text));
    }
    for (name, motor) in work.names.iter_mut().zip(&motors) {
        *name = MotorName::new(&motor.name).unwrap_or(MotorName::NONE);
    }
    let names: Vec<Toml> = motors.iter().map(|motor| motor.name.as_str().into()).collect();
    work.lines.set("motors.names", Toml::Array(names), "");
    for motor in &motors {
        let used = if motor.row[3] == 0 { 3 } else { 4 };
        let row: Vec<Toml> = motor.row[..used].iter().map(|times| (*times).into()).collect();
        work.lines.set(&format!("mechanism.{}", motor.name), Toml::Array(row), "");
    }
    plugs(work, &motors, given.board);
    Motors { motors, has_extruder }
}

fn kinematics(work: &mut Work<'_>, given: Option<&'static Kinematics>) -> &'static Kinematics {
    let said = work.value("M115", "KINEMATICS");
    let found = said.and_then(|(_, name)| Kinematics::called(name));
    match (said, found, given) {
        (Some((entry, _)), Some(found), _) if given.is_none_or(|given| given == found) => {
            work.say(entry, Kind::Taken, "rows of [mechanism]");
            found
        }
        (Some((entry, _)), _, Some(given)) => {
            work.say(entry, Kind::Approximated, format!("--kinematics says {}", given.name));
            given
        }
        (None, _, Some(given)) => given,
        (said, _, None) => {
            let names: Vec<_> = Kinematics::ALL.iter().map(|known| known.name).collect();
            let text = format!(
                "the printer does not say how its motors move it, so [mechanism] is Cartesian: name yours by --kinematics ({})",
                names.join(", ")
            );
            match said {
                Some((entry, _)) => work.say(entry, Kind::Decide, text),
                None => work.notes.push(Verdict::new(Kind::Decide, text)),
            }
            &KINEMATICS[0]
        }
    }
}

/// Motors of an axis: drivers are listed one by one, and Z motors that are aligned are numbered.
fn count(work: &Work<'_>, letter: char) -> usize {
    let words = &work.said.words;
    let of_drivers = words.iter().filter(|word| ["M906", "M913", "M569", "M122", "M584"].contains(&word.code.as_str()));
    let parts = of_drivers.filter_map(|word| {
        let (part, of) = word.key.strip_prefix('I')?.split_once(' ')?;
        (of.starts_with(letter)).then(|| part.parse::<usize>().ok())?
    });
    let aligned = words.iter().filter(|word| letter == 'Z' && word.code == "M422");
    let aligned = aligned.filter_map(|word| screw(&word.key)).map(|(_, screw, _)| screw.saturating_sub(1));
    // One more than there may be is too many, and that is said.
    parts.chain(aligned).max().unwrap_or(0).min(MOTORS) + 1
}

/// The word of M422 for a screw: `S1 X` is the point that is probed for the first one, `W1 X` its own place.
pub(super) fn screw(key: &str) -> Option<(char, usize, &str)> {
    let (chosen, axis) = key.split_once(' ')?;
    let letter = chosen.chars().next().filter(|letter| "SW".contains(*letter))?;
    Some((letter, chosen.get(1..)?.parse().ok()?, axis))
}

fn has_extruder(work: &mut Work<'_>) -> bool {
    if let Some((entry, extruders)) = work.number("M115", "EXTRUDER_COUNT") {
        match extruders {
            1.0 => work.say(entry, Kind::Taken, "the motor e0"),
            0.0 => work.say(entry, Kind::Taken, "no motor for filament"),
            _ => work.say(entry, Kind::NotYet, "one extruder so far: the others stay off"),
        }
        return extruders > 0.0;
    }
    work.value("M92", "E").is_some()
}

/// Sockets and inputs, in the order in which boards print them.
fn plugs(work: &mut Work<'_>, motors: &[Motor], board: Option<&'static BoardConnectors>) {
    let board = board.unwrap_or(&BoardConnectors::ANY);
    let mut sockets: Vec<&str> = board.sockets.iter().map(|name| name.as_str()).collect();
    sockets.sort_by_key(|name| (name.len(), *name));
    let mut keys = Vec::new();
    for motor in motors {
        // X-MOT, or the next one.
        let own = format!("{}-", motor.name.to_ascii_uppercase());
        let place = sockets.iter().position(|name| name.starts_with(&own)).unwrap_or_default();
        let socket = if sockets.is_empty() { "" } else { sockets.remove(place) };
        keys.push((format!("motors.{}", motor.name), socket.into()));
    }
    work.fill_in(&keys, "the sockets of the motors; `!` before one turns the motor the other way");
    let inputs = ["x", "y", "z"].into_iter().zip(board.inputs.iter().map(|name| name.as_str()).chain([""; 3]));
    let keys: Vec<_> = inputs.map(|(axis, input)| (format!("endstops.{axis}"), input.into())).collect();
    work.fill_in(&keys, "the inputs of the switches; `!` before one is for a switch that closes when it is pressed");
}

/// Half of what small motors bear.
const LOW_MA: i64 = 500;

/// Translates the drivers' settings.
pub(super) fn drivers(work: &mut Work<'_>, motors: &Motors) {
    for motor in &motors.motors {
        for (code, leaf) in [("M906", "current_ma"), ("M913", "hybrid_threshold")] {
            if let Some((entry, number)) = work.number(code, &motor.word) {
                group(work, entry, motor, leaf, number);
            }
        }
        microsteps(work, motor);
        if let Some((entry, is_on)) = work.number("M569", &motor.word) {
            let path = format!("{}.stealth", motor.group());
            let is_on = is_on != 0.0;
            match work.lines.get(&path).and_then(Toml::as_bool) {
                Some(first) if first != is_on => other(work, entry, &path, &first.to_string()),
                Some(_) => work.say(entry, Kind::Taken, path),
                None => work.take(entry, &path, is_on),
            }
        }
    }
    silent_mode(work, motors);
    let groups: BTreeSet<_> = motors.motors.iter().map(Motor::group).collect();
    let keys = |leaf: &str, number: i64| -> Vec<(String, Toml)> {
        groups.iter().map(|group| (format!("{group}.{leaf}"), number.into())).collect()
    };
    for (keys, what) in [
        (keys("current_ma", LOW_MA), "half of the motor's rated current at first, in mA"),
        (keys("microsteps", 16), "as on the old board: another number changes the steps of a mm"),
    ] {
        let open: Vec<_> = keys.into_iter().filter(|(path, _)| work.lines.get(path).is_none()).collect();
        if !open.is_empty() {
            work.fill_in(&open, what);
        }
    }
}

/// Of two motors of the belt one may say that it is in stealthChop, and the other one nothing: the group's mode would
/// count for both. A second motor of an axis has a word only where it differs, so it does not count here.
fn silent_mode(work: &mut Work<'_>, motors: &Motors) {
    let path = "drivers.belt.stealth";
    if work.lines.get(path).and_then(Toml::as_bool) != Some(true) {
        return;
    }
    let first = motors.motors.iter().filter(|motor| motor.group() == "drivers.belt" && !motor.word.contains(' '));
    let silent = first.filter(|motor| work.value("M569", &motor.word).is_none());
    for name in silent.map(|motor| motor.name.clone()).collect::<Vec<_>>() {
        let text = format!("the mode of {name} is not said, but {path} = true holds for its group");
        work.notes.push(Verdict::new(Kind::Decide, text));
    }
}

/// Microsteps belong to the steps of a mm, so all motors of a group need the same.
fn microsteps(work: &mut Work<'_>, motor: &Motor) {
    let Some((entry, number)) = work.number("M122", &motor.word) else { return };
    let path = format!("{}.microsteps", motor.group());
    let is_legal = (0..=8).any(|power| number == f64::from(1 << power));
    match work.lines.number(&path) {
        _ if !is_legal => work.say(entry, Kind::Decide, format!("no such microsteps: write {path}")),
        Some(first) if first == number => work.say(entry, Kind::Taken, path),
        Some(first) => {
            work.say(entry, Kind::Decide, format!("{path} holds for several motors, and another one has {first}"));
            work.leave_open(&path);
        }
        None => work.take_number(entry, &path, number),
    }
}

/// Takes a number for the drivers of a motor's group, or for the motor alone if another one has set the group's.
fn group(work: &mut Work<'_>, entry: usize, motor: &Motor, leaf: &str, number: f64) {
    let path = format!("{}.{leaf}", motor.group());
    let own = format!("drivers.{}.{leaf}", motor.name);
    match work.lines.number(&path) {
        Some(_) if work.is_same(&path, number) => work.say(entry, Kind::Taken, path),
        Some(_) if work.is_key(&own) => work.take_number(entry, &own, number),
        Some(first) => other(work, entry, &path, &first.to_string()),
        None => work.take_number(entry, &path, number),
    }
}

/// Another motor has set the value of a group.
fn other(work: &mut Work<'_>, entry: usize, path: &str, first: &str) {
    let text = format!("{path} = {first} holds for all of these motors, and another one set it");
    work.say(entry, Kind::Approximated, text);
}
