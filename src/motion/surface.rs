//! The surface in steps: how much of the bed's shape z gets at a place. The Console and the generator compute it with
//! the same code, so they agree to the bit.
//!
//! Planner and trajectory count z from the surface: z = 0 is the surface, wherever the tool is. The motors count real
//! z. With the height S, its mean m and the share f of the [`fade`](crate::surface::Fade), real z is
//! `z + m + f (S - m)`.

use super::number::{from_f32, to_f32};
use crate::surface::{Fade, Heights, Mesh, OVERSHOOT, UNITS_PER_MM};
use crate::units::{Steps, StepsPerMm};

/// Where the heights of a surface lie, in steps.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SurfaceFrame {
    columns: u8,
    rows: u8,
    /// Place of the first column and row.
    first: [Steps; 2],
    /// Cells a step of x, and of y.
    rate: [f32; 2],
    /// Steps of z a unit of height.
    unit: f32,
    /// The mean height, in steps of z.
    mean: f32,
    /// The largest distance of the surface from it.
    deviation: f32,
    fade: Fade,
}

/// Place and speed of an axis: steps, and steps a tick.
pub(in crate::motion) type Moving = (Steps, f32);

impl SurfaceFrame {
    /// No surface.
    pub const NONE: Self = Self {
        columns: 0,
        rows: 0,
        first: [Steps::ZERO; 2],
        rate: [0.0; 2],
        unit: 0.0,
        mean: 0.0,
        deviation: 0.0,
        fade: Fade::NONE,
    };

    /// The frame of a mesh for axes with these resolutions.
    #[must_use]
    pub fn new(mesh: &Mesh, [x, y, z]: [StepsPerMm; 3]) -> Self {
        let ([first_x, first_y], [per_x, per_y]) = (mesh.first(), mesh.cells_per_mm());
        let per_mm = |resolution: StepsPerMm| -> f32 { resolution.max(StepsPerMm::ONE).to_num() };
        let unit = per_mm(z) * const { 1.0 / UNITS_PER_MM as f32 };
        let heights = mesh.heights();
        Self {
            columns: heights.columns() as u8,
            rows: heights.rows() as u8,
            first: [first_x * x, first_y * y],
            rate: [per_x / per_mm(x), per_y / per_mm(y)],
            unit,
            mean: heights.mean() * unit,
            deviation: heights.deviation() * (OVERSHOOT * unit),
            fade: Fade::up_to(mesh.fade().to_num::<f32>() * per_mm(z)),
        }
    }

