//! The form of a machine file: its tables and keys, every one optional.

use corehbot::connectors::{BoardConnectors, NUCLEO, OCTOPUS, Output, SIM, Sensor};
use corehbot::settings::{Control, FanRole, ShaperKind};
use serde::Deserialize;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MachineToml {
    pub name: Option<String>,
    pub board: Option<BoardToml>,
    pub motor_max_speed: Option<f64>,
    pub motor_max_acceleration: Option<f64>,
    pub print_acceleration: Option<f64>,
    pub retract_acceleration: Option<f64>,
    pub travel_acceleration: Option<f64>,
    pub extruder_jerk: Option<f64>,
    pub min_feed: Option<f64>,
    pub min_travel: Option<f64>,
    pub soft_endstops: Option<bool>,
    pub require_homing: Option<bool>,
    pub arc_tolerance: Option<f64>,
    pub keepalive_s: Option<f64>,
    pub patience_ms: Option<f64>,
    pub lookahead_time: Option<f64>,
    pub advanced_ok: Option<bool>,
    pub minimum_cruise_ratio: Option<f64>,
    pub mechanism: Option<MechanismToml>,
    pub motors: MotorsToml,
    pub endstops: EndstopsToml,
    pub corner: CornerToml,
    pub shaper: ShapersToml,
    pub advance: AdvanceToml,
    pub axes: AxesToml,
    pub homing: HomingsToml,
    pub drivers: DriversToml,
    pub thermal: ThermalToml,
    pub heaters: HeatersToml,
    pub fans: FansToml,
}

/// Boards by their names in `connectors`.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum BoardToml {
    Octopus,
    Nucleo,
    Sim,
}

impl From<BoardToml> for &'static BoardConnectors {
    fn from(board: BoardToml) -> Self {
        match board {
            BoardToml::Octopus => &OCTOPUS,
            BoardToml::Nucleo => &NUCLEO,
            BoardToml::Sim => &SIM,
        }
    }
}

/// The connector of each motor.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MotorsToml {
    pub m1: Option<String>,
    pub m4: Option<String>,
    pub m8: Option<String>,
    pub m11: Option<String>,
    pub z1: Option<String>,
    pub z2: Option<String>,
    pub e0: Option<String>,
}

/// The connector of each axis' switch.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct EndstopsToml {
    pub x: Option<String>,
    pub y: Option<String>,
    pub z: Option<String>,
}

/// A row a motor that is fitted.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MechanismToml {
    pub m1: Option<Vec<f64>>,
    pub m4: Option<Vec<f64>>,
    pub m8: Option<Vec<f64>>,
    pub m11: Option<Vec<f64>>,
    pub z1: Option<Vec<f64>>,
    pub z2: Option<Vec<f64>>,
    pub e0: Option<Vec<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct CornerToml {
    pub junction_deviation: Option<f64>,
    pub square_corner: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ShapersToml {
    pub x: ShaperToml,
    pub y: ShaperToml,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ShaperToml {
    pub kind: Option<KindToml>,
    pub frequency: Option<f64>,
    pub damping: Option<f64>,
    pub span: Option<f64>,
    pub motor_frequency: Option<f64>,
}

/// The shapers by the names that Klipper gives them.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum KindToml {
    None,
    Zv,
    Zvd,
    Mzv,
    Ei,
    #[serde(rename = "2hump_ei")]
    TwoHumpEi,
}

impl From<KindToml> for ShaperKind {
    fn from(kind: KindToml) -> Self {
        match kind {
            KindToml::None => Self::None,
            KindToml::Zv => Self::Zv,
            KindToml::Zvd => Self::Zvd,
            KindToml::Mzv => Self::Mzv,
            KindToml::Ei => Self::Ei,
            KindToml::TwoHumpEi => Self::TwoHumpEi,
        }
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct AdvanceToml {
    pub time: Option<f64>,
    pub window: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct AxesToml {
    pub x: AxisToml,
    pub y: AxisToml,
    pub z: AxisToml,
    pub e: AxisToml,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct AxisToml {
    pub steps_per_mm: Option<f64>,
    pub rotation_distance: Option<f64>,
    pub full_steps: Option<f64>,
    pub max_speed: Option<f64>,
    pub max_acceleration: Option<f64>,
    pub length: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct HomingsToml {
    pub x: HomingToml,
    pub y: HomingToml,
    pub z: HomingToml,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct HomingToml {
    pub fast: Option<f64>,
    pub slow: Option<f64>,
    pub back_off: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct DriversToml {
    pub belt: DriverToml,
    pub z: DriverToml,
    pub e: DriverToml,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct DriverToml {
    pub current_ma: Option<f64>,
    pub hold_percent: Option<f64>,
    pub microsteps: Option<f64>,
    pub stealth: Option<bool>,
    pub hybrid_threshold: Option<f64>,
    pub stall_threshold: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ThermalToml {
    pub min_extrude: Option<f64>,
    pub hotend_fan_above: Option<f64>,
    pub fan_run_on_s: Option<f64>,
    pub idle_min: Option<f64>,
    pub filament: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct HeatersToml {
    pub hotend: HeaterToml,
    pub bed: HeaterToml,
    pub chamber: HeaterToml,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct HeaterToml {
    pub is_fitted: Option<bool>,
    pub output: Option<OutputToml>,
    pub sensor: Option<SensorToml>,
    pub thermistor: Option<ThermistorToml>,
    pub most: Option<f64>,
    pub power: Option<f64>,
    pub max_duty: Option<f64>,
    pub period_ms: Option<f64>,
    pub control: Option<ControlToml>,
    pub model: ModelToml,
    pub pid: PidToml,
    pub guards: GuardsToml,
}

/// Heater outputs by the names on a board.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum OutputToml {
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
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SensorToml {
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
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ThermistorToml {
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
        ohms: f64,
        beta: f64,
    },
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ControlToml {
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

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ModelToml {
    pub capacity: Option<f64>,
    pub loss: Option<f64>,
    pub fan_loss: Option<f64>,
    pub heater_lag: Option<f64>,
    pub sensor_lag: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct PidToml {
    pub p: Option<f64>,
    pub i: Option<f64>,
    pub d: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct GuardsToml {
    pub heating: Option<f64>,
    pub lost: Option<f64>,
    pub lost_s: Option<f64>,
    pub off_rise: Option<f64>,
    pub overshoot: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct FansToml {
    pub fan0: FanToml,
    pub fan1: FanToml,
    pub fan2: FanToml,
    pub fan3: FanToml,
    pub fan4: FanToml,
    pub fan5: FanToml,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct FanToml {
    pub role: Option<RoleToml>,
    pub kick_ms: Option<f64>,
    pub least: Option<f64>,
    pub most: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum RoleToml {
    Commanded,
    Hotend,
    Controller,
}

impl From<RoleToml> for FanRole {
    fn from(role: RoleToml) -> Self {
        match role {
            RoleToml::Commanded => Self::Commanded,
            RoleToml::Hotend => Self::Hotend,
            RoleToml::Controller => Self::Controller,
        }
    }
}
