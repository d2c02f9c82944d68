//! Limits of the live offset of z: half of the axis's own, so that a move may use the other half at the same time.

use super::moves::Move;
use super::number::{acceleration, mm, speed, to_f32};
use crate::settings::AxisSettings;
use crate::units::{Steps, TICKS_PER_SECOND};

/// The fastest change of z that an offset may make, and the fastest that a move may make meanwhile.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ZLimits {
    /// In steps a tick.
    pub speed: f32,
    /// In steps a tick squared.
    pub acceleration: f32,
}

impl ZLimits {
    /// Half of the limits of z.
    #[must_use]
    pub fn half_of(z: &AxisSettings) -> Self {
        const TICK: f32 = 1.0 / TICKS_PER_SECOND as f32;
        let half_a_step: f32 = 0.5 * z.steps_per_mm.to_num::<f32>();
        Self {
            speed: speed(z.max_speed) * half_a_step * TICK,
            acceleration: acceleration(z.max_acceleration) * half_a_step * const { TICK * TICK },
        }
    }

    /// Whether a move by `way` along z may exceed them. Its greatest speed is at most twice its mean speed.
    pub(in crate::motion) fn may_be_exceeded_by(&self, m: &Move, way: Steps) -> bool {
        const TICK: f32 = 1.0 / TICKS_PER_SECOND as f32;
        if way == Steps::ZERO {
            return false;
        }
        let way = to_f32(way.wrapping_abs());
        let share = acceleration(m.acceleration) * const { TICK * TICK };
        // Cut off to 256 ticks: a move may last for minutes.
        let time = ((m.time().0 >> 24) as u32) as f32 * 256.0;
        2.0 * way > self.speed * time || way * share > self.acceleration * mm(m.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use crate::units::{Length, MmPerSec2, SubTicks};

    #[test]
    fn a_lift_is_fast_and_a_spiral_is_not() {
        let limits = ZLimits::half_of(&Settings::prototype().axes.z);
        // 10 mm/s and 100 mm/s2 at 800 steps/mm.
        assert!((limits.speed * 1e7 / 8000.0 - 1.0).abs() < 1e-6);
        assert!((limits.acceleration * 1e14 / 80_000.0 - 1.0).abs() < 1e-6);
        let lift = Move {
            length: Length(1 << 32),
            acceleration: MmPerSec2::from_num(200),
            accelerate: SubTicks::of_ticks(707_107),
            decelerate: SubTicks::of_ticks(707_107),
            ..Move::NONE
        };
        assert!(limits.may_be_exceeded_by(&lift, Steps::from_num(800)));
        assert!(limits.may_be_exceeded_by(&lift, Steps::from_num(-800)));
        // 0.2 mm up on a metre of path in ten seconds.
        let spiral = Move { length: Length(1000 << 32), cruise: SubTicks::of_ticks(100_000_000), ..lift };
        assert!(!limits.may_be_exceeded_by(&spiral, Steps::from_num(160)));
        assert!(!limits.may_be_exceeded_by(&lift, Steps::ZERO));
    }
}
