//! Straight lines through points, and power laws.

use corehbot_twin::math::{ln, square};
use serde::Serialize;

/// y = slope x + intercept by least squares.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Units of y per unit of x.
    pub slope: f64,
    /// y at x = 0.
    pub intercept: f64,
    /// Part of the variance of y that the line explains, 0 to 1.
    pub r_squared: f64,
}

/// The least-squares line in y.
#[must_use]
pub fn line(points: &[(f64, f64)]) -> Line {
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let xx = mean(&|p| square(p.0 - x));
    let xy = mean(&|p| (p.0 - x) * (p.1 - y));
    let yy = mean(&|p| square(p.1 - y));
    let slope = xy / xx;
    Line { slope, intercept: y - slope * x, r_squared: xy * xy / (xx * yy) }
}

/// Exponent n of the best y = a x^n, by a line through the logarithms; all values must be positive.
#[must_use]
pub fn exponent(points: &[(f64, f64)]) -> f64 {
    let logarithms: Vec<_> = points.iter().map(|(x, y)| (ln(*x), ln(*y))).collect();
    line(&logarithms).slope
}
