//! Marlin: a printer's reports (M503, M115, M211, M119, M122) as a machine file, with a verdict on every word.
//!
//! Nothing here opens a file or a port: it goes from text to text.
//!
//! | file | job |
//! |---|---|
//! | `said` | a text to words |
//! | `firmware` | which firmware answers |
//! | `work` | the translation so far |
//! | `motors`, `axes`, `heat` | one part of a machine each |
//! | `tables` | words that are one number, and remarks on the rest |
//! | `report` | the verdict on every word |
//! | `source` | other sources that become such words |
//!
//! A printer does not say how it is wired. Such keys get a value with which nothing breaks, and are to be filled in.

mod axes;
mod firmware;
mod heat;
mod motors;
mod report;
pub(crate) mod said;
pub(crate) mod source;
pub(crate) mod tables;
pub(crate) mod work;

use crate::translation::Kind::{Approximated, Decide, NotNeeded, Taken};
use crate::translation::Translation;
use corehbot::connectors::BoardConnectors;
use corehbot::settings::MachineName;
pub use firmware::Firmware;
pub use motors::Kinematics;
use said::Said;
use tables::NUMBERS;
use toml::Value as Toml;
use work::Work;

/// What a printer does not say.
#[derive(Clone, Copy, Default)]
pub struct Given {
    /// The board that the machine gets.
    pub board: Option<&'static BoardConnectors>,
    /// How its motors move it.
    pub kinematics: Option<&'static Kinematics>,
}

/// Commands of which a report has at least one, and a printed file has none or moves as well.
const OF_REPORTS: [&str; 5] = ["M92", "M203", "M201", "M204", "M205"];

/// Whether a text is the report of a printer: it sets what M503 reports, and neither moves nor has sections.
#[must_use]
pub fn is_report(text: &str) -> bool {
    let is_section = |line: &str| line.starts_with('[') && line.trim_end().ends_with(']');
    let said = Said::read(text);
    let has = |codes: &[&str]| said.words.iter().any(|word| codes.contains(&word.code.as_str()));
    !text.lines().any(is_section) && has(&OF_REPORTS) && !has(&["G0", "G1", "G28"])
}

/// Translates what a printer said; `name` is the file or the port.
#[must_use]
pub fn translate(name: &str, text: &str, given: Given) -> Translation {
    let said = Said::read(text);
    let mut work = Work::new(&said);
    parts(&mut work, given);
    let board = given.board.unwrap_or(&BoardConnectors::ANY);
    let mut head = format!("#:schema ./machine.schema.json\n# From {}", name.escape_debug());
    if let Some((_, firmware)) = work.value("M115", "FIRMWARE_NAME") {
        head += &format!(", {}", firmware.escape_debug());
    }
    head += ". `corehbot config check` checks it.\n# Marlin does not say the lines with `to be filled in`.\n";
    if given.board.is_none() {
        head += "# board = \"octopus\"  # to be filled in, with [motors] and [endstops]\n";
    }
    let text = head + &work.lines.text();
    Translation::new(text, report::report(&work, name, board))
}

/// All parts of a machine, from words of Marlin.
pub(crate) fn parts(work: &mut Work<'_>, given: Given) {
    machine(work, given.board);
    let motors = motors::motors(work, given);
    axes::axes(work, &motors);
    motors::drivers(work, &motors);
    heat::heat(work, given.board);
    motion(work);
    bed(work);
    numbers(work);
    axes::motor_limits(work);
}

/// The machine's name, and its board.
fn machine(work: &mut Work<'_>, board: Option<&'static BoardConnectors>) {
    match board {
        Some(board) => work.lines.set("board", board.key.into(), "--board"),
        None => work.open.push("board: the board that the machine gets; --board fills it in, with sockets".to_owned()),
    }
    if let Some((entry, name)) = work.value("M115", "MACHINE_TYPE") {
        let is_legal = |c: &char| c.is_ascii_alphanumeric() || *c == ' ' || MachineName::MARKS.contains(*c);
        let legal: String = name.chars().filter(is_legal).take(MachineName::LONGEST).collect();
        let legal = legal.trim();
        if legal == name {
            work.take(entry, "name", name);
        } else if !legal.is_empty() {
            work.approximate(entry, "name", legal.into(), ", because a name has 24 letters, digits and a few marks");
        }
    }
    work.of_firmware();
}

