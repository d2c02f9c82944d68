//! Figure 3: the tool's path at three speeds, by both models.

use super::super::parameters::PULSE;
use super::super::path::SIDE;
use super::super::{Axis, Case, Command, Error, Model, Parameters, axes, run_on, trajectory};
use super::{ABOUT_CLAIMS, Errors, MODELS, SPEEDS, WAYS};
use crate::queries::claim::{Claim, write_claims};
use serde::Serialize;
use std::fmt;

/// Largest way off a side's line that counts as "nearly no deviation": a part of the error at the corner.
const NEARLY_NONE: f64 = 0.05;

/// The tool's paths.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure3 {
    /// Side of the square, assumed.
    pub side_mm: f64,
    /// One for each speed and way round.
    pub panels: Vec<Panel>,
    /// What the text says.
    pub claims: Vec<Claim>,
}

/// Paths at a speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Speed along the square.
    pub speed_m_s: f64,
    /// The way round.
    pub direction: &'static str,
    /// The path of each model.
    pub paths: Vec<Path>,
}

/// The path of a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Path {
    /// The model.
    pub model: &'static str,
    /// Its errors at the corners.
    #[serde(flatten)]
    pub errors: Errors,
    /// Greatest way off the line in the middle half of the sides, mm.
    pub off_sides_mm: f64,
    /// The tool's places, mm.
    #[serde(skip)]
    pub places: Vec<[f64; 2]>,
}

impl Figure3 {
    /// The figure of a rig.
    ///
    /// # Errors
    /// As [`run_on`].
    pub fn new(rig: &Parameters, like: &Case) -> Result<Figure3, Error> {
        let mut panels = Vec::new();
        for (direction, name) in WAYS {
            for speed in SPEEDS {
                let mut paths = Vec::new();
                for (model, name) in MODELS {
                    let case = Case { speed, model, direction, ..*like };
                    let places = trajectory(rig, &case)?;
                    let errors = Errors::from(run_on(rig, &case)?);
                    paths.push(Path { model: name, errors, off_sides_mm: off_sides(&places), places });
                }
                panels.push(Panel { speed_m_s: speed, direction: name, paths });
            }
        }
        let claims = claims(rig, like, &panels)?;
        Ok(Figure3 { side_mm: 1e3 * SIDE, panels, claims })
    }
}

/// Greatest distance from the line in the middle half of the sides, mm.
fn off_sides(places: &[[f64; 2]]) -> f64 {
    let side = 1e3 * SIDE;
    let is_middle = |v: f64| (0.25 * side..=0.75 * side).contains(&v);
    let from_line = |v: f64| v.abs().min((v - side).abs());
    let off = |[x, y]: &[f64; 2]| match (is_middle(*x), is_middle(*y)) {
        (true, false) => from_line(*y),
        (false, true) => from_line(*x),
        _ => 0.0,
    };
    places.iter().map(off).fold(0.0, f64::max)
}

fn claims(rig: &Parameters, like: &Case, panels: &[Panel]) -> Result<Vec<Claim>, Error> {
    // Where the tool does not cut a corner, ratios of errors say nothing.
    let cuts =
        panels.iter().filter_map(|panel| panel.paths.first()).all(|path| path.errors.both().iter().all(|e| *e > 0.0));
    let full = || panels.iter().filter_map(|panel| panel.paths.first().map(|path| (panel, path)));
    let straight = full().map(|(_, path)| path.off_sides_mm / path.errors.x_to_y_mm).fold(0.0, f64::max);
    let ratios = full().map(|(_, path)| path.errors.x_to_y_mm / path.errors.y_to_x_mm);
    let [least, most] = ratios.fold([f64::INFINITY, 0.0], |[l, m], r: f64| [l.min(r), m.max(r)]);
    let [x, y] = axes(Model::Full, &rig.scaled(like.friction, like.stiffness, like.mass));
    let [settle_x, settle_y] = [x, y].map(|axis: Axis| axis.settling_time());
    let growing: Vec<f64> =
        full().filter(|(panel, _)| panel.direction == WAYS[0].1).map(|(_, path)| path.errors.x_to_y_mm).collect();
    let slow = PULSE / settle_x.max(settle_y);
    let mut claims = vec![
        Claim::new(
            "nearly no deviation along a straight line",
            cuts && straight <= NEARLY_NONE,
            format!(
                "in the middle half of sides of 20 mm (assumed) up to {:.1} % of the error at the corner",
                100.0 * straight
            ),
        ),
        Claim::new(
            "the error is larger from x to y than from y to x",
            cuts && least > 1.0,
            format!("{least:.2} to {most:.2} times"),
        ),
        Claim::new(
            "x has the larger settling time (5 %)",
            settle_x > settle_y,
            format!("x {:.1} ms, y {:.1} ms", 1e3 * settle_x, 1e3 * settle_y),
        ),
        Claim::new(
            "the tool turns before the corner, and more so at higher speed",
            growing.windows(2).all(|pair| pair[1] > pair[0]) && growing.iter().all(|error| *error > 0.0),
            format!("x to y: {} mm", growing.iter().map(|e| format!("{e:.3}")).collect::<Vec<_>>().join(", ")),
        ),
    ];
    // Slower speeds than the legal ones are not played.
    if super::super::SPEEDS.contains(&slow) {
        let slowly = run_on(rig, &Case { speed: slow, command: Command::Pulses, direction: WAYS[0].0, ..*like })?;
        let left = slowly.x_to_y_mm.abs().max(slowly.y_to_x_mm.abs());
        let fast = growing.last().copied().unwrap_or(f64::NAN);
        claims.push(Claim::new(
            "no error where pulses are further apart than the settling time (within 5 %)",
            left <= 0.05 * fast,
            format!("at {:.2} mm/s {left:.3} mm are left, {:.0} % of the largest", 1e3 * slow, 100.0 * left / fast),
        ));
    }
    Ok(claims)
}

impl fmt::Display for Figure3 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "figure 3: a square of {} mm (assumed)", self.side_mm)?;
        writeln!(f, "{:17}  {:>5}  {:8}  {:>9}  {:>9}", "way round", "m/s", "model", "x to y mm", "y to x mm")?;
        for Panel { speed_m_s, direction, paths } in &self.panels {
            for Path { model, errors, .. } in paths {
                let [one, two] = errors.both();
                writeln!(f, "{direction:17}  {speed_m_s:5.3}  {model:8}  {one:9.4}  {two:9.4}")?;
            }
        }
        writeln!(f, "{ABOUT_CLAIMS}")?;
        write_claims(f, &self.claims)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::NOMINAL;
    use super::*;

    /// A tool that overshoots twice as far from x to y as from y to x does not cut corners more there.
    #[test]
    fn claims_about_errors_need_errors() {
        let held = |sign: f64| {
            let errors = Errors { x_to_y_mm: 0.2 * sign, y_to_x_mm: 0.1 * sign };
            let path = Path { model: MODELS[0].1, errors, off_sides_mm: 0.001, places: Vec::new() };
            let panel = Panel { speed_m_s: SPEEDS[0], direction: WAYS[0].1, paths: vec![path] };
            let claims = claims(&NOMINAL, &Case::at(SPEEDS[0]), &[panel]).unwrap();
            claims.iter().take(2).map(|claim| claim.holds).collect::<Vec<_>>()
        };
        assert_eq!((held(1.0), held(-1.0)), (vec![true; 2], vec![false; 2]));
    }
}
