//! The surface: how high the bed is over z = 0, place by place.

use core::f64::consts::TAU;
use corehbot::settings::Settings;
use corehbot::units::Mm;

/// A plane, a bowl and a wave, which add up. Lengths are mm. The bed's centre is that of the machine's `[bed]`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Surface {
    /// Height of the plane at the bed's centre.
    pub height: f64,
    /// Slope of the plane in x and y, mm a mm.
    pub tilt: [f64; 2],
    /// Height of the bowl at the middle of each side of the bed over its centre; below 0 it is a dome.
    pub bowl: f64,
    /// Amplitude of the wave along x.
    pub wave: f64,
    /// Length of the wave, above 0.
    pub wave_length: f64,
    /// The bed's centre in x and y, and half its width and depth.
    centre: [f64; 2],
    half: [f64; 2],
}

impl Surface {
    /// The flat bed of these settings.
    #[must_use]
    pub fn flat(settings: &Settings) -> Self {
        let bed = settings.bed;
        let half = [bed.width, bed.depth].map(|mm| mm.to_num::<f64>().max(1.0) / 2.0);
        let [left, front] = [bed.left, bed.front].map(Mm::to_num::<f64>);
        let centre = [left + half[0], front + half[1]];
        Self { height: 0.0, tilt: [0.0; 2], bowl: 0.0, wave: 0.0, wave_length: 2.0 * half[0], centre, half }
    }

    /// The bed's centre in x and y.
    #[must_use]
    pub const fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Its height there. The same bits on every processor: sums, products, and a function of libm.
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let (dx, dy) = (x - self.centre[0], y - self.centre[1]);
        let plane = self.height + self.tilt[0] * dx + self.tilt[1] * dy;
        let (u, v) = (dx / self.half[0], dy / self.half[1]);
        let wave = if self.wave == 0.0 { 0.0 } else { self.wave * libm::cos(TAU * dx / self.wave_length) };
        plane + self.bowl * (u * u + v * v) + wave
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_bowl_and_wave_add_up() {
        let flat = Surface::flat(&Settings::prototype());
        let [x, y] = flat.centre();
        assert_eq!((flat.at([x, y]), flat.at([0.0, 0.0])), (0.0, 0.0));
        let [hx, hy] = flat.half;
        let bed = Surface { height: 0.5, tilt: [0.001, -0.002], bowl: 0.2, wave: 0.05, wave_length: 2.0 * hx, ..flat };
        assert!((bed.at([x, y]) - 0.55).abs() < 1e-12);
        // At the right side the wave is in its trough.
        assert!((bed.at([x + hx, y]) - (0.5 + 0.001 * hx + 0.2 - 0.05)).abs() < 1e-12);
        assert!((bed.at([x, y - hy]) - (0.55 + 0.002 * hy + 0.2)).abs() < 1e-12);
    }
}