/// Corners, shapers, pressure advance and soft endstops.
fn motion(work: &mut Work<'_>) {
    corner(work);
    for axis in ["x", "y"] {
        let key = |leaf: &str| format!("shaper.{axis}.{leaf}");
        let word = |word: &str| format!("{} {word}", axis.to_ascii_uppercase());
        let Some((entry, frequency)) = work.number("M593", &word("F")) else { continue };
        // Marlin's are of one kind; only this firmware's M593 names others.
        let kind = work.number("M593", &word("T"));
        let name = kind.and_then(|(_, kind)| SHAPERS.get(kind as usize)).unwrap_or(&SHAPERS[0]);
        if frequency > 0.0 {
            work.take_number(entry, &key("frequency"), frequency);
            work.take(entry, &key("kind"), *name);
        } else {
            work.take(entry, &key("kind"), "none");
        }
        if let Some((entry, _)) = kind {
            work.say(entry, Taken, "the kind");
        }
    }
    if let Some((entry, k)) = work.number("M900", "K") {
        // Before version 1.5 K was a ratio, of some tens.
        if k <= 2.0 {
            work.take_number(entry, "advance.time", k);
        } else {
            work.say(entry, Decide, "more than 2 s is an old unit: measure K again");
        }
    }
    match work.number("M572", "W") {
        Some((entry, window)) if window > 0.0 => work.take_number(entry, "advance.window", window),
        Some((entry, _)) => work.take(entry, "advance.window", "auto"),
        None => {}
    }
    if let Some((entry, is_on)) = work.number("M211", "S") {
        work.take(entry, "soft_endstops", is_on != 0.0);
    }
}

/// Kinds of shapers by their numbers in M593 T.
const SHAPERS: [&str; 5] = ["zv", "zvd", "mzv", "ei", "2hump_ei"];

/// Marlin's jerk is a jump in the speed of each axis. In a right-angled corner from X to Y both axes jump by the whole
/// speed, so the lower one is the speed there.
fn corner(work: &mut Work<'_>) {
    let jerks = [work.length("M205", "X"), work.length("M205", "Y")];
    let has_deviation = work.value("M205", "J").is_some();
    let lowest = jerks.iter().flatten().map(|(_, jerk)| *jerk).fold(f64::INFINITY, f64::min);
    for (entry, jerk) in jerks.into_iter().flatten() {
        if has_deviation {
            work.say(entry, NotNeeded, "J is the rule for corners");
        } else if jerk <= lowest {
            work.take_number(entry, "corner.square_corner", jerk);
            work.say(entry, Approximated, "the speed through a right angle, the lower of X and Y");
        } else {
            work.say(entry, Approximated, "the lower of X and Y is the speed through a right angle");
        }
    }
}

/// Words that are one number.
fn numbers(work: &mut Work<'_>) {
    for row in NUMBERS {
        let read = if row.is_length { Work::length } else { Work::number };
        if let Some((entry, number)) = read(work, row.code, row.word) {
            work.take_number(entry, row.to, number);
        }
    }
    if let Some((entry, both)) = work.length("M204", "S") {
        for to in ["print_acceleration", "travel_acceleration"] {
            work.take_number(entry, to, both);
        }
    }
    if let Some((entry, seconds)) = work.number("M710", "D") {
        work.take_number(entry, "thermal.fan_run_on_s", seconds);
    }
    for axis in ["X", "Y", "Z"] {
        if let Some((entry, offset)) = work.length("M206", axis) {
            if offset == 0.0 {
                work.say(entry, NotNeeded, "no offset");
            } else {
                let key = format!("homing.{}.position", axis.to_ascii_lowercase());
                let text = format!("Marlin adds it to the place of the switch: add it to {key}");
                work.say(entry, Decide, text);
            }
        }
    }
}

/// The probe's offset, the mesh and the screws, which M503 says; it does not say which probe there is.
fn bed(work: &mut Work<'_>) {
    if let Some((entry, is_on)) = work.number("M420", "S") {
        work.take(entry, "mesh.is_on", is_on != 0.0);
    }
    let words: Vec<String> = work.said.words.iter().filter(|w| w.code == "M422").map(|w| w.key.clone()).collect();
    for key in words {
        let Some((letter, screw, axis)) = motors::screw(&key) else { continue };
        let Some((entry, at)) = work.length("M422", &key) else { continue };
        let axis = axis.to_ascii_lowercase();
        let path = format!("screws.{screw}.{}{axis}", if letter == 'S' { "point_" } else { "" });
        if work.is_key(&path) {
            work.take_number(entry, &path, at);
        }
    }
    if ["X", "Y", "Z"].iter().any(|axis| work.value("M851", axis).is_some()) {
        let keys = [("probe.kind".to_owned(), "none".into()), ("endstops.probe".to_owned(), "".into())];
        work.fill_in(&keys, "the probe: \"switch\", \"bltouch\" or \"nozzle\", and its input");
    }
}

/// A number as a value.
fn toml_of(number: f64) -> Toml {
    crate::value::float_toml(number)
}
