//! Machine files: settings as TOML that a person writes; read, checked, written and described.
//!
//! For commands, other tools and web pages: but for [`read`], which opens a file, everything goes from text to values and back.
//!
//! Every key is optional and stands over the prototype's value, but for `[mechanism]`, which lists all motors or is left
//! out. An unknown key or a value outside its legal range is an error that names both. `form` has the keys, `quantity` the
//! ranges, `schema` both for editors, `problems` all that is wrong with a file; `examples/machines/prototype.toml` shows every key. A file that names a `board` is held to what that has.

#![forbid(unsafe_code)]

mod error;
mod form;
mod heat;
mod homing;
mod place;
mod plugs;
mod problems;
mod quantity;
mod resolution;
mod schema;
pub mod short;
pub mod template;
mod unwise;
mod written;

use anyhow::{Context as _, anyhow};
use corehbot::connectors::{BoardConnectors, SIM};
use corehbot::kinematics::{MOST_MULTIPLE, Mechanism, Row, direction, multiple};
use corehbot::motors::Motor;
use corehbot::settings::{
    AxisSettings, Bed, Belt, CornerRule, DriverSettings, MachineName, PHASES, Pause, Range, Settings, Shaper,
    ShaperKind, Wiring, ranges,
};
pub use error::MachineFileError;
use form::{
    AxisToml, BedToml, BeltToml, CornerToml, DriverToml, MachineToml, MechanismToml, PauseToml, RowToml, ShaperToml,
    WindowToml,
};
pub use place::{Place, with_suggestion, words};
pub use problems::{Problem, problems};
use quantity::{
    ACCELERATION, ADVANCE, ADVANCE_WINDOW, AXIS_LENGTH, BAUD, BED_EDGE, BELT_SPAN, CRUISE_RATIO, DAMPING, FREQUENCY,
    HOMING_ADVANCE, KEEPALIVE, LEAST_SPEED, LIMP_LIFT, LOOKAHEAD_TIME, MOTOR_FREQUENCY, PATIENCE, PAUSE_LIFT,
    PAUSE_RETRACT, PHASE, PRELOAD, SETTLING, SPEED, TOLERANCE, put, put_whole, quantity,
};
use resolution::resolution;
pub use schema::schema;
use std::path::Path;
pub use written::written;

/// A machine as its file describes it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Machine {
    /// What the file calls it.
    pub name: Option<String>,
    /// The board that it says it has; every connector of the settings is on it.
    pub board: Option<&'static BoardConnectors>,
    /// Its settings, all in range.
    pub settings: Settings,
}

/// The machine of the file at `path`, which is its name unless it says another.
///
/// # Errors
/// What is wrong, with the file's name, line and column in front.
pub fn read(path: &Path) -> anyhow::Result<Machine> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot open {}", path.display()))?;
    let mut machine = parse(&text).map_err(|error| match error.place(&text) {
        Some(place) => anyhow!("{}:{place}: {error}", path.display()),
        None => anyhow!("{}: {error}", path.display()),
    })?;
    machine.name = machine.name.or_else(|| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
    Ok(machine)
}

/// The settings of a machine file.
///
/// # Errors
/// What is wrong, in words for the person who wrote the file.
pub fn load(text: &str) -> Result<Settings, MachineFileError> {
    parse(text).map(|machine| machine.settings)
}

