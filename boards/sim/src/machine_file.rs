//! Machine file: settings as TOML that a person writes.
//!
//! Every key is optional and stands over the prototype's value, but for `[mechanism]`, which lists all motors or is left out; an unknown key or a value outside its legal
//! range is an error that names both. `examples/machines/prototype.toml` shows every key.

mod form;
mod place;

use anyhow::{Context as _, anyhow};
use corehbot::kinematics::{Mechanism, Row};
use corehbot::motors::Motor;
use corehbot::settings::{
    AxisSettings, CornerRule, DriverSettings, Homing, Range, Settings, SettingsError, Shaper, ShaperKind, ranges,
};
use corehbot::units::{Hertz, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm};
use form::{AxisToml, CornerToml, DriverToml, HomingToml, MachineToml, MechanismToml, ShaperToml};
pub use place::Place;
use std::fmt::{self, Display};
use std::path::Path;

/// A machine as its file describes it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Machine {
    /// What the file calls it.
    pub name: Option<String>,
    /// Its settings, all in range.
    pub settings: Settings,
}

/// What is wrong with a machine file.
#[derive(Debug)]
pub enum MachineFileError {
    /// Not TOML, an unknown key, or a value of the wrong type.
    Syntax(toml::de::Error),
    /// A value outside its range.
    Range {
        /// The key with its tables.
        key: String,
        /// The value in the file.
        value: f64,
        /// Least and greatest legal value.
        legal: String,
    },
    /// `corner` names no rule, or both.
    Corner,
    /// A row of `mechanism` that is none.
    Row {
        /// The key with its table.
        key: String,
        /// The row in the file.
        row: Vec<f64>,
    },
    /// The values do not go together.
    Settings(SettingsError),
}

