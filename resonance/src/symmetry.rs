//! Symmetry: how alike the vibration is along directions that mirror each other, as 45 and 135 degrees.
//!
//! A mirror at the x axis swaps both belts of a CoreXY, and both pairs of motors of a machine with one belt. So on a
//! machine that is built alike on both sides, both directions vibrate alike. The figure is the part of the vibration
//! that both have in common, `2 sum min(a, b) / sum (a + b)` over all pairs of runs (J. R. Bray and J. T. Curtis, Ecol.
//! Monogr. 27, 1957): 100 % if they are equal at every speed, 50 % if one is three times as loud, 0 if one is silent. A
//! correlation alone does not see that one direction is louder; it is told too, as the likeness of the shapes.

use crate::belts::correlation;
use crate::run::Run;
use serde::Serialize;

/// Angles closer than this are one, in degrees.
const SAME_DEG: f64 = 0.5;

/// Fewest speeds with a shape.
const FEWEST: usize = 3;

/// Two directions at one speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mirrored {
    /// The direction between x and y, and its mirror image.
    pub angles_deg: [f64; 2],
    /// Speed of both.
    pub speed_mm_s: f64,
    /// Vibration of both, RMS.
    pub vibration_mm_s2: [f64; 2],
}

/// How alike both sides are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Symmetry {
    /// The part of the vibration that both have in common.
    pub symmetry_percent: f64,
    /// Power of the first directions over the power of their mirror images.
    #[serde(rename = "level_difference_dB")]
    pub level_difference_db: f64,
    /// Pearson's correlation of both over the speeds, no less than 0.
    pub shape_percent: Option<f64>,
    /// Where they differ most.
    pub worst: Mirrored,
    /// All of them, by angle and speed.
    pub pairs: Vec<Mirrored>,
}

/// The symmetry of these runs; nothing if no two of them mirror each other.
pub(crate) fn symmetry(runs: &[Run]) -> Option<Symmetry> {
    let mut pairs: Vec<Mirrored> = Vec::new();
    for run in runs {
        let angle = run.angle_deg.rem_euclid(180.0);
        let is_told = pairs.iter().any(|p| p.speed_mm_s == run.speed_mm_s && is_same(p.angles_deg[0], angle));
        // The axes are their own mirror images.
        if is_told || !(SAME_DEG..=90.0 - SAME_DEG).contains(&angle) {
            continue;
        }
        let angles_deg = [angle, 180.0 - angle];
        if let [Some(a), Some(b)] = angles_deg.map(|angle| mean(runs, angle, run.speed_mm_s)) {
            pairs.push(Mirrored { angles_deg, speed_mm_s: run.speed_mm_s, vibration_mm_s2: [a, b] });
        }
    }
    pairs.sort_by(|a, b| a.angles_deg[0].total_cmp(&b.angles_deg[0]).then(a.speed_mm_s.total_cmp(&b.speed_mm_s)));
    let difference = |p: &Mirrored| (p.vibration_mm_s2[0] - p.vibration_mm_s2[1]).abs();
    let worst = *pairs.iter().max_by(|a, b| difference(a).total_cmp(&difference(b)))?;
    let sides = [0, 1].map(|side| pairs.iter().map(|p| p.vibration_mm_s2[side]).collect::<Vec<f64>>());
    let sum = sides.iter().flatten().sum::<f64>().max(f64::MIN_POSITIVE);
    let power = |side: &Vec<f64>| side.iter().map(|v| v * v).sum::<f64>().max(f64::MIN_POSITIVE);
    Some(Symmetry {
        symmetry_percent: 100.0 * (1.0 - pairs.iter().map(difference).sum::<f64>() / sum),
        level_difference_db: 10.0 * (power(&sides[0]) / power(&sides[1])).log10(),
        shape_percent: (pairs.len() >= FEWEST).then(|| 100.0 * correlation(&sides).max(0.0)),
        worst,
        pairs,
    })
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME_DEG
}

/// Mean vibration of the runs along an angle at a speed. Both ways along it count.
fn mean(runs: &[Run], angle: f64, speed: f64) -> Option<f64> {
    let is_here = |run: &&Run| run.speed_mm_s == speed && is_same(run.angle_deg.rem_euclid(180.0), angle);
    let all: Vec<f64> = runs.iter().filter(is_here).map(|run| run.vibration_mm_s2).collect();
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}
