//! The check that every setting is legal: within its range, and in accord with the others.

use super::ranges::{self, Range};
use super::thermal::{FanSettings, HeaterModel, HeaterSettings, ThermalSettings, Thermistor};
use super::{AxisSettings, Bed, Belt, CornerRule, DriverSettings, Endstop, HomedAxis, Homing, Pause, Settings, Shaper};
use crate::connectors::Heater;
use crate::kinematics::{MechanismError, multiple};
use crate::motors::Motor;
use crate::units::{Celsius, Mm, MmPerSec, Ratio, StepsPerMm, WattsPerKelvin};

/// What is wrong with a set of settings; the text names the setting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingsError {
    /// A value lies outside its range in [`ranges`].
    OutOfRange(&'static str),
    /// Speed times resolution of this axis or motor is above [`ranges::STEP_RATE`].
    TooManySteps(&'static str),
    /// Two axes share motors, so they need the same steps a millimetre.
    ResolutionsDiffer(&'static str),
    /// These motors move an axis together, and a full step of theirs is not the same length: with their rows, and these
    /// microsteps of the drivers of these keys.
    MicrostepsDiffer {
        /// The motors.
        motors: [Motor; 2],
        /// Microsteps of their drivers.
        microsteps: [u16; 2],
        /// Keys of their drivers in machine files.
        keys: [&'static str; 2],
    },
    /// The motors are those of no machine.
    Mechanism(MechanismError),
    /// Microsteps of these drivers are no power of two.
    NoSuchMicrosteps(&'static str),
    /// Two heaters that are fitted share an output or a sensor.
    SharedHeater(&'static str),
    /// G28 would leave out an axis.
    HomingOrder,
    /// The belt is said to be closed, and its motors cannot turn it round while the tool stands.
    Circulation,
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::OutOfRange(what) => write!(f, "{what} is outside its legal range"),
            Self::TooManySteps(axis) => {
                write!(f, "{axis}: speed limit x steps_per_mm is above {} steps/s", ranges::STEP_RATE)
            }
            Self::ResolutionsDiffer(axes) => write!(f, "{axes} share motors: their steps_per_mm must be equal"),
            Self::MicrostepsDiffer { motors: [a, b], microsteps: [of_a, of_b], keys: [key_a, key_b] } => write!(
                f,
                "motors {} and {} move the same axis with {of_a} and {of_b} microsteps, and one would go further than the \
                 other: set {key_a}.microsteps and {key_b}.microsteps alike",
                a.name(),
                b.name()
            ),
            Self::Mechanism(error) => error.fmt(f),
            Self::HomingOrder => f.write_str("homing.order names x, y and z once each"),
            Self::Circulation => {
                f.write_str("belt.closed: turning all motors of x and y alike moves the tool, so no belt runs round")
            }
            Self::SharedHeater(what) => write!(f, "two heaters have the same {what}"),
            Self::NoSuchMicrosteps(group) => write!(f, "{group}: microsteps are 1, 2, 4 and so on up to 256"),
        }
    }
}

impl core::error::Error for SettingsError {}

fn within<T: PartialOrd + Copy>(range: Range<T>, value: T, what: &'static str) -> Result<(), SettingsError> {
    if range.holds(value) { Ok(()) } else { Err(SettingsError::OutOfRange(what)) }
}

fn axis(a: &AxisSettings, name: &'static str) -> Result<(), SettingsError> {
    within(ranges::STEPS_PER_MM, a.steps_per_mm, name)?;
    within(ranges::SPEED, a.max_speed, name)?;
    within(ranges::ACCELERATION, a.max_acceleration, name)?;
    within(ranges::AXIS_LENGTH, a.length, name)
}

fn step_rate(speed: MmPerSec, steps_per_mm: StepsPerMm, name: &'static str) -> Result<(), SettingsError> {
    let rate = (u64::from(speed.to_bits()) * u64::from(steps_per_mm.to_bits())) >> 32;
    if rate > u64::from(ranges::STEP_RATE) { Err(SettingsError::TooManySteps(name)) } else { Ok(()) }
}

fn homing(h: &Homing, name: &'static str) -> Result<(), SettingsError> {
    within(ranges::SPEED, h.fast, name)?;
    within(ranges::SPEED, h.slow, name)?;
    within(ranges::BACK_OFF, h.back_off, name)
}

fn endstop(e: Endstop, length: Mm, name: &'static str) -> Result<(), SettingsError> {
    within(ranges::endstop_position(e.end, length), e.position, name)
}

fn bed(b: Bed) -> Result<(), SettingsError> {
    within(ranges::AXIS_LENGTH, b.width, "bed.width")?;
    within(ranges::AXIS_LENGTH, b.depth, "bed.depth")?;
    within(ranges::BED_EDGE, b.left, "bed.left")?;
    within(ranges::BED_EDGE, b.front, "bed.front")
}

fn belt(b: Belt) -> Result<(), SettingsError> {
    within(ranges::SETTLING_MS, b.settling_ms, "belt.settling")?;
    within(ranges::SPEED, b.max_speed, "belt.max_speed")?;
    within(ranges::ACCELERATION, b.max_acceleration, "belt.max_acceleration")?;
    within(ranges::HOMING_ADVANCE, b.homing_advance, "belt.homing_advance")?;
    within(ranges::PRELOAD, b.preload, "belt.preload")?;
    within(ranges::LIMP_LIFT, b.limp_lift, "belt.limp_lift")?;
    b.phases.into_iter().try_for_each(|phase| within(ranges::PHASE, phase, "belt.phases"))
}

fn pause(p: &Pause) -> Result<(), SettingsError> {
    within(ranges::PAUSE_RETRACT, p.retract, "pause.retract")?;
    within(ranges::SPEED, p.retract_speed, "pause.retract_speed")?;
    within(ranges::SPEED, p.unretract_speed, "pause.unretract_speed")?;
    within(ranges::PAUSE_LIFT, p.lift, "pause.lift")?;
    within(ranges::BED_EDGE, p.x, "pause.x")?;
    within(ranges::BED_EDGE, p.y, "pause.y")?;
    within(ranges::SPEED, p.travel_speed, "pause.travel_speed")?;
    within(ranges::PAUSE_HEAT_MIN, p.heat_off_min, "pause.heat_off_min")
}

fn shaper(s: &Shaper, name: &'static str) -> Result<(), SettingsError> {
    within(ranges::FREQUENCY, s.frequency, name)?;
    within(ranges::DAMPING, s.damping, name)?;
    if s.span != Mm::ZERO {
        within(ranges::BELT_SPAN, s.span, name)?;
    }
    within(ranges::MOTOR_FREQUENCY, s.motor_frequency, name)
}

fn driver(d: &DriverSettings, name: &'static str) -> Result<(), SettingsError> {
    within(ranges::CURRENT_MA, d.current_ma, name)?;
    within(ranges::HOLD_PERCENT, d.hold_percent, name)?;
    within(ranges::MICROSTEPS, d.microsteps, name)?;
    within(Range { least: MmPerSec::ZERO, most: ranges::SPEED.most }, d.hybrid_threshold, name)?;
    if d.microsteps.is_power_of_two() { Ok(()) } else { Err(SettingsError::NoSuchMicrosteps(name)) }
}

fn thermal(t: &ThermalSettings) -> Result<(), SettingsError> {
    for (name, h) in [("hotend", &t.heaters.hotend), ("bed", &t.heaters.bed), ("chamber", &t.heaters.chamber)] {
        heater(h, if name == "hotend" { ranges::HOTEND } else { ranges::BED }, name)?;
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
    t.fans.iter().try_for_each(fan)?;
    within(ranges::MIN_EXTRUDE, t.min_extrude, "min_extrude")?;
    within(ranges::COLD_END, t.hotend_fan_above, "hotend_fan_above")?;
    within(ranges::RUN_ON_S, t.fan_run_on_s, "fan_run_on_s")?;
    within(ranges::IDLE_MIN, t.idle_min, "idle_min")?;
    within(ranges::FILAMENT, t.filament, "filament")
}

fn heater(h: &HeaterSettings, target: Range<Celsius>, name: &'static str) -> Result<(), SettingsError> {
    within(target, h.most, name)?;
    within(ranges::POWER, h.power, name)?;
    within(ranges::MAX_DUTY, h.max_duty, name)?;
    within(ranges::RELAY_MS, h.period_ms, name)?;
    let HeaterModel { capacity, loss, fan_loss, heater_lag, sensor_lag } = h.model;
    within(ranges::CAPACITY, capacity, name)?;
    within(ranges::LOSS, loss, name)?;
    within(Range { least: WattsPerKelvin::ZERO, most: ranges::LOSS.most }, fan_loss, name)?;
    within(ranges::LAG, heater_lag, name)?;
    within(ranges::LAG, sensor_lag, name)?;
    for gain in [h.pid.p, h.pid.i, h.pid.d] {
        within(ranges::GAIN, gain, name)?;
    }
    within(ranges::HEATING, h.guards.heating, name)?;
    within(ranges::LOST, h.guards.lost, name)?;
    within(ranges::LOST_S, h.guards.lost_s, name)?;
    within(ranges::OFF_RISE, h.guards.off_rise, name)?;
    within(ranges::OVERSHOOT, h.guards.overshoot, name)?;
    if let Thermistor::Beta { ohms, beta } = h.thermistor {
        within(ranges::OHMS, ohms, name)?;
        within(ranges::BETA, beta, name)?;
    }
    Ok(())
}

fn fan(f: &FanSettings) -> Result<(), SettingsError> {
    within(ranges::KICK_MS, f.kick_ms, "fan.kick_ms")?;
    within(Range { least: Ratio::ZERO, most: Ratio::ONE }, f.least, "fan.least")?;
    within(Range { least: f.least.max(ranges::MAX_DUTY.least), most: Ratio::ONE }, f.most, "fan.most")
}

impl Settings {
    /// The same as [`check`](Self::check), and whether the mechanism is one: for whoever makes a machine. Stored settings
    /// are taken only for the mechanism that a machine has already.
    ///
    /// # Errors
    /// The first thing found to be wrong.
    pub fn check_machine(&self) -> Result<(), SettingsError> {
        self.mechanism.check().map_err(SettingsError::Mechanism)?;
        if self.belt.is_closed && !self.mechanism.can_circulate() {
            return Err(SettingsError::Circulation);
        }
        self.check()
    }

    /// Checks every value against its range, but for the mechanism.
    ///
    /// # Errors
    /// The first setting found to be illegal.
    pub fn check(&self) -> Result<(), SettingsError> {
        axis(&self.axes.x, "axes.x")?;
        axis(&self.axes.y, "axes.y")?;
        axis(&self.axes.z, "axes.z")?;
        axis(&self.axes.e, "axes.e")?;
        let a = &self.axes;
        for (number, (axis, name)) in
            [(&a.x, "axes.x"), (&a.y, "axes.y"), (&a.z, "axes.z"), (&a.e, "axes.e")].into_iter().enumerate()
        {
            within(ranges::STEPS_PER_MM, self.finest(number), name)?;
            step_rate(axis.max_speed, self.finest(number), name)?;
        }
        self.check_shared_motors().map_err(SettingsError::ResolutionsDiffer)?;
        within(ranges::SPEED, self.motor_max_speed, "motor_max_speed")?;
        for axis in 0..2 {
            step_rate(self.motor_max_speed, self.finest(axis), "motor_max_speed")?;
        }
        within(ranges::ACCELERATION, self.motor_max_acceleration, "motor_max_acceleration")?;
        within(ranges::ACCELERATION, self.print_acceleration, "print_acceleration")?;
        within(ranges::ACCELERATION, self.retract_acceleration, "retract_acceleration")?;
        within(ranges::ACCELERATION, self.travel_acceleration, "travel_acceleration")?;
        match self.corner {
            CornerRule::JunctionDeviation(d) => within(ranges::TOLERANCE, d, "corner.junction_deviation")?,
            CornerRule::SquareCorner(v) => within(ranges::SPEED, v, "corner.square_corner")?,
        }
        within(ranges::SPEED, self.extruder_jerk, "extruder_jerk")?;
        within(ranges::TOLERANCE, self.arc_tolerance, "arc_tolerance")?;
        shaper(&self.shapers.x, "shaper.x")?;
        shaper(&self.shapers.y, "shaper.y")?;
        within(ranges::ADVANCE, self.advance.time, "advance.time")?;
        if let Some(window) = self.advance.window {
            within(ranges::ADVANCE_WINDOW, window, "advance.window")?;
        }
        homing(&self.homing.x, "homing.x")?;
        homing(&self.homing.y, "homing.y")?;
        homing(&self.homing.z, "homing.z")?;
        endstop(self.endstops.x, self.axes.x.length, "homing.x.position")?;
        endstop(self.endstops.y, self.axes.y.length, "homing.y.position")?;
        endstop(self.endstops.z, self.axes.z.length, "homing.z.position")?;
        if !HomedAxis::ALL.iter().all(|axis| self.homing_order.contains(axis)) {
            return Err(SettingsError::HomingOrder);
        }
        within(ranges::BAUD, self.baud, "baud")?;
        bed(self.bed)?;
        belt(self.belt)?;
        pause(&self.pause)?;
        let most = ranges::SPEED.most;
        if self.min_feed > most || self.min_travel > most {
            return Err(SettingsError::OutOfRange("min_feed or min_travel"));
        }
        within(ranges::KEEPALIVE_S, self.keepalive_s, "keepalive_s")?;
        if self.patience_ms > 0 {
            within(ranges::PATIENCE_MS, self.patience_ms, "patience_ms")?;
        }
        within(ranges::LOOKAHEAD_TIME, self.lookahead_time, "lookahead_time")?;
        driver(&self.drivers.belt, "drivers.belt")?;
        driver(&self.drivers.z, "drivers.z")?;
        driver(&self.drivers.e, "drivers.e")?;
        self.check_microsteps()?;
        within(ranges::CRUISE_RATIO, self.minimum_cruise_ratio, "minimum_cruise_ratio")?;
        thermal(&self.thermal)
    }

    /// Checks that motors which move an axis together go equally far in a full step, as far as their drivers have a say. With the
    /// same microsteps their rows may differ, for pulleys may; with others, rows must be in the same ratio.
    fn check_microsteps(&self) -> Result<(), SettingsError> {
        let rows = || Motor::ALL.into_iter().zip(self.mechanism.rows);
        for (a, row) in rows() {
            for (b, other) in rows().skip(a as usize + 1) {
                let shares = row.iter().zip(other).any(|(times, others)| *times != 0 && others != 0);
                let ((first, key), (second, other_key)) = (self.drivers.of(a), self.drivers.of(b));
                let microsteps = [first.microsteps, second.microsteps];
                let full_steps = |row, other: u16| u32::from(multiple(row).unsigned_abs()) * u32::from(other);
                if shares
                    && first.microsteps != second.microsteps
                    && full_steps(row, second.microsteps) != full_steps(other, first.microsteps)
                {
                    return Err(SettingsError::MicrostepsDiffer { motors: [a, b], microsteps, keys: [key, other_key] });
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