/// The machine of a machine file.
///
/// # Errors
/// What is wrong, in words for the person who wrote the file.
pub fn parse(text: &str) -> Result<Machine, MachineFileError> {
    let file: MachineToml = toml::from_str(text).map_err(MachineFileError::Syntax)?;
    let mut s = Settings::prototype();
    let board = file.board.map(<&BoardConnectors>::from);
    s.wiring = board.map_or(s.wiring, Wiring::usual);
    plugs::wiring(&mut s, file.motors, file.endstops)?;
    put(&mut s.motor_max_speed, "motor_max_speed", file.motor_max_speed, &SPEED)?;
    put(&mut s.motor_max_acceleration, "motor_max_acceleration", file.motor_max_acceleration, &ACCELERATION)?;
    put(&mut s.print_acceleration, "print_acceleration", file.print_acceleration, &ACCELERATION)?;
    put(&mut s.retract_acceleration, "retract_acceleration", file.retract_acceleration, &ACCELERATION)?;
    put(&mut s.travel_acceleration, "travel_acceleration", file.travel_acceleration, &ACCELERATION)?;
    put(&mut s.extruder_jerk, "extruder_jerk", file.extruder_jerk, &SPEED)?;
    put(&mut s.min_feed, "min_feed", file.min_feed, &LEAST_SPEED)?;
    put(&mut s.min_travel, "min_travel", file.min_travel, &LEAST_SPEED)?;
    put(&mut s.arc_tolerance, "arc_tolerance", file.arc_tolerance, &TOLERANCE)?;
    put(&mut s.keepalive_s, "keepalive_s", file.keepalive_s, &KEEPALIVE)?;
    put(&mut s.patience_ms, "patience_ms", file.patience_ms, &PATIENCE)?;
    put(&mut s.minimum_cruise_ratio, "minimum_cruise_ratio", file.minimum_cruise_ratio, &CRUISE_RATIO)?;
    put(&mut s.lookahead_time, "lookahead_time", file.lookahead_time, &LOOKAHEAD_TIME)?;
    s.advanced_ok = file.advanced_ok.unwrap_or(s.advanced_ok);
    s.soft_endstops = file.soft_endstops.unwrap_or(s.soft_endstops);
    // A machine with motors of its own is not called as the prototype is.
    let own = file.name.clone().or_else(|| file.mechanism.is_some().then(String::new));
    if let Some(name) = own {
        s.name = MachineName::new(&name).ok_or(MachineFileError::Name(name))?;
    }
    s.require_homing = file.require_homing.unwrap_or(s.require_homing);
    // Rows do not tell one belt from two.
    s.belt.is_closed = file.belt.closed.unwrap_or(s.belt.is_closed && file.mechanism.is_none());
    belt(&mut s.belt, &file.belt)?;
    if let Some(file) = file.mechanism {
        s.mechanism = mechanism(file)?;
    }
    s.corner = corner(s.corner, &file.corner)?;
    shaper(&mut s.shapers.x, "shaper.x", &file.shaper.x)?;
    shaper(&mut s.shapers.y, "shaper.y", &file.shaper.y)?;
    put(&mut s.advance.time, "advance.time", file.advance.time, &ADVANCE)?;
    match file.advance.window {
        Some(WindowToml::Seconds(seconds)) => {
            s.advance.window = Some(quantity("advance.window", seconds, &ADVANCE_WINDOW)?);
        }
        Some(WindowToml::Auto) => s.advance.window = None,
        None => {}
    }
    axis(&mut s.axes.x, "axes.x", &file.axes.x)?;
    axis(&mut s.axes.y, "axes.y", &file.axes.y)?;
    axis(&mut s.axes.z, "axes.z", &file.axes.z)?;
    axis(&mut s.axes.e, "axes.e", &file.axes.e)?;
    bed(&mut s, &file.bed)?;
    pause(&mut s.pause, &file.pause)?;
    homing::homing(&mut s, &file.homing)?;
    put(&mut s.baud, "baud", file.baud, &BAUD)?;
    driver(&mut s.drivers.belt, "drivers.belt", &file.drivers.belt)?;
    driver(&mut s.drivers.z, "drivers.z", &file.drivers.z)?;
    driver(&mut s.drivers.e, "drivers.e", &file.drivers.e)?;
    for (number, file) in [&file.axes.x, &file.axes.y, &file.axes.z, &file.axes.e].into_iter().enumerate() {
        resolution(&mut s, number, file)?;
    }
    heat::thermal(&mut s.thermal, &file.thermal, &file.heaters, &file.fans)?;
    s.check_machine().map_err(MachineFileError::Settings)?;
    s.check_connectors(board.unwrap_or(&SIM)).map_err(MachineFileError::Connectors)?;
    Ok(Machine { name: file.name, board, settings: s })
}

/// The rows of the motors that the file lists; the others are not fitted.
fn mechanism(file: MechanismToml) -> Result<Mechanism, MachineFileError> {
    let MechanismToml { m1, m4, m8, m11, z1, z2, e0 } = file;
    let mut mechanism = Mechanism { rows: [[0; 4]; Motor::ALL.len()] };
    for ((motor, slot), listed) in Motor::ALL.into_iter().zip(&mut mechanism.rows).zip([m1, m4, m8, m11, z1, z2, e0]) {
        if let Some(RowToml(listed)) = listed {
            let key = || format!("mechanism.{}", motor.name());
            *slot = row(&listed).ok_or_else(|| MachineFileError::Row { key: key(), row: listed })?;
        }
    }
    Ok(mechanism)
}

/// x, y, z and perhaps e.
fn row(listed: &[f64]) -> Option<Row> {
    let mut row = [0; 4];
    for (slot, times) in row.iter_mut().zip(listed) {
        *slot = (-MOST_MULTIPLE..=MOST_MULTIPLE).find(|legal| f64::from(*legal) == *times)?;
    }
    let multiple = multiple(row);
    let is_whole = row.iter().zip(direction(row)).all(|(times, direction)| *times == multiple * direction);
    (is_whole && matches!(listed.len(), 3 | 4)).then_some(row)
}

fn corner(default: CornerRule, file: &CornerToml) -> Result<CornerRule, MachineFileError> {
    match (file.junction_deviation, file.square_corner) {
        (None, None) => Ok(default),
        (Some(d), None) => quantity("corner.junction_deviation", d, &TOLERANCE).map(CornerRule::JunctionDeviation),
        (None, Some(v)) => quantity("corner.square_corner", v, &SPEED).map(CornerRule::SquareCorner),
        (Some(_), Some(_)) => Err(MachineFileError::Corner),
    }
}

