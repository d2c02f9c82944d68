//! Axes, corners, shapers, homing and drivers of a machine file.

use super::super::resolution::FULL_STEPS;
use corehbot::settings::{Range, ShaperKind, ranges};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::fmt::{self, Formatter};

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CornerToml {
    /// How far an arc that rounds a corner may leave it, in mm (M205 J).
    pub junction_deviation: Option<f64>,
    /// The speed through a right angle, in mm/s (M205 X, Y).
    pub square_corner: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ShapersToml {
    /// The shaper of x.
    pub x: ShaperToml,
    /// The shaper of y.
    pub y: ShaperToml,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ShaperToml {
    /// The kind of shaper.
    pub kind: Option<KindToml>,
    /// Frequency at which the axis rings, in Hz.
    pub frequency: Option<f64>,
    /// Damping of the axis, as a ratio.
    pub damping: Option<f64>,
    /// Length of the belts that pull along the axis, both sides together, in mm; 0: it rings the same everywhere.
    pub span: Option<f64>,
    /// The lower, the more the motors give way, in Hz, as fitted to frequencies in the middle and near an end; 0: motors are stiff.
    pub motor_frequency: Option<f64>,
}

/// The shapers by the names that Klipper gives them.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum KindToml {
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

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AdvanceToml {
    /// K of M900, in s; 0 is none.
    pub time: Option<f64>,
    /// Over how many seconds the extruder's speed is averaged (M572 W); "auto" is as long as suits the shapers.
    pub window: Option<WindowToml>,
}

/// The window of the advance: a number, or the word "auto".
#[derive(Clone, Copy)]
pub(crate) enum WindowToml {
    Auto,
    Seconds(f64),
}

// By hand: what serde derives for a number or a word says nothing of either when it finds something else.
impl<'de> Deserialize<'de> for WindowToml {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Words;

        impl Visitor<'_> for Words {
            type Value = WindowToml;

            fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
                f.write_str("\"auto\" or a number of seconds")
            }

            fn visit_f64<E: de::Error>(self, seconds: f64) -> Result<WindowToml, E> {
                Ok(WindowToml::Seconds(seconds))
            }

            fn visit_i64<E: de::Error>(self, seconds: i64) -> Result<WindowToml, E> {
                Ok(WindowToml::Seconds(seconds as f64))
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<WindowToml, E> {
                if word == "auto" {
                    Ok(WindowToml::Auto)
                } else {
                    Err(E::invalid_value(de::Unexpected::Str(word), &self))
                }
            }
        }

        deserializer.deserialize_any(Words)
    }
}

impl JsonSchema for WindowToml {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Window".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let Range { least, most } = ranges::ADVANCE_WINDOW;
        let [least, most] = [least, most].map(|seconds| (seconds.to_num::<f64>() * 1e6).round() / 1e6);
        json_schema!({
            "anyOf": [{ "type": "string", "enum": ["auto"] }, { "type": "number", "minimum": least, "maximum": most }]
        })
    }
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AxesToml {
    /// The axis x.
    pub x: AxisToml,
    /// The axis y.
    pub y: AxisToml,
    /// The axis z.
    pub z: AxisToml,
    /// The extruder; its length is the longest single move.
    pub e: AxisToml,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AxisToml {
    /// Steps of a motor for 1 mm, microsteps counted; or say rotation_distance instead.
    pub steps_per_mm: Option<f64>,
    /// What a turn of the motor moves the axis, in mm (teeth x pitch, lead of a screw, with gears). Steps/mm =
    /// full_steps x microsteps / rotation_distance.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rotation_distance: Option<f64>,
    /// Full steps of a turn of the motor, for rotation_distance; 200 if left out.
    #[schemars(with = "Option<u16>", range(min = FULL_STEPS.least, max = FULL_STEPS.most))]
    pub full_steps: Option<f64>,
    /// Speed limit, in mm/s.
    pub max_speed: Option<f64>,
    /// Acceleration limit, in mm/s2.
    pub max_acceleration: Option<f64>,
    /// Length of the axis, in mm.
    pub length: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct HomingsToml {
    /// The order in which G28 homes the axes, each of them once; x, y, z if left out.
    pub order: Option<[HomedAxisToml; 3]>,
    /// How x finds its endstop.
    pub x: HomingToml,
    /// How y finds its endstop.
    pub y: HomingToml,
    /// How z finds its endstop.
    pub z: HomingToml,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct HomingToml {
    /// Speed of the first approach, in mm/s.
    pub fast: Option<f64>,
    /// Speed of the second approach, in mm/s.
    pub slow: Option<f64>,
    /// The way back between them, in mm.
    pub back_off: Option<f64>,
    /// The end of the axis at which the switch sits: min, where positions are small, or max. min if left out.
    pub end: Option<EndToml>,
    /// Position at which the switch is met, in mm: in that half of the axis, or up to 50 mm outside. Left out, it is 0 at
    /// the min end and the length of the axis at the max end.
    pub position: Option<f64>,
}

/// An end of an axis.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EndToml {
    Min,
    Max,
}

/// An axis that is homed.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HomedAxisToml {
    X,
    Y,
    Z,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct DriversToml {
    /// Drivers of the motors 1, 4, 8 and 11.
    pub belt: DriverToml,
    /// Drivers of the screws.
    pub z: DriverToml,
    /// Driver of the extruder.
    pub e: DriverToml,
}

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct DriverToml {
    /// Current of a running motor, in mA, root mean square (M906).
    pub current_ma: Option<f64>,
    /// Current at rest, in percent of current_ma.
    pub hold_percent: Option<f64>,
    /// Microsteps of a full step: 1, 2, 4 and so on up to 256. Steps/mm follow them.
    pub microsteps: Option<f64>,
    /// stealthChop instead of spreadCycle (M569).
    pub stealth: Option<bool>,
    /// Speed above which stealthChop gives way to spreadCycle, in mm/s; 0 is never (M913).
    pub hybrid_threshold: Option<f64>,
    /// StallGuard threshold SGTHRS; 0 is none (M914).
    pub stall_threshold: Option<f64>,
}
