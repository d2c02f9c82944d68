//! Motors, their drivers and belts.

use super::Command;
use super::grammar::{Grammar, NO_AXES, WORDS};
use super::pairs::flaw_of_pairs;
use super::row::Described;
use crate::gcode::axes::axis_flags;
use crate::gcode::index::{Absent, Named, Part};
use crate::gcode::lexer::{has, last, number, numbers, switch};
use crate::gcode::number::Number;
use crate::gcode::parts::{AxisFlags, Flaw, LevelWords};
use crate::motors::MotorName;

/// Motors, their drivers and belts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum MotorCommand {
    /// M17: power the motors of the named axes, all if none is named.
    EnableMotors(AxisFlags),
    /// M18, M84: unpower the motors of the named axes, all if none is named.
    DisableMotors(AxisFlags),
    /// M18 S, M84 S: seconds without motion after which motors lose power; 0 is never.
    IdleTimeout {
        /// The time in s.
        seconds: u32,
    },
    /// M569: stealthChop or spreadCycle for the named axes, all if none is named; or report.
    Stealth {
        /// S: whether it is stealthChop.
        on: Option<bool>,
        /// The axes.
        axes: AxisFlags,
    },
    /// M915: align the motors of one belt, or check them.
    AlignBelt {
        /// D: report changes since they were aligned.
        diagnoses: bool,
        /// R: the same, and set it right.
        repairs: bool,
    },
    /// G34: level the screws of z by the probe.
    LevelScrews(LevelWords),
    /// G35: how far each hand screw at the corners of the bed is to be turned.
    HandScrews {
        /// S: its thread: 30, 40, 50 for M3, M4, M5; one more for a thread that turns the other way.
        thread: Option<Number>,
    },
    /// STEPPER_BUZZ: one motor moves alone, a little to and fro.
    Buzz {
        /// STEPPER: the motor; the empty name if it is missing.
        motor: MotorName,
        /// FREE: a motor of its belt that has no power meanwhile.
        free: Option<MotorName>,
    },
}

/// Words that select a driver, where all drivers of an axis have one value.
const DRIVERS: &[(u8, Part)] = &[(b'I', Part::Driver), (b'T', Part::Extruder)];

pub(super) const ROWS: &[Described] = &[
    Described::m(&[17], |_, text| motor(MotorCommand::EnableMotors(axis_flags(text))))
        .grammar(&Grammar::numbers(b"").no_axes(NO_AXES).parts(&[(b'E', Part::Extruder)]))
        .does("X Y Z E", "power for the named axes, all without words"),
    Described::m(&[18, 84], |_, text| motor(release(text)))
        .grammar(&Grammar::numbers(b"S").no_axes(NO_AXES).not_negative(b"S").parts(&[(b'E', Part::Extruder)]))
        .does("X Y Z E, S", "power off; S sets the idle time in s, 0 is never"),
    // With P it is RepRapFirmware's, and turns a motor round.
    Described::m(&[569], |_, text| if has(text, b'P') { None } else { motor(stealth(text)) })
        .grammar(&Grammar::numbers(b"").parts(DRIVERS))
        .does("S X Y Z E", "stealthChop (1) or spreadCycle (0); or reports; with P unknown"),
    Described::m(&[915], |_, text| align(text))
        .grammar(WORDS)
        .does("D, R", "aligns the motors of a belt; D diagnoses, R repairs ([belt](../explanation/belt/alignment.md))"),
    Described::g(&[34], |_, text| motor(MotorCommand::LevelScrews(level(text))))
        .grammar(&Grammar::numbers(b"ITA"))
        .does(
            "I T A E",
            "levels the screws of z: rounds, accuracy in mm, share of a correction; E keeps the probe out",
        ),
    Described::g(&[35], |_, text| motor(MotorCommand::HandScrews { thread: number(text, b'S') }))
        .grammar(&Grammar::numbers(b"S"))
        .does(
            "S",
            "probes the corners of the bed, and says how far to turn each hand screw; thread: 30, 40, 50 is M3..",
        ),
    Described::name(&LEVEL_NAMES, |_, text| Some(level_by_name(text)))
        .does("RETRIES= RETRY_TOLERANCE=", "G34 in Klipper's words"),
    Described::name(&[BUZZ], |_, text| Some(buzz(text)))
        .does("STEPPER= FREE=", "one motor alone, 1 mm to and fro ([belt](../explanation/belt/one-motor.md))"),
];

