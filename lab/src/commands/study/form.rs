//! The keys of a study, as its file has them.

use corehbot_questions::play::RunModel;
use corehbot_questions::setup::{MachineArg, ModelArg};
use corehbot_twin::params::Params;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::Spanned;

/// A study.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudyToml {
    /// The queries for each sample.
    pub compute: Vec<QueryToml>,
    /// The machines, each with the same numbers.
    #[serde(default = "corehbot")]
    pub machines: Vec<MachineArg>,
    /// Parts that may move besides the tool, where nothing is played; without it, the default of each query's command.
    pub model: Option<ModelArg>,
    /// Where the tool is, in mm from motor 1's axis; neither: in the middle of its reach.
    pub at: Option<[f64; 2]>,
    /// Columns and rows of places over the reach; the worst place counts.
    pub worst_of: Option<[usize; 2]>,
    /// How samples are chosen.
    pub method: MethodToml,
    /// How many a Latin hypercube has.
    pub samples: Option<usize>,
    /// The seed of a Latin hypercube.
    pub seed: Option<u64>,
    /// The numbers that are varied, by their keys.
    pub vary: BTreeMap<Spanned<String>, AxisToml>,
    /// Numbers that are not, where they are not the nominal ones.
    #[serde(default)]
    pub twin: Params,
    pub push: Option<PushToml>,
    #[serde(default)]
    pub limits: LimitsToml,
    #[serde(default)]
    pub resonance: ResonanceToml,
    pub run: Option<RunToml>,
}

/// A question.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum QueryToml {
    Stiffness,
    Modes,
    Push,
    Limits,
    Resonance,
    Run,
}

fn corehbot() -> Vec<MachineArg> {
    vec![MachineArg::Corehbot]
}

/// How samples are chosen.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MethodToml {
    Grid,
    LatinHypercube,
}

/// Values of a number.
#[derive(Clone, Serialize)]
#[serde(untagged)]
pub(super) enum AxisToml {
    Levels(Vec<f64>),
    Range(RangeToml),
}

/// From one value to another, in a number of grid points.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RangeToml {
    pub from: f64,
    pub to: f64,
    pub count: Option<usize>,
}

/// The force in N, to the right and away from the front.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PushToml {
    #[serde(rename = "force_N")]
    pub force_n: [f64; 2],
}

/// As `twin limits` has them.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct LimitsToml {
    pub error_mm: f64,
    pub torque: f64,
}

impl Default for LimitsToml {
    fn default() -> Self {
        Self { error_mm: 0.025, torque: 0.5 }
    }
}

/// Columns and rows of places over the reach.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ResonanceToml {
    pub grid: [usize; 2],
}

impl Default for ResonanceToml {
    fn default() -> Self {
        Self { grid: [7, 7] }
    }
}

/// The file to play.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RunToml {
    /// G-code or a step trace, seen from the folder of the study.
    pub file: PathBuf,
    /// Parts that move besides the tool.
    #[serde(default = "rotors")]
    pub model: RunModel,
    /// The machine file that the firmware has.
    pub settings: Option<PathBuf>,
    /// Where G-code begins.
    pub assume_homed: Option<[f64; 3]>,
    /// Where the tool is at the begin, in mm from motor 1's axis (not in G-code's coordinates), which `twin run` calls
    /// `--at`.
    pub begin: Option<[f64; 2]>,
}

const fn rotors() -> RunModel {
    RunModel::Rotors
}

/// By hand, so that an error inside a range is reported with its place.
impl<'de> Deserialize<'de> for AxisToml {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = AxisToml;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a list of numbers, or { from, to } and on a grid its count")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<AxisToml, A::Error> {
                let mut levels = Vec::new();
                while let Some(level) = items.next_element()? {
                    levels.push(level);
                }
                Ok(AxisToml::Levels(levels))
            }

            fn visit_map<A: MapAccess<'de>>(self, entries: A) -> Result<AxisToml, A::Error> {
                RangeToml::deserialize(MapAccessDeserializer::new(entries)).map(AxisToml::Range)
            }
        }
        deserializer.deserialize_any(Either)
    }
}
