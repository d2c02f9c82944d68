//! Parts without a word of Marlin: directions, switches, sensors, heaters, the probe.

use super::lines::{Command, Word};
use super::tables::is_read;
use super::words::motor_of;
use crate::marlin::source::ITEM;
use crate::marlin::work::Work;
use crate::thermistor::written;
use crate::translation::Kind;
use crate::translation::draft::rounded;
use corehbot::settings::Thermistor;
use std::collections::BTreeMap;
use toml::Value as Toml;

/// The commands, and which heater is which.
pub(super) struct Parts<'c> {
    commands: &'c [Command],
    /// Heaters of ours by their numbers.
    heaters: BTreeMap<i64, &'static str>,
    /// The heaters of sensors.
    sensors: BTreeMap<String, &'static str>,
}

/// The usual heaters: the bed is 0, the first tool's 1 (RepRapFirmware, M140, M563).
const HEATERS: [(i64, &str); 2] = [(0, "bed"), (1, "hotend")];

impl<'c> Parts<'c> {
    pub fn of(commands: &'c [Command]) -> Self {
        let all = |code: &'static str| commands.iter().filter(move |command| command.code == code);
        let mut heaters: BTreeMap<i64, &'static str> = HEATERS.into();
        for (code, heater) in [("M140", "bed"), ("M141", "chamber"), ("M563", "hotend")] {
            let first = all(code).find_map(|command| command.number('H'));
            if let Some(number) = first.filter(|number| *number >= 0.0) {
                heaters.retain(|_, known| *known != heater);
                heaters.insert(number as i64, heater);
            }
        }
        let mut sensors = BTreeMap::new();
        for command in all("M950") {
            let heater = command.number('H').and_then(|number| heaters.get(&(number as i64)));
            if let (Some(heater), Some(sensor)) = (heater, command.word('T')) {
                sensors.insert(sensor.value.clone(), *heater);
            }
        }
        if sensors.is_empty() {
            sensors.extend(heaters.iter().map(|(number, heater)| (number.to_string(), *heater)));
        }
        Self { commands, heaters, sensors }
    }

    /// What stands before the words of Marlin, which only fill in what is left.
    pub fn before(&self, work: &mut Work<'_>) {
        for (at, command) in self.commands.iter().enumerate() {
            if self.is_replaced(work, at, command) {
                continue;
            }
            // RepRapFirmware does not see an E behind a digit as a word (`StringParser::Seen`).
            for word in command.words.iter().filter(|word| is_endless(&word.value)) {
                say(work, word, Kind::Decide, "an exponent, to the firmware too: put a blank before E");
            }
            unread(work, command);
            match command.code.as_str() {
                "M308" | "M305" => self.sensor(work, command),
                "M143" => self.of_heater(work, command, 'S', "most"),
                "M307" => {
                    self.of_heater(work, command, 'S', "max_duty");
                    for word in command.words.iter().filter(|word| !['H', 'S'].contains(&word.letter)) {
                        say(work, word, Kind::Approximated, "its model has other numbers here: M303 finds them");
                    }
                }
                "M574" => switches(work, command),
                "M558" => probe(work, command),
                "M350" => {
                    if let Some(word) = command.word('I') {
                        let is_on = word.number().is_none_or(|number| number != 0.0);
                        for group in ["drivers.belt", "drivers.z", "drivers.e"] {
                            take(work, word, &format!("{group}.interpolate"), is_on.into());
                        }
                    }
                }
                "M906" => idle(work, command),
                "M106" => fan(work, command),
                "M593" => shaper(work, command),
                "M84" => {
                    if let Some(word) = command.word('S') {
                        say(work, word, Kind::NotNeeded, "motors hold until M84; heaters have thermal.idle_min");
                    }
                }
                _ => {}
            }
        }
        // Every move wants a homed axis unless M564 H0 says otherwise (RepRapFirmware, M564).
        let is_free = self.commands.iter().find(|command| command.code == "M564").and_then(|command| command.word('H'));
        match is_free {
            Some(word) => take(work, word, "require_homing", (word.number() != Some(0.0)).into()),
            None => work.lines.set("require_homing", true.into(), "RepRapFirmware's default"),
        }
        if let Some(word) = self.commands.iter().find(|c| c.code == "M564").and_then(|command| command.word('S')) {
            take(work, word, "soft_endstops", (word.number() != Some(0.0)).into());
        }
    }

