//! Heaters and fans of a machine file.

use corehbot::connectors::{Output, Sensor};
use corehbot::settings::{Control, FanRole, ranges};
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ThermalToml {
    /// No filament moves while the hotend is colder, in C (M302 S).
    pub min_extrude: Option<f64>,
    /// The hotend's fan runs above this temperature, in C.
    pub hotend_fan_above: Option<f64>,
    /// Seconds for which the controller's fan runs on after the last motor or heater.
    pub fan_run_on_s: Option<f64>,
    /// Minutes without use after which heaters go off.
    pub idle_min: Option<f64>,
    /// Heat that a mm of filament takes for each K, in J/(mm K).
    pub filament: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct HeatersToml {
    /// The hotend (T).
    pub hotend: HeaterToml,
    /// The bed (B).
    pub bed: HeaterToml,
    /// The chamber (C).
    pub chamber: HeaterToml,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct HeaterToml {
    /// Whether the machine has it.
    pub is_fitted: Option<bool>,
    /// The output that it hangs on.
    pub output: Option<OutputToml>,
    /// The input of its temperature sensor.
    pub sensor: Option<SensorToml>,
    /// The kind of sensor; or an NTC by its resistance at 25 C in Ohm and its beta in K.
    pub thermistor: Option<ThermistorToml>,
    /// Highest target, in C.
    pub most: Option<f64>,
    /// Power, in W.
    pub power: Option<f64>,
    /// Highest duty, of 1.
    pub max_duty: Option<f64>,
    /// Period of a relay, in ms; 0: the board's own modulation.
    pub period_ms: Option<f64>,
    /// Whether its model or PID finds the power.
    pub control: Option<ControlToml>,
    /// Its thermal model, which M303 finds out.
    pub model: ModelToml,
    /// PID as Marlin's, of 255.
    pub pid: PidToml,
    /// Guards, which cannot be switched off.
    pub guards: GuardsToml,
}

/// Heater outputs by the names on a board.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum OutputToml {
    Bed,
    He0,
    He1,
    He2,
    He3,
}

impl From<OutputToml> for Output {
    fn from(output: OutputToml) -> Self {
        match output {
            OutputToml::Bed => Self::Bed,
            OutputToml::He0 => Self::He0,
            OutputToml::He1 => Self::He1,
            OutputToml::He2 => Self::He2,
            OutputToml::He3 => Self::He3,
        }
    }
}

/// Sensor inputs by the names that reports print.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SensorToml {
    Bed,
    Hotend0,
    Hotend1,
    Hotend2,
    Hotend3,
}

impl From<SensorToml> for Sensor {
    fn from(sensor: SensorToml) -> Self {
        match sensor {
            SensorToml::Bed => Self::Bed,
            SensorToml::Hotend0 => Self::Hotend0,
            SensorToml::Hotend1 => Self::Hotend1,
            SensorToml::Hotend2 => Self::Hotend2,
            SensorToml::Hotend3 => Self::Hotend3,
        }
    }
}

/// Sensors by the names under which they are sold; or an NTC by its numbers.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(
    rename_all = "snake_case",
    expecting = "thermistor is one of 104gt2, 104nt4, ntc_3950, slice_450 and pt1000, or an NTC: { ohms = 100000, beta = 3950 }"
)]
pub(crate) enum ThermistorToml {
    #[serde(rename = "104gt2")]
    Semitec104Gt2,
    #[serde(rename = "104nt4")]
    Semitec104Nt4,
    #[serde(rename = "ntc_3950")]
    Generic3950,
    #[serde(rename = "slice_450")]
    Slice450,
    Pt1000,
    #[serde(untagged)]
    Beta {
        /// Resistance at 25 C, in Ohm.
        #[schemars(range(min = ranges::OHMS.least, max = ranges::OHMS.most))]
        ohms: f64,
        /// Beta, in K.
        #[schemars(range(min = ranges::BETA.least, max = ranges::BETA.most))]
        beta: f64,
    },
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ControlToml {
    Model,
    Pid,
}

impl From<ControlToml> for Control {
    fn from(control: ControlToml) -> Self {
        match control {
            ControlToml::Model => Self::Model,
            ControlToml::Pid => Self::Pid,
        }
    }
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ModelToml {
    /// Heat capacity, in J/K.
    pub capacity: Option<f64>,
    /// Losses without the part fan, in W/K.
    pub loss: Option<f64>,
    /// What the part fan adds at full speed, in W/K.
    pub fan_loss: Option<f64>,
    /// Lag of the heater, in s.
    pub heater_lag: Option<f64>,
    /// Lag of the sensor, in s.
    pub sensor_lag: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PidToml {
    /// Proportional gain, of 255 for each K.
    pub p: Option<f64>,
    /// Integral gain, of 255 for each K s.
    pub i: Option<f64>,
    /// Differential gain, of 255 for each K/s.
    pub d: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct GuardsToml {
    /// The part of its heat that must be found again.
    pub heating: Option<f64>,
    /// A temperature lost by so much alarms, in K.
    pub lost: Option<f64>,
    /// If it lasts so long, in s.
    pub lost_s: Option<f64>,
    /// A rise without power alarms, in K.
    pub off_rise: Option<f64>,
    /// Above the target without power by so much alarms, in K.
    pub overshoot: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct FansToml {
    /// FAN0.
    pub fan0: FanToml,
    /// FAN1.
    pub fan1: FanToml,
    /// FAN2.
    pub fan2: FanToml,
    /// FAN3.
    pub fan3: FanToml,
    /// FAN4.
    pub fan4: FanToml,
    /// FAN5.
    pub fan5: FanToml,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct FanToml {
    /// What it blows at: commanded (M106 P), part (the same, and it cools the hotend's block too), hotend or controller. Where no fan
    /// has the role part, the first that is commanded cools the part.
    pub role: Option<RoleToml>,
    /// The kick at its start, in ms.
    pub kick_ms: Option<f64>,
    /// Duty at the lowest speed, of 1.
    pub least: Option<f64>,
    /// Duty at full speed, of 1.
    pub most: Option<f64>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RoleToml {
    Commanded,
    Hotend,
    Controller,
    Part,
}

impl From<RoleToml> for FanRole {
    fn from(role: RoleToml) -> Self {
        match role {
            RoleToml::Commanded => Self::Commanded,
            RoleToml::Hotend => Self::Hotend,
            RoleToml::Controller => Self::Controller,
            RoleToml::Part => Self::Part,
        }
    }
}
