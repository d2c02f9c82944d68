//! The check that every setting is legal: within its range, and in accord with the others.

use super::ranges;
use super::rows::{Field, Key, Value, Visitor};
use super::thermal::{ThermalSettings, Thermistor};
use super::{DriverGroups, EXTRA_SENSORS, Endstop, HomedAxis, OwnDriver, PLACES, Range, Settings};
use crate::connectors::{FANS, HEATERS, Heater};
use crate::kinematics::{MechanismError, Row, multiple};
use crate::motors::{Motor, MotorName, MotorSet};
use crate::units::{Mm, MmPerSec, Seconds, StepsPerMm};

/// The error in a set of settings; the text names the setting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingsError {
    /// A value lies outside the range of its row.
    OutOfRange(Key),
    /// The value of this key lies outside the range that other settings leave it.
    OutOfRangeBeside(&'static str),
    /// Speed times resolution of this axis or motor is above [`ranges::STEP_RATE`].
    TooManySteps(&'static str),
    /// Two axes share motors, so they need the same steps a millimetre.
    ResolutionsDiffer(&'static str),
    /// These motors move an axis together, but their full steps differ in length: by their rows, and by the microsteps
    /// of the drivers with these keys.
    MicrostepsDiffer {
        /// The motors.
        motors: [MotorName; 2],
        /// Microsteps of their drivers.
        microsteps: [u16; 2],
        /// Keys of their drivers in machine files.
        keys: [&'static str; 2],
    },
    /// These motors pull one closed belt, and their own currents differ.
    BeltCurrents {
        /// The motors.
        motors: [MotorName; 2],
        /// Their own currents in mA; 0 is the current of their group.
        currents: [u16; 2],
    },
    /// This motor has own values of its driver, but its name means a group of drivers.
    NamedAsGroup(MotorName),
    /// The motors fit no machine.
    Mechanism {
        /// Why.
        error: MechanismError,
        /// The motor with the wrong row; none if more than one row is.
        motor: MotorName,
    },
    /// The names of the motors are not a list of different ones.
    MotorNames,
    /// The motor of this number is fitted, and has no name.
    Nameless(u8),
    /// Microsteps of these drivers are no power of two.
    NoSuchMicrosteps(&'static str),
    /// Two heaters that are fitted share an output or a sensor.
    SharedHeater(&'static str),
    /// The sensor at this place is to guard a heater that is not fitted, or has no input of its own for that.
    GuardsNothing(&'static str),
    /// G28 would leave out an axis.
    HomingOrder,
    /// Z is to be homed by a probe, and there is none.
    NoProbe,
    /// The belt is set as closed, but its motors cannot circulate it while the tool stands.
    Circulation,
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::OutOfRange(key) => put!(f, "{key} is outside its legal range"),
            Self::OutOfRangeBeside(key) => put!(f, "{key} is outside its legal range"),
            Self::TooManySteps(axis) => {
                put!(f, "{axis}: speed limit x steps_per_mm is above {} steps/s", ranges::STEP_RATE.whole())
            }
            Self::ResolutionsDiffer(axes) => put!(f, "{axes} share motors: their steps_per_mm must be equal"),
            Self::MicrostepsDiffer { motors: [a, b], microsteps: [of_a, of_b], keys: [key_a, key_b] } => put!(
                f,
                "motors {a} and {b} move the same axis with {of_a} and {of_b} microsteps, so one moves further than the \
                other: set {key_a}.microsteps and {key_b}.microsteps alike",
            ),
            Self::BeltCurrents { motors: [a, b], currents: [of_a, of_b] } => {
                put!(f, "motors {a} and {b} pull one closed belt, but ")?;
                match (of_a, of_b) {
                    (0, of_b) => put!(f, "only {b} has its own current, {of_b} mA")?,
                    (of_a, 0) => put!(f, "only {a} has its own current, {of_a} mA")?,
                    (of_a, of_b) => put!(f, "with {of_a} and {of_b} mA")?,
                }
                put!(f, ": give all motors of the belt the same current_ma, or set drivers.belt.current_ma alone")
            }
            Self::NamedAsGroup(motor) => {
                put!(f, "drivers.{motor} is a group of drivers, not motor {motor} alone: rename the motor")
            }
            Self::Mechanism { error, motor } if motor.is_none() => put!(f, "mechanism: {error}"),
            Self::Mechanism { error, motor } => put!(f, "mechanism.{motor}: {error}"),
            Self::MotorNames => put!(f, "motors.names has every motor once"),
            Self::Nameless(number) => {
                put!(f, "mechanism has a row for motor {number} of motors.names, which has no such motor")
            }
            Self::HomingOrder => put!(f, "homing.order names x, y and z once each"),
            Self::Circulation => {
                put!(f, "belt.closed: turning all motors of x and y alike moves the tool, so no belt runs round")
            }
            Self::NoProbe => put!(f, "probe.z_home needs a probe: set probe.kind"),
            Self::GuardsNothing(place) => {
                put!(f, "sensors.{place}.guards: it guards a fitted heater, by an input that is not the heater's own")
            }
            Self::SharedHeater(what) => put!(f, "two heaters have the same {what}"),
            Self::NoSuchMicrosteps(group) => put!(f, "{group}: microsteps are 1, 2, 4 and so on up to 256"),
        }
    }
}

impl core::error::Error for SettingsError {}

/// Looks for a setting outside its range.
struct Ranges {
    first: Option<Key>,
}

impl Visitor for Ranges {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        let is_legal = match field.get() {
            Value::Number(number) => key.row.legal(key.part.into()).holds(number),
            Value::Absent | Value::Text(_) => true,
        };
        if !is_legal && self.first.is_none() {
            self.first = Some(key);
        }
    }
}

fn step_rate(speed: MmPerSec, steps_per_mm: StepsPerMm, name: &'static str) -> Result<(), SettingsError> {
    let rate = (speed * steps_per_mm).whole();
    if rate > ranges::STEP_RATE.whole() { Err(SettingsError::TooManySteps(name)) } else { Ok(()) }
}

/// An error with `key`, unless its value is legal together with other settings.
const fn legal_beside(is_legal: bool, key: &'static str) -> Result<(), SettingsError> {
    if is_legal { Ok(()) } else { Err(SettingsError::OutOfRangeBeside(key)) }
}

fn endstop(e: Endstop, reach: Range<Mm>, key: &'static str) -> Result<(), SettingsError> {
    legal_beside(e.end.positions(reach).holds(e.position), key)
}

fn thermal(t: &ThermalSettings) -> Result<(), SettingsError> {
    for (heater, key) in Heater::ALL.into_iter().zip(&THERMISTORS) {
        thermistor(t.heater(heater).thermistor, key)?;
    }
    for (a, b) in [(Heater::Hotend, Heater::Bed), (Heater::Hotend, Heater::Chamber), (Heater::Bed, Heater::Chamber)] {
        let (a, b) = (t.heater(a), t.heater(b));
        if a.is_fitted && b.is_fitted && a.output == b.output {
            return Err(SettingsError::SharedHeater("output"));
        }
        if a.is_fitted && b.is_fitted && a.sensor == b.sensor {
            return Err(SettingsError::SharedHeater("sensor"));
        }
    }
    for (extra, (place, _)) in t.sensors.iter().zip(&PLACES) {
        let is_second = |(heater, sensor)| {
            let heater = t.heater(heater);
            heater.is_fitted && heater.sensor != sensor
        };
        if extra.is_fitted && extra.guards.is_some() && !extra.guarded().is_some_and(is_second) {
            return Err(SettingsError::GuardsNothing(place));
        }
    }
    for (fan, key) in t.fans.iter().zip(&FAN_DUTIES) {
        legal_beside(fan.least <= fan.most, key)?;
    }
    Ok(())
}

fn thermistor(kind: Thermistor, key: &'static str) -> Result<(), SettingsError> {
    let is_legal = match kind {
        Thermistor::Sheet(_) => kind.sheet().is_some(),
        Thermistor::Beta { ohms, beta, .. } => ranges::OHMS.holds(ohms) && ranges::BETA.holds(beta),
    };
    legal_beside(is_legal, key)
}

/// Keys of axes.
const AXES: [&str; 4] = ["axes.x", "axes.y", "axes.z", "axes.e"];

/// Keys of the lengths of axes, and of the places of their switches.
const LENGTHS: [(&str, &str); 3] = [
    ("axes.x.length", "homing.x.position"),
    ("axes.y.length", "homing.y.position"),
    ("axes.z.length", "homing.z.position"),
];

/// Keys of groups of drivers.
const GROUPS: [&str; 3] = ["drivers.belt", "drivers.z", "drivers.e"];

/// Keys of thermistors without a heater.
const EXTRA_THERMISTORS: [&str; EXTRA_SENSORS] =
    ["sensors.chamber.thermistor", "sensors.board.thermistor", "sensors.probe.thermistor", "sensors.second.thermistor"];

/// Keys of thermistors.
const THERMISTORS: [&str; HEATERS] =
    ["heaters.hotend.thermistor", "heaters.bed.thermistor", "heaters.chamber.thermistor"];

/// Keys of fans' greatest duties.
const FAN_DUTIES: [&str; FANS] =
    ["fans.fan0.most", "fans.fan1.most", "fans.fan2.most", "fans.fan3.most", "fans.fan4.most", "fans.fan5.most"];

impl Settings {
    /// The same as [`check`](Self::check), and whether the mechanism is legal: for callers that make a machine. Stored
    /// settings are taken only for the mechanism that a machine has already.
    ///
    /// # Errors
    /// The first error.
    pub fn check_machine(&self) -> Result<(), SettingsError> {
        self.mechanism.check().map_err(|error| SettingsError::Mechanism {
            error,
            motor: error.motor().map_or(MotorName::NONE, |motor| self.name_of(motor)),
        })?;
        let is_nameless = |motor: &Motor| self.name_of(*motor).is_none();
        if let Some(motor) = self.mechanism.fitted().iter().find(is_nameless) {
            return Err(SettingsError::Nameless(motor.number() + 1));
        }
        if self.belt.is_closed && !self.mechanism.can_circulate() {
            return Err(SettingsError::Circulation);
        }
        self.check()
    }

    /// Checks every value against its range, except the mechanism.
    ///
    /// # Errors
    /// The first setting found to be illegal.
    pub fn check(&self) -> Result<(), SettingsError> {
        let mut found = Ranges { first: None };
        // Visitors may change values; this one does not.
        self.clone().visit(&mut found);
        // First, because the rules below reckon with values that are in range.
        if let Some(key) = found.first {
            return Err(SettingsError::OutOfRange(key));
        }
        for (number, name) in AXES.iter().enumerate() {
            let Some(axis) = self.axes.get(number) else { break };
            let finest = self.finest(number);
            // A motor with a multiple makes more steps than the axis has.
            legal_beside(ranges::STEPS_PER_MM.holds(finest), name)?;
            step_rate(axis.max_speed, finest, name)?;
        }
        self.check_shared_motors().map_err(SettingsError::ResolutionsDiffer)?;
        for axis in 0..2 {
            // A belt motor may have to be as fast as x and y together, so it has a limit of its own.
            step_rate(self.motor_max_speed, self.finest(axis), "motor_max_speed")?;
        }
        // As a row this is no window, which is legal.
        legal_beside(self.advance.window != Some(Seconds::ZERO), "advance.window")?;
        for (axis, (length, position)) in HomedAxis::ALL.into_iter().zip(&LENGTHS) {
            let reach = self.reach(axis);
            legal_beside(ranges::PLACE.holds(reach.most), length)?;
            endstop(self.endstops.of(axis), reach, position)?;
        }
        if !HomedAxis::ALL.iter().all(|axis| self.homing_order.contains(axis)) {
            return Err(SettingsError::HomingOrder);
        }
        if self.probe.homes_z && !self.probe.is_fitted() {
            return Err(SettingsError::NoProbe);
        }
        let DriverGroups { belt, z, e, own: _ } = &self.drivers;
        for (driver, group) in [belt, z, e].into_iter().zip(&GROUPS) {
            if !driver.microsteps.is_power_of_two() {
                return Err(SettingsError::NoSuchMicrosteps(group));
            }
        }
        self.check_motor_names()?;
        self.check_own_drivers()?;
        self.check_microsteps()?;
        for (sensor, key) in self.thermal.sensors.iter().zip(&EXTRA_THERMISTORS) {
            thermistor(sensor.thermistor, key)?;
        }
        thermal(&self.thermal)
    }

    /// Checks that names of motors differ, and that none follows a missing one.
    fn check_motor_names(&self) -> Result<(), SettingsError> {
        for (at, name) in self.motor_names.iter().enumerate() {
            let is_in_place = |earlier: &MotorName| !earlier.is_none() && earlier != name;
            if !name.is_none() && !self.motor_names.iter().take(at).all(is_in_place) {
                return Err(SettingsError::MotorNames);
            }
        }
        Ok(())
    }

    /// Checks that motors with own values of their drivers may have them.
    fn check_own_drivers(&self) -> Result<(), SettingsError> {
        let belt = if self.belt.is_closed { self.mechanism.belt_motors() } else { MotorSet::NONE };
        let current = |motor: Motor| self.drivers.own(motor).current_ma;
        let mut first = None;
        for motor in belt.iter() {
            let first = *first.get_or_insert(motor);
            if current(motor) != current(first) {
                let motors = [self.name_of(first), self.name_of(motor)];
                return Err(SettingsError::BeltCurrents { motors, currents: [current(first), current(motor)] });
            }
        }
        let is_group = |motor: &Motor| DriverGroups::NAMES.contains(&self.name_of(*motor).as_str());
        let has_own = |motor: &Motor| self.drivers.own(*motor) != OwnDriver::NONE;
        match Motor::ALL.into_iter().find(|motor| is_group(motor) && has_own(motor)) {
            Some(motor) => Err(SettingsError::NamedAsGroup(self.name_of(motor))),
            None => Ok(()),
        }
    }

    /// Checks that motors which move an axis together go equally far in a full step, by their rows and their drivers'
    /// microsteps. With the same microsteps their rows may differ, because pulleys may; with others, rows must be in
    /// the same ratio.
    fn check_microsteps(&self) -> Result<(), SettingsError> {
        let full_steps = |row: &Row, other: u16| u32::from(multiple(*row).unsigned_abs()) * u32::from(other);
        let rows = &self.mechanism.rows;
        for (a, row) in Motor::ALL.into_iter().zip(rows) {
            for (b, other) in Motor::ALL.into_iter().zip(rows).skip(a.index() + 1) {
                let shares = row.iter().zip(other).any(|(times, others)| *times != 0 && *others != 0);
                let ((first, key), (second, other_key)) = (self.driver_group(a), self.driver_group(b));
                let microsteps = [first.microsteps, second.microsteps];
                if shares
                    && first.microsteps != second.microsteps
                    && full_steps(row, second.microsteps) != full_steps(other, first.microsteps)
                {
                    let motors = [self.name_of(a), self.name_of(b)];
                    return Err(SettingsError::MicrostepsDiffer { motors, microsteps, keys: [key, other_key] });
                }
            }
        }
        Ok(())
    }

    /// Checks that axes which share motors have the same resolution: a motor has one.
    ///
    /// # Errors
    /// Two axes that have not.
    pub fn check_shared_motors(&self) -> Result<(), &'static str> {
        let [x, y, z] = [self.axes.x, self.axes.y, self.axes.z].map(|a| a.steps_per_mm);
        for (axes, a, b, is_equal) in [("x and y", 0, 1, x == y), ("x and z", 0, 2, x == z), ("y and z", 1, 2, y == z)]
        {
            // A closed belt has one step.
            let shares = self.mechanism.share(a, b) || (self.belt.is_closed && (a, b) == (0, 1));
            if !is_equal && shares {
                return Err(axes);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