    /// Whether a later command says all of an earlier one again; what it says less is still there.
    fn is_replaced(&self, work: &mut Work<'_>, at: usize, command: &Command) -> bool {
        const ONCE: [&str; 3] = ["M558", "M574", "M143"];
        let later = self.commands.iter().skip(at + 1).find(|later| {
            later.code == command.code
                && later.chosen == command.chosen
                && command.words.iter().all(|word| later.has(word.letter))
        });
        let Some(later) = later.filter(|_| ONCE.contains(&command.code.as_str())) else { return false };
        for word in &command.words {
            say(work, word, Kind::NotNeeded, &format!("line {} replaces it", later.line));
        }
        true
    }

    /// A number of a heater.
    fn of_heater(&self, work: &mut Work<'_>, command: &Command, letter: char, leaf: &str) {
        // Only the first monitor of a heater is its limit.
        let Some(word) = command.word(letter) else { return };
        let heater = command.number('H').and_then(|number| self.heaters.get(&(number as i64)));
        match (heater, word.number()) {
            (Some(heater), Some(number)) => take_number(work, word, &format!("heaters.{heater}.{leaf}"), number),
            _ => say(work, word, Kind::NotYet, "another heater than hotend, bed and chamber"),
        }
    }

    /// A sensor: RepRapFirmware's thermistor has the equation of ours, with its C in 1/K (`Thermistor.cpp`).
    fn sensor(&self, work: &mut Work<'_>, command: &Command) {
        let number = command.word('S').or_else(|| command.word('P')).map(|word| word.value.as_str());
        let Some(heater) = number.and_then(|number| self.sensors.get(number)) else {
            for word in &command.words {
                say(work, word, Kind::NotYet, "the sensor of no heater here");
            }
            return;
        };
        let path = format!("heaters.{heater}.thermistor");
        let kind = command.word('Y');
        if let Some(word) = kind.filter(|word| word.value.eq_ignore_ascii_case("pt1000")) {
            return take(work, word, &path, "pt1000".into());
        }
        if let Some(word) = kind.filter(|word| !word.value.eq_ignore_ascii_case("thermistor")) {
            let text = if crate::amplified::is_behind_a_chip(&word.value) {
                crate::amplified::advice(&path)
            } else {
                format!("{} is not there yet: write a sensor near it into {path}", word.value)
            };
            return say(work, word, Kind::Decide, &text);
        }
        let Some(ohms) = command.word('T') else { return };
        let of = |letter: char, usual: f64| command.number(letter).unwrap_or(usual);
        // 100 kOhm and a B of 4725 with C 7.06e-8 are the usual ones (RepRapFirmware, M308).
        let (at_25, beta) = (of('T', 100_000.0), of('B', 4725.0));
        let usual = if command.has('B') { 0.0 } else { 7.06e-8 };
        let cubic = (of('C', usual) * 1e9).round();
        let is_legal = (1000.0..=2e6).contains(&at_25)
            && (2000.0..=6000.0).contains(&beta)
            && (0.0..=f64::from(Thermistor::MOST_CUBIC)).contains(&cubic);
        if !is_legal {
            return say(work, ohms, Kind::Decide, &format!("no NTC of ours: write a sensor near it into {path}"));
        }
        let at_25 = if cubic > 0.0 { (at_25 / 8.0).round() * 8.0 } else { at_25.round() };
        take(work, ohms, &path, written(at_25 as u32, beta.round() as u16, cubic as u16));
        for letter in ['B', 'C'] {
            if let Some(word) = command.word(letter) {
                say(work, word, Kind::Taken, &format!("{path} has it"));
            }
        }
        if let Some(word) = command.word('R') {
            say(work, word, Kind::NotNeeded, "the resistor of that board; the boards here have 4.7 kOhm");
        }
    }

