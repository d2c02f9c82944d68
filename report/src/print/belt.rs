//! The belt plant on a page: torque shares and residual over motion time, skips of motors, and parts that broke.

use super::tenth;
use corehbot_sim::belt::course::Course;
use corehbot_sim::belt::figures::{BeltFigures, PartFigures, SkipFigures};
use serde::Serialize;

/// Curves over bins of motion time.
#[derive(Serialize)]
pub struct BeltData {
    bin_s: f64,
    motors: Vec<MotorCurve>,
    /// Greatest residual of each bin in um, without its sign; `None` on a machine that cannot strain its belt.
    residual_um: Option<Vec<f64>>,
    skips: Vec<Mark>,
    accidents: Vec<Mark>,
}

#[derive(Serialize)]
struct MotorCurve {
    name: String,
    /// Greatest torque share of each bin in percent.
    share: Vec<f64>,
}

/// A skip or an accident, and when it was in s of motion time; `None` if its time never came.
#[derive(Serialize)]
struct Mark {
    time_s: Option<f64>,
    text: String,
}

impl BeltData {
    /// The state of the plant, over time and at the end.
    pub fn new(course: &Course, figures: &BeltFigures) -> Self {
        let bins = course.bins();
        let motor = |(index, name): (usize, String)| {
            let shares = bins.iter().map(|bin| bin.shares.get(index).copied().map_or(0.0, f64::from));
            MotorCurve { name, share: shares.map(|share| tenth(share * 100.0)).collect() }
        };
        let residual = || bins.iter().map(|bin| tenth(f64::from(bin.residual_mm) * 1000.0)).collect();
        let skip = |skip: &SkipFigures| Mark { time_s: Some(skip.time_s), text: skip.to_string() };
        let accident = |part: &PartFigures| Mark { time_s: part.began_s, text: part.to_string() };
        Self {
            bin_s: course.bin_s(),
            motors: figures.motors.iter().map(|m| m.name.clone()).enumerate().map(motor).collect(),
            residual_um: figures.residual_mm.map(|_| residual()),
            skips: figures.skips.iter().map(skip).collect(),
            accidents: figures.accidents.iter().map(accident).collect(),
        }
    }
}