    /// Whether there is no surface.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.columns == 0
    }

    /// Its points, all at 0.
    #[must_use]
    pub fn flat(&self) -> Heights {
        Heights::flat(self.columns.into(), self.rows.into()).unwrap_or(Heights::NONE)
    }

    /// Places of the first column and row, and of the last ones, in steps of x and y.
    #[must_use]
    pub fn corners(&self) -> [[f32; 2]; 2] {
        let ([x, y], [rate_x, rate_y]) = (self.first.map(to_f32), self.rate);
        let cells = |points: u8| f32::from(points.saturating_sub(1));
        [[x, y], [x + cells(self.columns) / rate_x, y + cells(self.rows) / rate_y]]
    }

    /// The height up to which it fades, in steps of z; 0 if it does not.
    #[must_use]
    pub const fn fade_height(&self) -> f32 {
        self.fade.height()
    }

    /// Place on the grid.
    pub(in crate::motion) fn place(&self, x: Steps, y: Steps) -> [f32; 2] {
        let ([first_x, first_y], [rate_x, rate_y]) = (self.first, self.rate);
        [to_f32(x.wrapping_sub(first_x)) * rate_x, to_f32(y.wrapping_sub(first_y)) * rate_y]
    }

    /// Real z and its speed where the axes are so.
    pub(in crate::motion) fn raised(&self, heights: &Heights, [x, y, z]: &[Moving; 3]) -> Moving {
        let [u, v] = self.place(x.0, y.0);
        let [height, du, dv] = heights.slopes_at(u, v);
        let [rate_x, rate_y] = self.rate;
        let climb = ((du * rate_x) * x.1 + (dv * rate_y) * y.1) * self.unit;
        if self.fade.is_none() {
            return (z.0.wrapping_add(from_f32(height * self.unit)), z.1 + climb);
        }
        let deviation = height * self.unit - self.mean;
        let [share, change] = self.fade.share(to_f32(z.0));
        let position = z.0.wrapping_add(from_f32(self.mean + share * deviation));
        // By the rule of products: the deviation changes as the tool goes, and its share as z goes.
        (position, z.1 + share * climb + (change * deviation) * z.1)
    }

    /// The share of the deviations that counts at a height of z in steps, and the most by which another step of z
    /// changes them, in steps.
    pub(in crate::motion) fn fade_from(&self, z: Steps) -> [f32; 2] {
        let [share, _] = self.fade.share(to_f32(z));
        let is_within = share > 0.0 && !self.fade.is_none();
        [share, if is_within { self.deviation / self.fade.height() } else { 0.0 }]
    }

    /// The real position of motors for a position of the planner.
    #[must_use]
    pub fn to_real(&self, heights: &Heights, position: [Steps; 4]) -> [Steps; 4] {
        if self.is_none() {
            return position;
        }
        let [x, y, z, e] = position;
        let (z, _) = self.raised(heights, &[(x, 0.0), (y, 0.0), (z, 0.0)]);
        [x, y, z, e]
    }

    /// The position of the planner for a real one: the inverse.
    #[must_use]
    pub fn to_planned(&self, heights: &Heights, position: [Steps; 4]) -> [Steps; 4] {
        if self.is_none() {
            return position;
        }
        let [x, y, z, e] = position;
        let [u, v] = self.place(x, y);
        let [height, ..] = heights.slopes_at(u, v);
        let surface = height * self.unit;
        let whole = z.wrapping_sub(from_f32(surface));
        let above = self.fade.above(to_f32(whole), surface - self.mean);
        [x, y, whole.wrapping_add(from_f32(above)), e]
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::surface::MOST_POINTS;
    use crate::units::Mm;
    use std::vec::Vec;

    /// Heights up to 0.4 mm, from a seed.
    fn mesh(seed: u32, fade: f64) -> Mesh {
        let mut state = seed;
        let filled = Heights::filled(MOST_POINTS, MOST_POINTS, |_, _| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            Some(((state >> 16) % 1600) as i16 - 800)
        });
        let heights = filled.unwrap_or(Heights::NONE);
        let (first, last) = ([Mm::const_from_int(10); 2], [Mm::const_from_int(370); 2]);
        Mesh::new(heights, first, last, Mm::from_num(fade)).expect("a mesh")
    }

    #[test]
    fn the_planners_position_is_the_exact_inverse_of_the_real_one() {
        for (seed, fade, z_steps) in [(1, 0.0, 800), (2, 10.0, 800), (3, 1.0, 400), (4, 10.0, 6400)] {
            let mesh = mesh(seed, fade);
            let resolutions = [80, 80, z_steps].map(StepsPerMm::from_num);
            let frame = SurfaceFrame::new(&mesh, resolutions);
            let places: Vec<f64> = (-3..40).map(|i| f64::from(i) * 10.37).collect();
            for (x, y) in places.iter().flat_map(|x| places.iter().map(move |y| (x, y))) {
                for z in [-1.0, 0.0, 0.01, 0.3, 0.99, 1.1, 5.0, 9.97, 10.2, 300.0] {
                    let real = [x * 80.0, y * 80.0, (z * f64::from(z_steps)).round(), 7.0].map(Steps::from_num);
                    let seen = frame.to_planned(mesh.heights(), real);
                    let back = frame.to_real(mesh.heights(), seen);
                    let error = back[2].wrapping_sub(real[2]).wrapping_abs();
                    // A motor's count is the nearest step.
                    assert!(error < Steps::lit("0.01"), "{x}, {y}, {z}: {error}");
                }
            }
        }
    }

    /// *Reproducer*: the deviation between points may be larger than at any of them, and z was faster than its limits
    /// by that while the mesh faded.
    #[test]
    fn while_it_fades_z_is_no_faster_than_the_planner_allows_for() {
        for seed in 1..6 {
            // A height that is a few times the largest deviation.
            let mesh = mesh(seed, 1.0);
            let frame = SurfaceFrame::new(&mesh, [80, 80, 800].map(StepsPerMm::from_num));
            let [_, fading] = frame.fade_from(Steps::from_num(80));
            let mut most = 0.0f32;
            for (i, j) in (0..=144).flat_map(|i| (0..=144).map(move |j| (i, j))) {
                let [x, y] = [i, j].map(|k| Steps::from_num(800 + k * 200));
                let at = [(x, 0.0), (y, 0.0), (Steps::from_num(400), 0.001)];
                let (_, speed) = frame.raised(mesh.heights(), &at);
                most = if speed > most { speed } else { most };
            }
            assert!(most <= 0.001 * (1.0 + fading) * 1.00001, "{seed}: {most} of 0.001, {fading}");
        }
    }

    #[test]
    fn speed_is_the_change_of_place() {
        let (mesh, dt) = (mesh(5, 10.0), 1000.0f32);
        let frame = SurfaceFrame::new(&mesh, [80, 80, 800].map(StepsPerMm::from_num));
        for z in [-100, 200, 4000, 9000] {
            for (vx, vy, vz) in [(0.002, 0.0, 0.0), (0.001, -0.002, 0.0), (0.0, 0.001, 0.001), (0.001, 0.001, -0.001)] {
                let at = |t: f32| {
                    let axis = |from: i32, v: f32| (Steps::from_num(from).wrapping_add(from_f32(v * t)), v);
                    frame.raised(mesh.heights(), &[axis(9000, vx), axis(12_000, vy), axis(z, vz)])
                };
                let (before, here, after) = (at(-dt), at(0.0), at(dt));
                let mean = to_f32(after.0.wrapping_sub(before.0)) / (2.0 * dt);
                assert!((here.1 - mean).abs() < 3e-7, "{z} {vx} {vy} {vz}: {} {mean}", here.1);
            }
        }
    }
}