    /// Directions, which need the names of motors.
    pub fn after(&self, work: &mut Work<'_>) {
        for command in self.commands.iter().filter(|command| command.code == "M569") {
            let driver = command.word('P').map(|word| word.value.clone()).unwrap_or_default();
            let Some(word) = command.word('S') else { continue };
            let Some((axis, part)) = motor_of(&driver, self.commands) else {
                say(work, word, Kind::NotYet, "the driver of no motor here");
                continue;
            };
            let name = match (axis, part) {
                ('E', 0) => "e0".to_owned(),
                ('E', _) => {
                    say(work, word, Kind::NotYet, "one extruder so far");
                    continue;
                }
                (axis, 0) => axis.to_ascii_lowercase().to_string(),
                (axis, part) => format!("{}{part}", axis.to_ascii_lowercase()),
            };
            mark(work, word, &format!("motors.{name}"), word.number() == Some(0.0));
        }
        let of_version_2 = !self.commands.iter().any(|command| command.code == "M574" && command.has('P'));
        for (at, command) in self.commands.iter().enumerate().filter(|(_, command)| command.code == "M574") {
            if self.is_replaced(work, at, command) {
                continue;
            }
            if let Some(pin) = command.word('P') {
                for axis in ['X', 'Y', 'Z'].into_iter().filter(|axis| command.has(*axis)) {
                    let path = format!("endstops.{}", axis.to_ascii_lowercase());
                    mark(work, pin, &path, pin.value.contains('!'));
                }
            } else if let Some((word, kind)) = command.word('S').and_then(|word| Some((word, word.number()?)))
                && of_version_2
                && [0.0, 1.0].contains(&kind)
            {
                // Active low: a switch that closes (RepRapFirmware 2, M574).
                for axis in ['X', 'Y', 'Z'].into_iter().filter(|axis| command.has(*axis)) {
                    mark(work, word, &format!("endstops.{}", axis.to_ascii_lowercase()), kind == 0.0);
                }
            }
        }
    }
}

/// Whether a number is greater than all others by its exponent.
fn is_endless(value: &str) -> bool {
    value.split(':').any(|part| part.parse::<f64>().is_ok_and(f64::is_infinite) && part.contains(['e', 'E']))
}

/// Words that nothing here evaluates: expressions, conditions, and brackets that are no comment for a printer.
fn unread(work: &mut Work<'_>, command: &Command) {
    let is_read = is_read(&command.code);
    for word in &command.words {
        if word.letter == '(' {
            say(work, word, Kind::Decide, "brackets are a comment of a mill (M453): write ; before it");
        } else if is_read && word.value.contains('{') {
            say(work, word, Kind::Decide, "an expression: write its value yourself");
        } else if is_read && command.is_nested {
            say(work, word, Kind::Decide, "under a condition, so it may not count");
        }
    }
}

/// The entry of a word.
fn entry(work: &Work<'_>, word: &Word) -> Option<usize> {
    work.said.words.iter().position(|known| known.code == ITEM && known.line == word.item)
}

fn say(work: &mut Work<'_>, word: &Word, kind: Kind, text: &str) {
    if let Some(entry) = entry(work, word) {
        work.say(entry, kind, text);
    }
}

fn take(work: &mut Work<'_>, word: &Word, path: &str, value: Toml) {
    if let Some(entry) = entry(work, word) {
        work.take(entry, path, value);
    }
}

fn take_number(work: &mut Work<'_>, word: &Word, path: &str, number: f64) {
    if let Some(entry) = entry(work, word) {
        work.take_number(entry, path, rounded(number));
    }
}

/// `!` in front of a connector, or told where the place for it is empty.
fn mark(work: &mut Work<'_>, word: &Word, path: &str, is_marked: bool) {
    let plug = work.lines.get(path).and_then(Toml::as_str).unwrap_or_default().to_owned();
    let plug = plug.trim_start_matches('!');
    match (is_marked, plug.is_empty()) {
        (false, is_empty) => {
            if !is_empty {
                work.plug(path, plug, "to be filled in");
            }
            say(work, word, Kind::Taken, &format!("{path} is without `!`"));
        }
        (true, true) => say(work, word, Kind::Approximated, &format!("write `!` before the connector in {path}")),
        (true, false) => {
            work.plug(path, &format!("!{plug}"), "to be filled in; `!`: it is reversed");
            say(work, word, Kind::Taken, &format!("{path} has `!`"));
        }
    }
}

/// Ends and kinds of switches: X1 is the low end, X2 the high one; S1 is a switch, S2 the probe, S3 and S4 a stall.
fn switches(work: &mut Work<'_>, command: &Command) {
    let kind = command.number('S').unwrap_or(1.0);
    for axis in ['X', 'Y', 'Z'] {
        let Some(word) = command.word(axis) else { continue };
        let (name, end) = (axis.to_ascii_lowercase(), word.number());
        match end {
            Some(1.0) => take(work, word, &format!("homing.{name}.end"), "min".into()),
            Some(2.0) => take(work, word, &format!("homing.{name}.end"), "max".into()),
            _ => say(work, word, Kind::Decide, "no switch: each axis needs one"),
        }
        let Some(kind_word) = command.word('S') else { continue };
        match kind {
            2.0 if axis == 'Z' => take(work, kind_word, "probe.z_home", true.into()),
            1.0 => say(work, kind_word, Kind::Taken, "a switch"),
            // Of version 3 on a `!` before the pin says it, and S0 is refused (RepRapFirmware, M574).
            0.0 if command.has('P') => {
                let text = format!("no version knows S0 and P together: write `!` into endstops.{name} if it closes");
                say(work, kind_word, Kind::Decide, &text);
            }
            0.0 => {} // `after` marks it.
            _ => say(work, kind_word, Kind::Decide, "homing by a stall is not there yet: plug in a switch"),
        }
    }
}