fn axis(a: &mut AxisSettings, table: &str, file: &AxisToml) -> Result<(), MachineFileError> {
    put(&mut a.max_speed, &format!("{table}.max_speed"), file.max_speed, &SPEED)?;
    put(&mut a.max_acceleration, &format!("{table}.max_acceleration"), file.max_acceleration, &ACCELERATION)?;
    put(&mut a.length, &format!("{table}.length"), file.length, &AXIS_LENGTH)
}

fn belt(b: &mut Belt, file: &BeltToml) -> Result<(), MachineFileError> {
    put(&mut b.settling_ms, "belt.settling", file.settling, &SETTLING)?;
    put(&mut b.max_speed, "belt.max_speed", file.max_speed, &SPEED)?;
    put(&mut b.max_acceleration, "belt.max_acceleration", file.max_acceleration, &ACCELERATION)?;
    put(&mut b.homing_advance, "belt.homing_advance", file.homing_advance, &HOMING_ADVANCE)?;
    b.alignment = file.alignment.map_or(b.alignment, Into::into);
    put(&mut b.preload, "belt.preload", file.preload, &PRELOAD)?;
    put(&mut b.limp_lift, "belt.limp_lift", file.limp_lift, &LIMP_LIFT)?;
    let Some(phases) = &file.phases else { return Ok(()) };
    if phases.len() > b.phases.len() {
        return Err(MachineFileError::Phases);
    }
    b.phases = [Belt::NO_PHASE; PHASES];
    for (place, phase) in b.phases.iter_mut().zip(phases) {
        put(place, "belt.phases", Some(*phase), &PHASE)?;
    }
    Ok(())
}

/// Without a word on it, the bed is what the tool reaches.
fn bed(s: &mut Settings, file: &BedToml) -> Result<(), MachineFileError> {
    s.bed = Bed::of_reach(&s.axes);
    put(&mut s.bed.width, "bed.width", file.width, &AXIS_LENGTH)?;
    put(&mut s.bed.depth, "bed.depth", file.depth, &AXIS_LENGTH)?;
    put(&mut s.bed.left, "bed.left", file.left, &BED_EDGE)?;
    put(&mut s.bed.front, "bed.front", file.front, &BED_EDGE)
}

fn pause(p: &mut Pause, file: &PauseToml) -> Result<(), MachineFileError> {
    put(&mut p.retract, "pause.retract", file.retract, &PAUSE_RETRACT)?;
    put(&mut p.retract_speed, "pause.retract_speed", file.retract_speed, &SPEED)?;
    put(&mut p.unretract_speed, "pause.unretract_speed", file.unretract_speed, &SPEED)?;
    put(&mut p.lift, "pause.lift", file.lift, &PAUSE_LIFT)?;
    p.park = file.park.unwrap_or(p.park);
    put(&mut p.x, "pause.x", file.x, &BED_EDGE)?;
    put(&mut p.y, "pause.y", file.y, &BED_EDGE)?;
    put(&mut p.travel_speed, "pause.travel_speed", file.travel_speed, &SPEED)?;
    put_whole(&mut p.heat_off_min, "pause.heat_off_min", file.heat_off_min, ranges::PAUSE_HEAT_MIN)
}

fn shaper(s: &mut Shaper, table: &str, file: &ShaperToml) -> Result<(), MachineFileError> {
    s.kind = file.kind.map_or(s.kind, ShaperKind::from);
    put(&mut s.frequency, &format!("{table}.frequency"), file.frequency, &FREQUENCY)?;
    put(&mut s.damping, &format!("{table}.damping"), file.damping, &DAMPING)?;
    put(&mut s.span, &format!("{table}.span"), file.span, &BELT_SPAN)?;
    put(&mut s.motor_frequency, &format!("{table}.motor_frequency"), file.motor_frequency, &MOTOR_FREQUENCY)
}

fn driver(d: &mut DriverSettings, table: &str, file: &DriverToml) -> Result<(), MachineFileError> {
    put_whole(&mut d.current_ma, &format!("{table}.current_ma"), file.current_ma, ranges::CURRENT_MA)?;
    put_whole(&mut d.hold_percent, &format!("{table}.hold_percent"), file.hold_percent, ranges::HOLD_PERCENT)?;
    put_whole(&mut d.microsteps, &format!("{table}.microsteps"), file.microsteps, ranges::MICROSTEPS)?;
    d.stealth = file.stealth.unwrap_or(d.stealth);
    put(&mut d.hybrid_threshold, &format!("{table}.hybrid_threshold"), file.hybrid_threshold, &LEAST_SPEED)?;
    let any = Range { least: u8::MIN, most: u8::MAX };
    put_whole(&mut d.stall_threshold, &format!("{table}.stall_threshold"), file.stall_threshold, any)
}

#[cfg(test)]
mod tests;
