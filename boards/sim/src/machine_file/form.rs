//! The form of a machine file: its tables and keys, every one optional.

use corehbot::settings::ShaperKind;
use serde::Deserialize;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MachineToml {
    pub name: Option<String>,
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
    pub corner: CornerToml,
    pub shaper: ShapersToml,
    pub advance: AdvanceToml,
    pub axes: AxesToml,
    pub homing: HomingsToml,
    pub drivers: DriversToml,
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
