//! Figure 4: the error at the corners over the speed, by both models.

use super::super::fit::{Line, line};
use super::super::{Case, Error, Parameters, run_on};
use super::{ABOUT_CLAIMS, Errors, FAST, MODELS, SPEEDS, WAYS};
use crate::queries::claim::{Claim, write_claims};
use serde::Serialize;
use std::fmt;

/// Speeds of the curves, m/s: those of figure 3, one below and five between.
const ALONG: [f64; 9] = [0.010, SPEEDS[0], 0.030, SPEEDS[1], 0.046, 0.053, 0.060, 0.070, FAST];

/// A line explains so much of the variance that its points count as linear.
const LINEAR: f64 = 0.99;

/// Errors over the speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure4 {
    /// One for each model and way round.
    pub trends: Vec<Trend>,
    /// What the text says.
    pub claims: Vec<Claim>,
}

/// Errors of a model over the speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trend {
    /// The model.
    pub model: &'static str,
    /// The way round.
    pub direction: &'static str,
    /// Speeds.
    pub speeds_m_s: Vec<f64>,
    /// Errors at these speeds.
    pub errors: Vec<Errors>,
    /// Least-squares lines of the turns from x to y and from y to x: mm over m/s.
    pub lines: [Line; 2],
}

impl Trend {
    /// Speed and error of a turn (0 from x to y, 1 from y to x).
    #[must_use]
    pub fn points(&self, turn: usize) -> Vec<(f64, f64)> {
        let error = |errors: &Errors| errors.both().get(turn).copied().unwrap_or(f64::NAN);
        self.speeds_m_s.iter().copied().zip(self.errors.iter().map(error)).collect()
    }

    /// Errors at the slowest and the fastest speed of figure 3.
    fn ends(&self, turn: usize) -> [f64; 2] {
        let points = self.points(turn);
        [SPEEDS[0], FAST].map(|speed| points.iter().find(|(at, _)| *at == speed).map_or(f64::NAN, |(_, e)| *e))
    }
}

impl Figure4 {
    /// The figure of a rig.
    ///
    /// # Errors
    /// As [`run_on`].
    pub fn new(rig: &Parameters, like: &Case) -> Result<Figure4, Error> {
        let mut trends = Vec::new();
        for (direction, way) in WAYS {
            for (model, name) in MODELS {
                let mut errors = Vec::new();
                for speed in ALONG {
                    errors.push(Errors::from(run_on(rig, &Case { speed, model, direction, ..*like })?));
                }
                let mut trend = Trend {
                    model: name,
                    direction: way,
                    speeds_m_s: ALONG.to_vec(),
                    errors,
                    lines: [Line { slope: 0.0, intercept: 0.0, r_squared: 0.0 }; 2],
                };
                trend.lines = [0, 1].map(|turn| line(&trend.points(turn)));
                trends.push(trend);
            }
        }
        let claims = claims(&trends);
        Ok(Figure4 { trends, claims })
    }
}

/// All sentences are about the way of the paper, which stands first.
fn claims(trends: &[Trend]) -> Vec<Claim> {
    let [full, four, ..] = trends else { return Vec::new() };
    let fits = [full.lines, four.lines].into_iter().flatten();
    let worst = fits.map(|line| line.r_squared).fold(1.0, f64::min);
    let part = |turn: usize| [0, 1].map(|end| four.ends(turn)[end] / full.ends(turn)[end]);
    let missing = |turn: usize| [0, 1].map(|end| full.ends(turn)[end] - four.ends(turn)[end]);
    let parts = [part(0), part(1)];
    let of_full = |[slow, fast]: [f64; 2]| {
        format!("{slow:.3} of the full model's error at {} m/s, {fast:.3} at {FAST} m/s", SPEEDS[0])
    };
    let [slow, fast] = missing(1);
    let other: Vec<&Trend> = trends.iter().skip(2).collect();
    let ways = [full, four].into_iter().zip(other).flat_map(|(one, other)| {
        one.errors
            .iter()
            .zip(&other.errors)
            .flat_map(|(a, b)| a.both().into_iter().zip(b.both()).map(|(a, b): (f64, f64)| (a / b - 1.0).abs()))
    });
    let apart = 100.0 * ways.fold(0.0, f64::max);
    vec![
        Claim::new(
            "the errors are linear in the speed",
            worst >= LINEAR,
            format!("lines explain at least {:.3} % of the variance (R2)", 100.0 * worst),
        ),
        Claim::new(
            "the 4-DoF model predicts a smaller error from y to x",
            parts[1].iter().all(|p| *p < 1.0),
            of_full(parts[1]),
        ),
        Claim::new("... and from x to y", parts[0].iter().all(|p| *p < 1.0), of_full(parts[0])),
        Claim::new(
            "the 4-DoF model deviates more at high speed",
            fast.abs() > slow.abs(),
            format!("from y to x by {slow:.3} mm at {} m/s and {fast:.3} mm at {FAST} m/s", SPEEDS[0]),
        ),
        Claim::new(
            "(ours) the way round does not matter",
            apart <= 0.5,
            format!("errors clockwise and counter-clockwise are at most {apart:.2} % apart"),
        ),
    ]
}

impl fmt::Display for Figure4 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "figure 4: the contour error over the speed")?;
        writeln!(f, "{:17}  {:8}  {:7}  error in mm, v in m/s", "way round", "model", "turn")?;
        for trend in &self.trends {
            for (turn, Line { slope, intercept, r_squared }) in Errors::TURNS.into_iter().zip(&trend.lines) {
                let Trend { direction, model, .. } = trend;
                writeln!(f, "{direction:17}  {model:8}  {turn:7}  {slope:.3} v + {intercept:.4}, R2 {r_squared:.6}")?;
            }
        }
        writeln!(f, "{ABOUT_CLAIMS}")?;
        write_claims(f, &self.claims)
    }
}
