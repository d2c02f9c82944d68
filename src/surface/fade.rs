//! Fade: as z rises, layers become flat, so that the top of a print does not have the shape of the bed.
//!
//! At z = 0 and below the whole surface counts, at the fade height and above its mean alone. In between the share of
//! the deviation d from the mean m falls evenly: `z' = z + m + (1 - z / H) d`. So a layer is never thicker or thinner
//! than by `d / H`. Marlin fades to 0 instead of the mean, by which a mesh that lies 2 mm low makes all layers 20 % too
//! thick.
//!
//! All values have one unit, which may be millimetres or steps.

/// A fade: its height, and one over it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Fade {
    height: f32,
    rate: f32,
}

impl Fade {
    /// The whole surface counts everywhere.
    pub const NONE: Self = Self { height: 0.0, rate: 0.0 };

    /// Up to a height; 0 is no fade.
    #[must_use]
    pub fn up_to(height: f32) -> Self {
        if height > 0.0 { Self { height, rate: 1.0 / height } } else { Self::NONE }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.rate <= 0.0
    }

    /// The height up to which it reaches.
    #[must_use]
    pub const fn height(&self) -> f32 {
        self.height
    }

    /// The share of the deviation that counts at a height, and the change of this share with z.
    #[must_use]
    pub fn share(&self, z: f32) -> [f32; 2] {
        if self.is_none() || z <= 0.0 {
            [1.0, 0.0]
        } else if z >= self.height {
            [0.0, 0.0]
        } else {
            [1.0 - z * self.rate, -self.rate]
        }
    }

    /// The inverse: how far z itself lies above `whole`, given the real height less the whole surface (`whole`), and
    /// the deviation of the surface there.
    #[must_use]
    pub fn above(&self, whole: f32, deviation: f32) -> f32 {
        if self.is_none() || whole <= 0.0 {
            return 0.0;
        }
        // Above the fade height the deviation does not count, so all of it was taken off in vain.
        if whole + deviation >= self.height {
            return deviation;
        }
        let part = deviation * self.rate;
        whole * part / (1.0 - part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p10_the_share_falls_evenly_to_the_fade_height_and_has_an_exact_inverse() {
        let fade = Fade::up_to(10.0);
        let raised = |z: f32, d: f32| z + d * fade.share(z)[0];
        let table = [(0.0, 0.3), (0.2, 0.494), (1.0, 1.27), (5.0, 5.15), (9.9, 9.903), (10.0, 10.0), (12.0, 12.0)];
        for (z, expected) in table {
            assert!((raised(z, 0.3) - expected).abs() < 1e-6, "{z}: {}", raised(z, 0.3));
        }
        for d in [-0.9, -0.3, 0.0, 0.3, 0.9] {
            for tenths in -30..150 {
                let z = tenths as f32 * 0.1;
                let whole = raised(z, d) - d;
                assert!((whole + fade.above(whole, d) - z).abs() < 3e-6, "{z} {d}");
            }
        }
        assert_eq!(Fade::NONE.share(7.0), [1.0, 0.0]);
        assert_eq!(Fade::NONE.above(7.0, 0.3), 0.0);
    }
}