impl Display for MachineFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(error) => f.write_str(&place::words(error)),
            Self::Range { key, value, legal } => write!(f, "{key} = {value} is outside {legal}"),
            Self::Corner => f.write_str("corner wants either junction_deviation or square_corner"),
            Self::Row { key, row } => {
                write!(f, "{key} = {row:?} is no row: -1, 0 or 1 for x, y, z and, if not 0, for e")
            }
            Self::Settings(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MachineFileError {}

impl MachineFileError {
    /// Where in the file it is, if it is at one place.
    #[must_use]
    pub fn place(&self, text: &str) -> Option<Place> {
        let key = match self {
            Self::Syntax(error) => return error.span().map(|span| Place::of_byte(text, span.start)),
            Self::Range { key, .. } | Self::Row { key, .. } => key.clone(),
            Self::Corner => "corner.square_corner".to_owned(),
            Self::Settings(SettingsError::OutOfRange(key)) => (*key).to_owned(),
            Self::Settings(SettingsError::TooManySteps(table)) => format!("{table}.max_speed"),
            Self::Settings(SettingsError::NoSuchMicrosteps(table)) => format!("{table}.microsteps"),
            Self::Settings(SettingsError::ResolutionsDiffer(axes)) => {
                // Two axes by their names; the second one is as good a place as the first.
                let axes = axes.split(" and ").map(|axis| format!("axes.{axis}.steps_per_mm"));
                return axes.filter_map(|key| Place::of_key(text, &key)).last();
            }
            Self::Settings(SettingsError::Mechanism(_)) => "mechanism".to_owned(),
        };
        Place::of_key(text, &key)
    }
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

/// A kind of quantity: its legal range, and how it comes from a number that is not NaN.
struct Kind<T> {
    range: Range<T>,
    convert: fn(f64) -> T,
}

const RESOLUTION: Kind<StepsPerMm> =
    Kind { range: ranges::STEPS_PER_MM, convert: StepsPerMm::saturating_from_num::<f64> };
const SPEED: Kind<MmPerSec> = Kind { range: ranges::SPEED, convert: MmPerSec::saturating_from_num::<f64> };
const LEAST_SPEED: Kind<MmPerSec> = Kind { range: Range { least: MmPerSec::ZERO, most: ranges::SPEED.most }, ..SPEED };
const ACCELERATION: Kind<MmPerSec2> =
    Kind { range: ranges::ACCELERATION, convert: MmPerSec2::saturating_from_num::<f64> };
const LENGTH: Kind<Mm> = Kind { range: ranges::LENGTH, convert: Mm::saturating_from_num::<f64> };
const TOLERANCE: Kind<Mm> = Kind { range: ranges::TOLERANCE, ..LENGTH };
const BACK_OFF: Kind<Mm> = Kind { range: ranges::BACK_OFF, ..LENGTH };
const FREQUENCY: Kind<Hertz> = Kind { range: ranges::FREQUENCY, convert: Hertz::saturating_from_num::<f64> };
const BELT_SPAN: Kind<Mm> = Kind { range: Range { least: Mm::ZERO, most: ranges::BELT_SPAN.most }, ..LENGTH };
const MOTOR_FREQUENCY: Kind<Hertz> = Kind { range: ranges::MOTOR_FREQUENCY, ..FREQUENCY };
const DAMPING: Kind<Ratio> = Kind { range: ranges::DAMPING, convert: Ratio::saturating_from_num::<f64> };
const CRUISE_RATIO: Kind<Ratio> = Kind { range: ranges::CRUISE_RATIO, ..DAMPING };
const ADVANCE: Kind<Seconds> = Kind { range: ranges::ADVANCE, convert: Seconds::saturating_from_num::<f64> };
const ADVANCE_WINDOW: Kind<Seconds> = Kind { range: ranges::WINDOW, ..ADVANCE };
const LOOKAHEAD_TIME: Kind<Seconds> = Kind { range: ranges::LOOKAHEAD_TIME, ..ADVANCE };
const PATIENCE: Kind<u16> = Kind { range: Range { least: 0, most: ranges::PATIENCE_MS.most }, convert: |ms| ms as u16 };
const KEEPALIVE: Kind<u8> = Kind { range: Range { least: 0, most: 60 }, convert: |s| s as u8 };

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
    s.require_homing = file.require_homing.unwrap_or(s.require_homing);
    if let Some(file) = file.mechanism {
        s.mechanism = mechanism(file)?;
    }
    s.corner = corner(s.corner, &file.corner)?;
    shaper(&mut s.shapers.x, "shaper.x", &file.shaper.x)?;
    shaper(&mut s.shapers.y, "shaper.y", &file.shaper.y)?;
    put(&mut s.advance.time, "advance.time", file.advance.time, &ADVANCE)?;
    put(&mut s.advance.window, "advance.window", file.advance.window, &ADVANCE_WINDOW)?;
    axis(&mut s.axes.x, "axes.x", &file.axes.x)?;
    axis(&mut s.axes.y, "axes.y", &file.axes.y)?;
    axis(&mut s.axes.z, "axes.z", &file.axes.z)?;
    axis(&mut s.axes.e, "axes.e", &file.axes.e)?;
    homing(&mut s.homing.x, "homing.x", &file.homing.x)?;
    homing(&mut s.homing.y, "homing.y", &file.homing.y)?;
    homing(&mut s.homing.z, "homing.z", &file.homing.z)?;
    driver(&mut s.drivers.belt, "drivers.belt", &file.drivers.belt)?;
    driver(&mut s.drivers.z, "drivers.z", &file.drivers.z)?;
    driver(&mut s.drivers.e, "drivers.e", &file.drivers.e)?;
    s.check_machine().map_err(MachineFileError::Settings)?;
    Ok(Machine { name: file.name, settings: s })
}

/// The rows of the motors that the file lists; the others are not fitted.
fn mechanism(file: MechanismToml) -> Result<Mechanism, MachineFileError> {
    let MechanismToml { m1, m4, m8, m11, z1, z2, e0 } = file;
    let mut mechanism = Mechanism { rows: [[0; 4]; Motor::ALL.len()] };
    for ((motor, slot), listed) in Motor::ALL.into_iter().zip(&mut mechanism.rows).zip([m1, m4, m8, m11, z1, z2, e0]) {
        if let Some(listed) = listed {
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
        *slot = [-1, 0, 1].into_iter().find(|legal| f64::from(*legal) == *times)?;
    }
    matches!(listed.len(), 3 | 4).then_some(row)
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
    put(&mut a.steps_per_mm, &format!("{table}.steps_per_mm"), file.steps_per_mm, &RESOLUTION)?;
    put(&mut a.max_speed, &format!("{table}.max_speed"), file.max_speed, &SPEED)?;
    put(&mut a.max_acceleration, &format!("{table}.max_acceleration"), file.max_acceleration, &ACCELERATION)?;
    put(&mut a.length, &format!("{table}.length"), file.length, &LENGTH)
}

fn shaper(s: &mut Shaper, table: &str, file: &ShaperToml) -> Result<(), MachineFileError> {
    s.kind = file.kind.map_or(s.kind, ShaperKind::from);
    put(&mut s.frequency, &format!("{table}.frequency"), file.frequency, &FREQUENCY)?;
    put(&mut s.damping, &format!("{table}.damping"), file.damping, &DAMPING)?;
    put(&mut s.span, &format!("{table}.span"), file.span, &BELT_SPAN)?;
    put(&mut s.motor_frequency, &format!("{table}.motor_frequency"), file.motor_frequency, &MOTOR_FREQUENCY)
}

fn homing(h: &mut Homing, table: &str, file: &HomingToml) -> Result<(), MachineFileError> {
    put(&mut h.fast, &format!("{table}.fast"), file.fast, &SPEED)?;
    put(&mut h.slow, &format!("{table}.slow"), file.slow, &SPEED)?;
    put(&mut h.back_off, &format!("{table}.back_off"), file.back_off, &BACK_OFF)
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

/// Puts a whole number of the file, if there is one, in the place of the default.
fn put_whole<T: PartialOrd + Copy + Display + Into<f64> + TryFrom<u16>>(
    slot: &mut T,
    key: &str,
    value: Option<f64>,
    range: Range<T>,
) -> Result<(), MachineFileError> {
    let Some(value) = value else { return Ok(()) };
    // A saturated or cut number is no longer the one in the file.
    let whole = T::try_from(value as u16).ok().filter(|whole| (*whole).into() == value && range.holds(*whole));
    let legal = || format!("the whole numbers {} to {}", range.least, range.most);
    *slot = whole.ok_or_else(|| MachineFileError::Range { key: key.to_owned(), value, legal: legal() })?;
    Ok(())
}

/// Puts a value of the file, if there is one, in the place of the default.
fn put<T: PartialOrd + Copy + Display>(
    slot: &mut T,
    key: &str,
    value: Option<f64>,
    kind: &Kind<T>,
) -> Result<(), MachineFileError> {
    if let Some(value) = value {
        *slot = quantity(key, value, kind)?;
    }
    Ok(())
}

fn quantity<T: PartialOrd + Copy + Display>(key: &str, value: f64, kind: &Kind<T>) -> Result<T, MachineFileError> {
    let Kind { range, convert } = kind;
    // Conversions saturate, which leaves an illegal value illegal, but they have no answer to NaN.
    match (!value.is_nan()).then(|| convert(value)) {
        Some(legal) if range.holds(legal) => Ok(legal),
        _ => {
            let legal = format!("{} to {}", range.least, range.most);
            Err(MachineFileError::Range { key: key.to_owned(), value, legal })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_file_is_the_prototype() {
        assert_eq!(load("").unwrap(), Settings::prototype());
    }

    #[test]
    fn the_example_is_the_prototype_with_every_key() {
        let text = include_str!("../../../examples/machines/prototype.toml");
        assert_eq!(load(text).unwrap(), Settings::prototype());
        assert_eq!(text.lines().filter(|l| l.contains(" = ")).count(), 80);
    }

    #[test]
    fn keys_stand_over_the_defaults() {
        let s = load("soft_endstops = false\n[axes.x]\nmax_speed = 250\n[corner]\nsquare_corner = 8.5").unwrap();
        assert_eq!(s.axes.x.max_speed, MmPerSec::from_num(250));
        assert_eq!(s.axes.x.length, Settings::prototype().axes.x.length);
        assert_eq!(s.corner, CornerRule::SquareCorner(MmPerSec::from_num(8.5)));
        assert!(!s.soft_endstops && !s.require_homing);
        assert!(load("require_homing = true").unwrap().require_homing);
        let s = load("[shaper.x]\nkind = \"2hump_ei\"\nfrequency = 42.5\n[advance]\ntime = 0.05").unwrap();
        assert_eq!((s.shapers.x.kind, s.shapers.x.frequency), (ShaperKind::TwoHumpEi, Hertz::from_num(42.5)));
        let s2 = load("[shaper.y]\nspan = 862.2\nmotor_frequency = 167").unwrap();
        assert_eq!((s2.shapers.y.span, s2.shapers.y.motor_frequency), (Mm::from_num(862.2), Hertz::from_num(167)));
        assert_eq!((s.shapers.y.kind, s.advance.time), (ShaperKind::None, Seconds::from_num(0.05)));
    }

    #[test]
    fn a_mechanism_lists_the_motors_that_are_fitted() {
        let xy = "m8 = [1, 0, 0]\nm11 = [0, 1, 0]\n";
        let s = load(&format!("[mechanism]\n{xy}z1 = [0, 0, 1]\ne0 = [0, 0, 0, -1]\n[axes.y]\nsteps_per_mm = 100"))
            .unwrap();
        let none = [0; 4];
        assert_eq!(s.mechanism.rows, [none, none, [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], none, [0, 0, 0, -1]]);
        let error = |text: &str| load(&format!("[mechanism]\n{text}")).unwrap_err().to_string();
        let illegal = "is no row: -1, 0 or 1 for x, y, z and, if not 0, for e";
        assert_eq!(error("m1 = [2, 0, 0]"), format!("mechanism.m1 = [2.0, 0.0, 0.0] {illegal}"));
        assert_eq!(error("z2 = [0, 0.5, 0]"), format!("mechanism.z2 = [0.0, 0.5, 0.0] {illegal}"));
        for short in ["e0 = [0, 1]", "e0 = [0, 0, 0, 0, 1]", "e0 = []", "e0 = [nan, 0, 0]"] {
            assert!(error(short).contains(illegal), "{short}");
        }
        assert_eq!(error(xy), "mechanism: no motor moves z");
        assert_eq!(error(&format!("{xy}z1 = [0, 0, 1]")), "mechanism: no motor moves e");
        let rest = "z1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]";
        assert!(error(&format!("m1 = [1, 1, 0]\nm4 = [-1, -1, 0]\n{rest}")).contains("do not hold"));
        assert!(
            error(&format!("{xy}z1 = [0, 0, 1, 1]")).contains("mechanism.z1: a motor moves the tool or the filament")
        );
        let many = "m1 = [1, 1, 0]\nm4 = [1, -1, 0]\nm8 = [1, 0, 0]\nm11 = [0, 1, 0]";
        assert!(error(&format!("{many}\n{rest}")).contains("at most 5 motors may differ"));
        assert!(error("m2 = [1, 0, 0]").contains("unknown field `m2`"));
        assert!(error(&format!("m8 = [1, 0, 1]\nm11 = [0, 1, 0]\n{rest}")).contains("x and z share motors"));
    }

    #[test]
    fn errors_have_a_place() {
        let place = |text: &str| load(text).unwrap_err().place(text).map(|place| place.to_string());
        for (text, expected) in [
            ("\n[axes.x]\n max_speed = 5000", "3:14"),
            ("[axes.x]\nmax_sped = 50", "2:1"),
            ("[axes.x]\nmax_speed = 'fast'", "2:13"),
            ("[axes.x]\nmax_speed = ", "2:13"),
            ("[axes]\ny = { steps_per_mm = 100 }", "2:22"),
            ("[mechanism]\nm1 = [2, 0, 0]", "2:6"),
            ("[mechanism]\nm8 = [1, 0, 0]", "1:2"),
            ("[drivers.belt]\nmicrosteps = 24", "2:14"),
            ("[shaper.x]\nspan = 99", "1:9"),
            ("[corner]\njunction_deviation = 0.1\nsquare_corner = 1", "3:17"),
            ("motor_max_speed = 3000\n[axes.x]\nsteps_per_mm = 20000\n[axes.y]\nsteps_per_mm = 20000", "2:7"),
        ] {
            assert_eq!(place(text).as_deref(), Some(expected), "{text}");
        }
    }

    #[test]
    fn a_misspelt_key_has_a_suggestion() {
        let error = |text: &str| load(text).unwrap_err().to_string();
        assert!(error("[axes.x]\nmax_sped = 1").ends_with("did you mean `max_speed`?"));
        assert!(error("[axis.x]\nmax_speed = 1").ends_with("did you mean `axes`?"));
        assert!(error("[shaper.x]\nkind = 'mvz'").ends_with("did you mean `mzv`?"));
        assert!(!error("[axes.x]\ncolour = 1").contains("did you mean"));
    }

    #[test]
    fn errors_name_the_key_and_what_is_legal() {
        let error = |text: &str| load(text).unwrap_err().to_string();
        assert_eq!(error("[axes.x]\nmax_speed = 5000"), "axes.x.max_speed = 5000 is outside 0.01 to 3000");
        assert_eq!(error("keepalive_s = 61"), "keepalive_s = 61 is outside 0 to 60");
        assert_eq!(error("patience_ms = 60001"), "patience_ms = 60001 is outside 0 to 60000");
        assert_eq!(error("minimum_cruise_ratio = 1"), "minimum_cruise_ratio = 1 is outside 0 to 0.9");
        assert!(error("patience_ms = 99").contains("patience_ms"));
        assert_eq!(error("lookahead_time = 0.4"), "lookahead_time = 0.4 is outside 0.5 to 60");
        assert!(error("print_acceleration = nan").contains("is outside 1 to 100000"));
        assert!(error("extruder_jerk = -1").contains("extruder_jerk = -1"));
        let legal = "drivers.e.stall_threshold = 256 is outside the whole numbers 0 to 255";
        assert_eq!(error("[drivers.e]\nstall_threshold = 256"), legal);
        assert!(error("[drivers.z]\nhold_percent = -1").contains("0 to 100"));
        assert!(error("[drivers.belt]\nmicrosteps = 16.5").contains("whole"));
        assert!(error("[drivers.belt]\nmicrosteps = 24").contains("1, 2, 4"));
        assert_eq!(error("[shaper.x]\nfrequency = 9"), "shaper.x.frequency = 9 is outside 10 to 500");
        assert_eq!(error("[shaper.x]\nspan = 10001"), "shaper.x.span = 10001 is outside 0 to 10000");
        assert!(error("[shaper.x]\nspan = 99").contains("shaper.x"));
        assert!(error("[shaper.y]\nkind = \"zvdd\"").contains("`none`, `zv`, `zvd`, `mzv`, `ei`, `2hump_ei`"));
        assert_eq!(error("[advance]\nwindow = 0.3"), "advance.window = 0.3 is outside 0.005 to 0.2");
        assert!(error("[axes.x]\nspeed = 1").contains("unknown field `speed`"));
        assert!(error("[axes.y]\nsteps_per_mm = 100").contains("x and y share motors"));
        assert!(error("[corner]\nsquare_corner = 1\njunction_deviation = 0.1").contains("either"));
    }
}
