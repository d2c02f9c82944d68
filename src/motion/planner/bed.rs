//! The bed under the look-ahead: its mesh, and what the surface asks of z.
//!
//! A tool that moves at the speed v over the slope s moves z at s v. At the acceleration a z accelerates by
//! `s a + k v^2` with the curvature k along the path. The same holds for the change of direction at a corner. So a
//! move's limits count z's share with the greatest slope of the cells that it crosses. Z's acceleration is less by the
//! greatest curvature times the square of the greatest speed.

use crate::motion::number::{acceleration, root, speed};
use crate::motion::surface::SurfaceFrame;
use crate::settings::{Axes, Kept, Settings};
use crate::surface::{Bounds, Mesh};
use crate::units::Steps;

/// Distance around a move, in mm, in which the cells count: a shaper rounds corners. That is 300 mm/s for 13 ms, half
/// of a shaper of 40 Hz.
const MARGIN: f32 = 4.0;

/// The part of z's acceleration that is left for ramps.
const FOR_RAMPS: f32 = 0.5;

/// Demands of a surface on z along a move.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::motion) struct Demand {
    /// Ways of z for a mm of x, y and z, at most.
    pub share: [f32; 3],
    /// Change of slope a mm along the move, at most.
    pub bend: f32,
}

impl Demand {
    /// Without a surface.
    pub const FLAT: Self = Self { share: [0.0, 0.0, 1.0], bend: 0.0 };

    /// The way of z along a vector, at most.
    #[inline(always)]
    pub fn of_z(&self, [x, y, z]: [f32; 3]) -> f32 {
        let [of_x, of_y, of_z] = self.share;
        x.abs() * of_x + y.abs() * of_y + z.abs() * of_z
    }
}

/// A mesh, and whether z follows it.
pub(in crate::motion) struct Bed {
    mesh: Kept<Option<Mesh>>,
    frame: SurfaceFrame,
    /// Cells a millimetre along x and y.
    rate: [f32; 2],
    /// Bounds of the whole mesh, in mm.
    whole: Bounds,
}

impl Bed {
    /// Without a mesh.
    pub fn new() -> Self {
        Self { mesh: Kept::new(None), frame: SurfaceFrame::NONE, rate: [0.0; 2], whole: Bounds::FLAT }
    }

    /// The mesh, in use or not.
    pub fn mesh(&self) -> Option<&Mesh> {
        self.mesh.as_ref()
    }

    /// Has another mesh, or none, which is not in use.
    pub fn set(&mut self, mesh: Option<Mesh>) {
        self.frame = SurfaceFrame::NONE;
        *self.mesh = mesh;
        self.mesh.settle();
    }

    /// Uses it for these axes, or not.
    pub fn use_it(&mut self, is_in_use: bool, s: &Settings) {
        self.frame = frame(self.mesh().filter(|_| is_in_use), s);
        (self.rate, self.whole) = self.mesh().map_or(([0.0; 2], Bounds::FLAT), |mesh| {
            let (rate, last) = (mesh.cells_per_mm(), [mesh.heights().columns() as f32, mesh.heights().rows() as f32]);
            (rate, mesh.heights().bounds([0.0; 2], last).in_mm(rate))
        });
    }

    /// Whether z follows it.
    #[inline(always)]
    pub const fn is_in_use(&self) -> bool {
        !self.frame.is_none()
    }

    /// Its place in steps; none if it is not in use.
    pub const fn frame(&self) -> &SurfaceFrame {
        &self.frame
    }

    /// Whether mesh and frame are unchanged in memory.
    pub fn is_whole(&self, s: &Settings) -> bool {
        self.mesh.is_whole() && self.frame == frame(self.mesh().filter(|_| self.is_in_use()), s)
    }

    /// The motors' position for a position of the planner.
    pub fn to_real(&self, position: [Steps; 4]) -> [Steps; 4] {
        self.mesh().map_or(position, |mesh| self.frame.to_real(mesh.heights(), position))
    }

