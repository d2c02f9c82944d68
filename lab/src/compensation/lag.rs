//! Lag: how far motors must be ahead to put the tool at its intended place.
//!
//! The tool lags by `K^-1 (M a + c v + f sign v)`. K is its stiffness at the place with compliant fields. A rotor also
//! lags by its own inertia and friction over its field. For a mass on a spring this is the exact inverse of its motion,
//! so it also removes ringing, as far as the acceleration is known. The bar's yaw is not included
//! (docs/research/twin.md has the reason).

use super::path::RATE;
use corehbot_twin::dynamics::friction::CREEP;
use corehbot_twin::geometry::workspace;
use corehbot_twin::math::{exp, tanh};
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::solve::balance::condensed;
use std::collections::BTreeMap;

/// Places nearer than this in mm share one stiffness: it changes by 0.3 % over this distance.
const CELL_MM: f64 = 5.0;

/// Half the length of the Gaussian, in widths.
const WIDTHS: f64 = 4.0;

/// mm in an m.
const MM_PER_M: f64 = 1000.0;

/// The assumed machine.
#[derive(Clone, Copy, Debug)]
pub struct Lag<'p> {
    machine: Machine,
    params: &'p Params,
    start: Place,
}

/// The lead of the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead {
    /// Along x and y in mm, over time, including the rotors' own inertia.
    pub tool: Vec<[f64; 2]>,
    /// Its maximum, without the rotors' part.
    pub greatest_mm: [f64; 2],
}

impl<'p> Lag<'p> {
    /// Of a machine with its tool at `start` at first.
    #[must_use]
    pub const fn new(machine: Machine, params: &'p Params, start: Place) -> Self {
        Self { machine, params, start }
    }

    /// The lead for this motion of the tool ([`Path::tool`](super::path::Path::tool)). A Gaussian of this width smooths
    /// the path before its acceleration is taken.
    #[must_use]
    pub fn of(&self, tool: &[[f64; 2]], width_s: f64) -> Ahead {
        let p = self.params;
        let [gaussian, slope, curvature] = kernels(width_s);
        let [along_x, along_y, _] = self.machine.masses_kg(p);
        let masses = [along_x, along_y].map(|kg| kg / MM_PER_M);
        let guides = [p.guide_x_n_s_per_m, p.guide_y_n_s_per_m].map(|c| c / MM_PER_M);
        let dry = [p.dry_friction_x_n, p.dry_friction_y_n];
        let field = p.field_stiffness_n_per_mm(0);
        let mut compliances = BTreeMap::new();
        let mut added = Vec::with_capacity(tool.len());
        let mut greatest_mm = [0.0_f64; 2];
        for sample in 0..tool.len() {
            let [at, v, a] = [&gaussian, &slope, &curvature].map(|kernel| convolved(tool, sample, kernel));
            let place = Place::flat(self.start.x + at[0], self.start.y + at[1]);
            let cell = [place.x, place.y].map(|v| (v / CELL_MM).round() as i64);
            let [[xx, xy], [yx, yy]] = *compliances.entry(cell).or_insert_with(|| compliance(self.machine, p, cell));
            let force = [0, 1].map(|i| masses[i] * a[i] + guides[i] * v[i] + dry[i] * tanh(v[i] / CREEP));
            let ahead = [xx * force[0] + xy * force[1], yx * force[0] + yy * force[1]];
            greatest_mm = [greatest_mm[0].max(ahead[0].abs()), greatest_mm[1].max(ahead[1].abs())];
            let rotors = [0, 1].map(|i| p.rotor_mass_kg(0) / MM_PER_M * a[i] + p.rotor_damping_n_s_per_mm(0) * v[i]);
            added.push([0, 1].map(|i| ahead[i] + rotors[i] / field));
        }
        Ahead { tool: added, greatest_mm }
    }
}

/// Compliance of the tool in mm per newton, about the middle of a cell.
fn compliance(machine: Machine, params: &Params, cell: [i64; 2]) -> [[f64; 2]; 2] {
    let reach = workspace(machine, params);
    let [x, y] = cell.map(|v| v as f64 * CELL_MM);
    let at = reach.at(x.clamp(reach.x[0], reach.x[1]), y.clamp(reach.y[0], reach.y[1]));
    let freedom = Freedom { rotors: true, ..Freedom::default() };
    // x and y come first.
    let elastic = Elastic::new(machine, params, at, freedom);
    let inverse = condensed(&elastic, &[0, 1]).ok().and_then(|k| k.try_inverse());
    inverse.map_or([[0.0; 2]; 2], |c| [[c[(0, 0)], c[(0, 1)]], [c[(1, 0)], c[(1, 1)]]])
}

/// A Gaussian of this width and its first two derivatives, at [`RATE`].
fn kernels(width_s: f64) -> [Vec<f64>; 3] {
    let width = width_s * RATE;
    let half = (WIDTHS * width).ceil() as i64;
    let at = |i: i64| i as f64 / width;
    let plain: Vec<f64> = (-half..=half).map(|i| exp(-at(i) * at(i) / 2.0)).collect();
    let sum: f64 = plain.iter().sum();
    let with = |factor: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (-half..=half).zip(&plain).map(|(i, weight)| factor(at(i)) * weight / sum).collect()
    };
    let slope = with(&|u| u / width_s);
    let curvature = with(&|u| (u * u - 1.0) / (width_s * width_s));
    // After cutting and sampling it is corrected, so that a constant adds nothing and a parabola has its own
    // acceleration.
    let mean = curvature.iter().sum::<f64>();
    let curvature: Vec<f64> = curvature.iter().zip(&plain).map(|(at, weight)| at - mean * weight / sum).collect();
    let times = (-half..=half).map(|i| i as f64 / RATE);
    let parabola: f64 = curvature.iter().zip(times).map(|(at, t)| at * t * t / 2.0).sum();
    let curvature = curvature.into_iter().map(|at| at / parabola).collect();
    [plain.iter().map(|at| at / sum).collect(), slope, curvature]
}

/// A kernel over the samples about one; the ends continue as constants.
fn convolved(tool: &[[f64; 2]], sample: usize, kernel: &[f64]) -> [f64; 2] {
    let half = kernel.len() / 2;
    let mut sum = [0.0; 2];
    for (i, weight) in kernel.iter().enumerate() {
        let index = (sample + i).saturating_sub(half).min(tool.len() - 1);
        if let Some([x, y]) = tool.get(index) {
            sum[0] += weight * x;
            sum[1] += weight * y;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 3 + 2 t + t^2 / 2 at t = 0.02 the place is 3.0402, the speed 2.02, the acceleration 1.
    #[test]
    fn kernels_tell_place_speed_and_acceleration_of_a_parabola() {
        let place = |sample: usize| {
            let t = sample as f64 / RATE;
            [3.0 + 2.0 * t + t * t / 2.0, 0.0]
        };
        let tool: Vec<[f64; 2]> = (0..200).map(place).collect();
        for width_s in [0.0003, 0.001, 0.004] {
            let found = kernels(width_s).map(|kernel| convolved(&tool, 100, &kernel)[0]);
            // The Gaussian rounds the place by half the square of its width.
            let expected = [3.0402 + width_s * width_s / 2.0, 2.02, 1.0];
            for (found, (expected, part)) in found.into_iter().zip(expected.into_iter().zip([1e-6, 2e-3, 1e-6])) {
                assert!((found / expected - 1.0).abs() < part, "{width_s}: {found} {expected}");
            }
        }
    }
}
