//! A cell: the Catmull-Rom law between four points, from the heights of the 16 around them.
//!
//! With t from 0 to 1 along one axis, the weights of the four heights in a line are
//!
//! ```text
//! (-t + 2 t^2 - t^3) / 2,   (2 - 5 t^2 + 3 t^3) / 2,   (t + 4 t^2 - 3 t^3) / 2,   (-t^2 + t^3) / 2
//! ```
//!
//! Bounds come from the same surface in Bezier's form. There a surface lies between the least and the greatest of its
//! control points. Its derivatives lie between the differences of control points (G. Farin, "Curves and Surfaces for
//! CAGD", 1988, 4.3 and 15).

/// Height of a surface with its first and second derivatives.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Height {
    /// Height.
    pub z: f32,
    /// Slope along x.
    pub dx: f32,
    /// Slope along y.
    pub dy: f32,
    /// Change of the slope along x along x.
    pub dxx: f32,
    /// Change of the slope along x along y, and the other way round.
    pub dxy: f32,
    /// Change of the slope along y along y.
    pub dyy: f32,
}

impl Height {
    /// Flat, and at 0.
    pub const FLAT: Self = Self { z: 0.0, dx: 0.0, dy: 0.0, dxx: 0.0, dxy: 0.0, dyy: 0.0 };
}

/// Sizes that derivatives do not exceed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bounds {
    /// Of the slope along x.
    pub dx: f32,
    /// Of the slope along y.
    pub dy: f32,
    /// Of the second derivatives.
    pub dxx: f32,
    /// See [`Height::dxy`].
    pub dxy: f32,
    /// See [`Height::dyy`].
    pub dyy: f32,
}

/// The greater of two numbers; not `max`, for which the target has no instruction.
fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl Bounds {
    /// Of a plane surface.
    pub const FLAT: Self = Self { dx: 0.0, dy: 0.0, dxx: 0.0, dxy: 0.0, dyy: 0.0 };

    /// Of two surfaces.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        Self {
            dx: most(self.dx, other.dx),
            dy: most(self.dy, other.dy),
            dxx: most(self.dxx, other.dxx),
            dxy: most(self.dxy, other.dxy),
            dyy: most(self.dyy, other.dyy),
        }
    }
}

/// Heights around a cell: rows of columns, the cell between the second and the third.
pub(super) struct Cell(pub [[f32; 4]; 4]);

/// Weights of the four heights of a line.
#[inline(always)]
fn weights(t: f32) -> [f32; 4] {
    let [t2, t3] = [t * t, t * t * t];
    [0.5 * ((t2 + t2) - t - t3), 0.5 * (2.0 - 5.0 * t2 + 3.0 * t3), 0.5 * (t + 4.0 * t2 - 3.0 * t3), 0.5 * (t3 - t2)]
}

/// Their derivatives.
#[inline(always)]
fn first(t: f32) -> [f32; 4] {
    let t2 = t * t;
    [
        0.5 * (4.0 * t - 1.0 - 3.0 * t2),
        0.5 * (9.0 * t2 - 10.0 * t),
        0.5 * (1.0 + 8.0 * t - 9.0 * t2),
        0.5 * (3.0 * t2 - (t + t)),
    ]
}

/// Their second derivatives.
fn second(t: f32) -> [f32; 4] {
    [2.0 - 3.0 * t, 9.0 * t - 5.0, 4.0 - 9.0 * t, 3.0 * t - 1.0]
}

/// Sum of values with their weights.
fn sum([a, b, c, d]: &[f32; 4], [p, q, r, s]: &[f32; 4]) -> f32 {
    a * p + b * q + (c * r + d * s)
}

/// Heights of a line as Bezier's control points.
#[inline(always)]
fn control([a, b, c, d]: [&mut f32; 4]) {
    // The law's slope at b is half of c - a, and Bezier's next point lies a third of a cell along it.
    let (before, after) = (*c - *a, *d - *b);
    (*a, *d) = (*b, *c);
    *b += before * const { 1.0 / 6.0 };
    *c -= after * const { 1.0 / 6.0 };
}

/// The greatest change from one value to the next, and the greatest change of a change.
#[inline(always)]
fn changes([a, b, c, d]: [f32; 4]) -> (f32, f32) {
    let (p, q, r) = (b - a, c - b, d - c);
    (most(most(p.abs(), q.abs()), r.abs()), most((q - p).abs(), (r - q).abs()))
}

impl Cell {
    /// Height and slopes.
    pub fn slopes_at(&self, u: f32, v: f32) -> [f32; 3] {
        let (wu, du, wv, dv) = (weights(u), first(u), weights(v), first(v));
        let Self([a, b, c, d]) = self;
        let values = [sum(&wu, a), sum(&wu, b), sum(&wu, c), sum(&wu, d)];
        let slopes = [sum(&du, a), sum(&du, b), sum(&du, c), sum(&du, d)];
        [sum(&wv, &values), sum(&wv, &slopes), sum(&dv, &values)]
    }

    /// Height with all derivatives.
    pub fn at(&self, u: f32, v: f32) -> Height {
        let [z, dx, dy] = self.slopes_at(u, v);
        let along = |weights: [f32; 4]| self.0.map(|row| sum(&weights, &row));
        let (values, slopes) = (along(weights(u)), along(first(u)));
        Height {
            z,
            dx,
            dy,
            dxx: sum(&weights(v), &along(second(u))),
            dxy: sum(&first(v), &slopes),
            dyy: sum(&second(v), &values),
        }
    }

    /// Bounds within the cell. It moves no arrays: optimisation for the least size copies each by a call.
    pub fn bounds(self) -> Bounds {
        let Self(mut net) = self;
        for [a, b, c, d] in &mut net {
            control([a, b, c, d]);
        }
        let [first, second, third, fourth] = &mut net;
        for i in 0..4 {
            control([&mut first[i], &mut second[i], &mut third[i], &mut fourth[i]]);
        }
        let mut bounds = Bounds::FLAT;
        for (i, row) in net.iter().enumerate() {
            let (dx, dxx) = changes(*row);
            let (dy, dyy) = changes([net[0][i], net[1][i], net[2][i], net[3][i]]);
            // A cubic's slope is three times a difference of its control points, its curvature six times one of two
            // differences.
            bounds.dx = most(bounds.dx, 3.0 * dx);
            bounds.dy = most(bounds.dy, 3.0 * dy);
            bounds.dxx = most(bounds.dxx, 6.0 * dxx);
            bounds.dyy = most(bounds.dyy, 6.0 * dyy);
        }
        for j in 0..3 {
            let (from, to) = (&net[j], &net[j + 1]);
            let (dxy, _) = changes([to[0] - from[0], to[1] - from[1], to[2] - from[2], to[3] - from[3]]);
            // Three along each axis.
            bounds.dxy = most(bounds.dxy, 9.0 * dxy);
        }
        bounds
    }
}