    /// The planner's position for a position of the motors.
    pub fn to_planned(&self, position: [Steps; 4]) -> [Steps; 4] {
        self.mesh().map_or(position, |mesh| self.frame.to_planned(mesh.heights(), position))
    }

    /// The demands along a move, which accelerates by `wanted_accel` at most. `turns_flat` says that the move before it
    /// is level, too.
    #[inline(never)]
    pub fn demand(
        &self,
        [from, to]: [&[Steps; 4]; 2],
        direction: [f32; 3],
        turns_flat: bool,
        wanted_accel: f32,
        s: &Settings,
    ) -> Demand {
        let Some(mesh) = self.mesh() else { return Demand::FLAT };
        let [along_x, along_y, up] = direction;
        let (along_x, along_y, up) = (along_x.abs(), along_y.abs(), up.abs());
        // Most beds are so flat that they slow no level move, if the move before it is level, too.
        if up == 0.0 && turns_flat && self.is_gentle(wanted_accel, s) {
            return Demand::FLAT;
        }
        let [from_x, from_y, from_z, _] = *from;
        let [to_x, to_y, to_z, _] = *to;
        let places = [self.frame.place(from_x, from_y), self.frame.place(to_x, to_y)];
        let [[u, v], [to_u, to_v]] = places;
        let [per_x, per_y] = self.rate;
        let (margin_u, margin_v) = (per_x * MARGIN, per_y * MARGIN);
        let ordered = |a: f32, b: f32| if a < b { [a, b] } else { [b, a] };
        let ([least_u, most_u], [least_v, most_v]) = (ordered(u, to_u), ordered(v, to_v));
        let cells =
            mesh.heights().bounds([least_u - margin_u, least_v - margin_v], [most_u + margin_u, most_v + margin_v]);
        let Bounds { dx, dy, dxx, dxy, dyy } = cells.in_mm(self.rate);
        // At its lower end, where the most of the surface counts.
        let [share, fading] = self.frame.fade_from(if from_z < to_z { from_z } else { to_z });
        let (x, y) = (share * dx, share * dy);
        // As z rises the slopes become less, which bends the way of z as well.
        let rate = if fading > 0.0 { 1.0 / mesh.fade().to_num::<f32>() } else { 0.0 };
        // The height is share(z) times h(x, y). Of its second derivative this is the mixed term, 2 share' h'.
        let twist = 2.0 * (rate * up) * (along_x * dx + along_y * dy);
        let bend = share * (dxx * along_x * along_x + 2.0 * (dxy * along_x * along_y) + dyy * along_y * along_y);
        Demand { share: [x, y, 1.0 + fading], bend: bend + twist }
    }

    /// Whether the surface is nowhere so steep or bent that a level move asks too much of z.
    fn is_gentle(&self, wanted_accel: f32, s: &Settings) -> bool {
        let Bounds { dx, dy, dxx, dxy, dyy } = self.whole;
        let (slope, bend) = (dx + dy, dxx + dxy + dxy + dyy);
        let most = speed(s.axes.x.max_speed) + speed(s.axes.y.max_speed);
        slope * most <= speed(s.axes.z.max_speed)
            && slope * wanted_accel + bend * most * most <= acceleration(s.axes.z.max_acceleration)
    }
}

/// The greatest speed at which z, which bears that acceleration, has enough left for ramps, at most `wanted`; and its
/// acceleration that is left then.
pub(in crate::motion) fn bent_limits(demand: &Demand, wanted: f32, accel: f32) -> [f32; 2] {
    if demand.bend <= 0.0 {
        return [wanted, accel];
    }
    let most = root((1.0 - FOR_RAMPS) * accel / demand.bend);
    let most = if wanted < most { wanted } else { most };
    [most, accel - demand.bend * (most * most)]
}

/// Where a mesh lies for the axes of the settings.
fn frame(mesh: Option<&Mesh>, s: &Settings) -> SurfaceFrame {
    let Axes { x, y, z, .. } = &s.axes;
    let resolutions = [x.steps_per_mm, y.steps_per_mm, z.steps_per_mm];
    mesh.map_or(SurfaceFrame::NONE, |mesh| SurfaceFrame::new(mesh, resolutions))
}