/// Kinds of probes by M558 P (RepRapFirmware, M558).
fn probe(work: &mut Work<'_>, command: &Command) {
    if let Some(word) = command.word('P') {
        match word.number() {
            Some(0.0) => take(work, word, "probe.kind", "none".into()),
            Some(5.0 | 8.0) => take(work, word, "probe.kind", "switch".into()),
            Some(9.0) => take(work, word, "probe.kind", "bltouch".into()),
            _ => say(work, word, Kind::Decide, "no such probe yet: there are a switch (P5, P8) and a BLTouch (P9)"),
        }
        work.fill_in(&[("endstops.probe".to_owned(), "".into())], "the input of the probe");
    }
    if let Some(word) = command.word('C') {
        let how = if word.value.contains('!') { " behind `!`" } else { "" };
        say(work, word, Kind::Approximated, &format!("a pin of that board: write its input into endstops.probe{how}"));
    }
    if let Some(word) = command.word('F') {
        match word.numbers()[..] {
            [fast, slow, ..] => {
                take_number(work, word, "probe.fast", fast / 60.0);
                take_number(work, word, "probe.slow", slow / 60.0);
            }
            [only] => {
                take_number(work, word, "probe.fast", only / 60.0);
                take_number(work, word, "probe.slow", only / 60.0);
            }
            [] => {}
        }
    }
    for (letter, path, times) in [
        ('H', "probe.clearance", 1.0),
        ('T', "probe.travel", 1.0 / 60.0),
        ('S', "probe.tolerance", 1.0),
        ('R', "probe.quiet", 1.0),
    ] {
        if let Some((word, number)) = command.word(letter).and_then(|word| Some((word, word.number()?))) {
            take_number(work, word, path, number * times);
        }
    }
    if let Some((word, most)) = command.word('A').and_then(|word| Some((word, word.number()?))) {
        take_number(work, word, "probe.samples", most.min(2.0));
        say(
            work,
            word,
            Kind::Approximated,
            "two touches that agree are its rule: probe.samples and probe.retries are ours",
        );
    }
}

/// The current at rest, in percent of the running one.
fn idle(work: &mut Work<'_>, command: &Command) {
    let Some((word, percent)) = command.word('I').and_then(|word| Some((word, word.number()?))) else { return };
    for group in ["drivers.belt", "drivers.z", "drivers.e"] {
        take_number(work, word, &format!("{group}.hold_percent"), percent);
    }
}

/// A fan that follows a heater: only the temperature has a place without its output.
fn fan(work: &mut Work<'_>, command: &Command) {
    if let Some((word, above)) = command.word('T').and_then(|word| Some((word, word.number()?))) {
        take_number(work, word, "thermal.hotend_fan_above", above);
        say(work, word, Kind::Approximated, "give its output the role hotend");
    }
}

/// The kind of shaper by its name, and its frequency.
fn shaper(work: &mut Work<'_>, command: &Command) {
    if let Some((word, frequency)) = command.word('F').and_then(|word| Some((word, word.number()?))) {
        for axis in ["x", "y"] {
            if frequency > 0.0 {
                take_number(work, word, &format!("shaper.{axis}.frequency"), frequency);
            } else {
                take(work, word, &format!("shaper.{axis}.kind"), "none".into());
            }
            if frequency > 0.0 && !command.has('P') && work.lines.get(&format!("shaper.{axis}.kind")).is_none() {
                work.lines.set(&format!("shaper.{axis}.kind"), "zvd".into(), "RepRapFirmware's default");
            }
        }
    }
    let Some(word) = command.word('P') else { return };
    let kind = match word.value.as_str() {
        "none" => "none",
        "zvd" | "zvdd" => "zvd",
        "mzv" => "mzv",
        "ei2" | "ei3" => "2hump_ei",
        _ => return say(work, word, Kind::Decide, "no such shaper: choose one of M593"),
    };
    for axis in ["x", "y"] {
        let path = format!("shaper.{axis}.kind");
        if ["zvdd", "ei3"].contains(&word.value.as_str()) {
            if let Some(entry) = entry(work, word) {
                work.approximate(entry, &path, kind.into(), ", the nearest there is");
            }
        } else {
            take(work, word, &path, kind.into());
        }
    }
}