/// Klipper's names for G34.
const LEVEL_NAMES: [&str; 2] = ["Z_TILT_ADJUST", "QUAD_GANTRY_LEVEL"];

/// Klipper's name for a motor that shows itself.
const BUZZ: &str = "STEPPER_BUZZ";

const fn motor(command: MotorCommand) -> Option<Command<'static>> {
    Some(Command::Motor(command))
}

/// G34.
fn level(text: &[u8]) -> LevelWords {
    let [rounds, within, share] = numbers(text, b"ITA");
    LevelWords { rounds, within, share, keeps_out: has(text, b'E') }
}

/// Klipper's words: RETRIES come after the first round. Its other words are for its own probes.
fn level_by_name(text: &[u8]) -> Command<'_> {
    const NAMES: [&str; 2] = ["RETRIES", "RETRY_TOLERANCE"];
    let mut level = LevelWords::default();
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        if pair.place >= NAMES.len() {
            return None;
        }
        let Some((number, _)) = Number::read(pair.value) else { return Some(pair.flaw()) };
        if pair.place == 0 {
            level.rounds = Some(Number::from(number.to_int().saturating_add(1)));
        } else {
            level.within = Some(number);
        }
        None
    });
    flaw.map_or(Command::Motor(MotorCommand::LevelScrews(level)), Command::Malformed)
}

/// M18 and M84: with S a time, otherwise axes.
fn release(text: &[u8]) -> MotorCommand {
    match number(text, b'S') {
        Some(seconds) => MotorCommand::IdleTimeout { seconds: seconds.to_u32() },
        None => MotorCommand::DisableMotors(axis_flags(text)),
    }
}

/// M569; a report is of all axes.
fn stealth(text: &[u8]) -> MotorCommand {
    let on = switch(text);
    MotorCommand::Stealth { on, axes: if on.is_some() { axis_flags(text) } else { AxisFlags::default() } }
}

/// STEPPER_BUZZ STEPPER=.. FREE=.., with the names of motors in the machine's file.
fn buzz(text: &[u8]) -> Command<'_> {
    let (mut motor, mut free) = (MotorName::NONE, None);
    let flaw = flaw_of_pairs(text, &["STEPPER", "FREE"], &mut |pair| {
        let Some(known) = core::str::from_utf8(pair.value).ok().and_then(MotorName::new) else {
            return Some(Flaw::Absent(Absent { command: Named::Name(BUZZ), part: Part::Motor, which: pair.value }));
        };
        match pair.place {
            0 => motor = known,
            1 => free = Some(known),
            _ => return Some(pair.flaw()),
        }
        None
    });
    flaw.map_or(Command::Motor(MotorCommand::Buzz { motor, free }), Command::Malformed)
}

/// M915. RepRapFirmware's is another command; it has these words in addition to its axes, and a number at its R.
fn align(text: &[u8]) -> Option<Command<'static>> {
    let is_foreign = b"PSFHT".iter().any(|letter| has(text, *letter));
    let [diagnoses, repairs] = [b'D', b'R'].map(|letter| last(text, letter));
    let has_number = [diagnoses, repairs].into_iter().flatten().any(|word| word.number.is_some());
    if is_foreign || has_number || diagnoses.is_some() && repairs.is_some() {
        return None;
    }
    motor(MotorCommand::AlignBelt { diagnoses: diagnoses.is_some(), repairs: repairs.is_some() })
}
