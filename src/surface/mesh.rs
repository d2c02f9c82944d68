//! A mesh: heights with their place on the bed.

use super::cell::{Bounds, Height};
use super::heights::{Heights, OVERSHOOT, UNITS_PER_MM};
use crate::units::Mm;
use core::fmt;

/// The fade height is at least this many times the largest deviation without a warning: layers are then right to a
/// tenth.
const LEAST_FADE: f32 = 10.0;

/// The shape of a bed: heights relative to the place where z is 0.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Mesh {
    heights: Heights,
    first: [Mm; 2],
    last: [Mm; 2],
    fade: Mm,
}

/// Why something is no mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshError {
    /// It has no points.
    NoPoints,
    /// Its last column is not right of its first one, or its last row not behind its first one.
    NoArea,
    /// The fade height is not above the deviations: z would not rise with the layers.
    FadesTooFast,
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPoints => put!(f, "the mesh has no points"),
            Self::NoArea => put!(f, "the mesh has no area"),
            Self::FadesTooFast => put!(f, "the fade height is less than twice the largest deviation of the mesh"),
        }
    }
}

impl core::error::Error for MeshError {}

/// A length in mm. `to_num` gives the same and is called as a function, as it treats every format.
fn in_f32(length: Mm) -> f32 {
    length.to_bits() as f32 * const { 1.0 / 4_294_967_296.0 }
}

impl Bounds {
    /// Bounds in units and cells as bounds in mm, with so many [cells a millimetre](Mesh::cells_per_mm).
    #[must_use]
    pub fn in_mm(&self, [per_x, per_y]: [f32; 2]) -> Self {
        let unit = const { 1.0 / UNITS_PER_MM as f32 };
        Self {
            dx: self.dx * unit * per_x,
            dy: self.dy * unit * per_y,
            dxx: self.dxx * unit * per_x * per_x,
            dxy: self.dxy * unit * per_x * per_y,
            dyy: self.dyy * unit * per_y * per_y,
        }
    }
}

impl Mesh {
    /// Heights from the first column and row to the last ones. They fade up to z = `fade`, 0 for no fade.
    ///
    /// # Errors
    ///
    /// See [`MeshError`].
    pub fn new(heights: Heights, first: [Mm; 2], last: [Mm; 2], fade: Mm) -> Result<Self, MeshError> {
        let ([x, y], [to_x, to_y]) = (first, last);
        // A distance of a millimetre or more, so that one over it is a number.
        let is_apart = |from: Mm, to: Mm| to.saturating_sub(from) >= Mm::ONE;
        let mesh = Self { heights, first, last, fade };
        if heights.is_none() {
            Err(MeshError::NoPoints)
        } else if !(is_apart(x, to_x) && is_apart(y, to_y)) {
            Err(MeshError::NoArea)
        } else if fade < Mm::ZERO || (fade > Mm::ZERO && mesh.fades_within(2.0)) {
            Err(MeshError::FadesTooFast)
        } else {
            Ok(mesh)
        }
    }

    /// The same heights at places that are elsewhere by so much.
    #[must_use]
    pub fn moved(&self, by: [Mm; 2]) -> Self {
        let to = |place: [Mm; 2]| core::array::from_fn(|axis| place[axis].saturating_add(by[axis]));
        Self { first: to(self.first), last: to(self.last), ..*self }
    }

    /// Whether the fade height is less than so many largest deviations.
    fn fades_within(&self, times: f32) -> bool {
        self.fade.to_num::<f32>() < times * self.deviation()
    }

    /// The heights.
    #[must_use]
    pub const fn heights(&self) -> &Heights {
        &self.heights
    }

    /// Place of the first column and row.
    #[must_use]
    pub const fn first(&self) -> [Mm; 2] {
        self.first
    }

    /// Place of the last column and row.
    #[must_use]
    pub const fn last(&self) -> [Mm; 2] {
        self.last
    }

    /// The height up to which it fades; 0 if it does not.
    #[must_use]
    pub const fn fade(&self) -> Mm {
        self.fade
    }

    /// Its mean height in mm, to which it fades.
    #[must_use]
    pub fn mean(&self) -> f32 {
        self.heights.mean() * const { 1.0 / UNITS_PER_MM as f32 }
    }

    /// Its largest deviation from the mean in mm.
    #[must_use]
    pub fn deviation(&self) -> f32 {
        self.heights.deviation() * const { 1.0 / UNITS_PER_MM as f32 }
    }

    /// By how much the highest real z may lie above z: where it fades the mean alone counts at the top of the machine.
    #[must_use]
    pub fn above_top(&self) -> Mm {
        let mean = self.heights.mean() as i32;
        let highest = if self.fade > Mm::ZERO { mean } else { self.highest() };
        Mm::const_from_int(highest.max(0).into()) / i64::from(UNITS_PER_MM)
    }

    /// A height that the surface does not exceed: between points it may be higher than they are. The weights of heights
    /// below 0 add up to half of what [`OVERSHOOT`] is above 1.
    fn highest(&self) -> i32 {
        const SHARE: i32 = ((OVERSHOOT - 1.0) / 2.0 * 32.0) as i32;
        let first = self.heights.get(0, 0);
        let (mut least, mut most) = (first, first);
        for point in self.heights.points() {
            (least, most) = (least.min(point), most.max(point));
        }
        let (least, most) = (i32::from(least), i32::from(most));
        most + ((most - least) * SHARE + 31) / 32
    }

    /// Whether it fades so fast that layers are wrong by more than a tenth.
    #[must_use]
    pub fn has_short_fade(&self) -> bool {
        self.fade > Mm::ZERO && self.fades_within(LEAST_FADE)
    }

    /// Cells a millimetre along x and y.
    #[must_use]
    pub fn cells_per_mm(&self) -> [f32; 2] {
        let ([x, y], [to_x, to_y]) = (self.first, self.last);
        let rate = |cells: usize, from: Mm, to: Mm| cells.saturating_sub(1) as f32 / in_f32(to - from);
        [rate(self.heights.columns(), x, to_x), rate(self.heights.rows(), y, to_y)]
    }

    /// Height at a place, without fade, in mm and mm a mm.
    #[must_use]
    pub fn at(&self, x: Mm, y: Mm) -> Height {
        let ([first_x, first_y], [per_x, per_y]) = (self.first, self.cells_per_mm());
        let cells = |at: Mm, first: Mm, rate: f32| in_f32(at.saturating_sub(first)) * rate;
        let Height { z, dx, dy, dxx, dxy, dyy } = self.heights.at(cells(x, first_x, per_x), cells(y, first_y, per_y));
        // Sizes and derivatives have the same units.
        let Bounds { dx, dy, dxx, dxy, dyy } = Bounds { dx, dy, dxx, dxy, dyy }.in_mm([per_x, per_y]);
        Height { z: z * const { 1.0 / UNITS_PER_MM as f32 }, dx, dy, dxx, dxy, dyy }
    }
}
