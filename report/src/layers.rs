//! Layers: to which height a printed line belongs, also where z rises all the time.

use corehbot_twin::math::hypot;

/// A line that rises while it is printed belongs to a layer of this height in um.
const RISING_LAYER: i64 = 200;

/// It still rises if its z has not made a step for so long, in mm.
const RISING: f64 = 20.0;

/// A steeper line is not a line of a print.
const STEEPEST: f64 = 1.0;

/// Follows the heights of printed lines.
pub(crate) struct Layers {
    /// The way printed since z has changed while printing, in mm.
    level: f64,
}

impl Layers {
    pub const NONE: Self = Self { level: f64::INFINITY };

    /// The height in um of the layer of a printed line of that way in x, y and z, in mm, that ends at a height of `z`
    /// mm. `None` if it stands: filament is pushed where the tool stands, too, which makes no layer.
    pub fn enter(&mut self, [x, y, up]: [f64; 3], z: f64) -> Option<i64> {
        let way = hypot(x, y);
        if way == 0.0 {
            return None;
        }
        let rise = up.abs();
        self.level = if rise > 0.0 && rise < STEEPEST * way { 0.0 } else { self.level + way };
        let z = (z * 1000.0).round() as i64;
        let band = z.div_euclid(RISING_LAYER) * RISING_LAYER + RISING_LAYER / 2;
        Some(if self.level > RISING { z } else { band })
    }
}
