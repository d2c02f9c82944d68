//! The rule that no step of a homed axis leads beyond its ends ([`reach`](crate::reach)), looked at in each turn.

use super::World;
use crate::reach::Beyond;
use corehbot::motion::SurfaceFrame;
use corehbot::surface::{Heights, UNITS_PER_MM};

/// The greatest height or depth of a surface that z follows, in mm.
fn greatest_height(surface: Option<(&SurfaceFrame, &Heights)>) -> f64 {
    let Some((_, heights)) = surface.filter(|(frame, _)| !frame.is_none()) else { return 0.0 };
    let each = (0..heights.rows()).flat_map(|row| (0..heights.columns()).map(move |column| heights.get(column, row)));
    // A smooth surface goes beyond its points by a quarter at most.
    1.25 * each.map(|height| f64::from(height).abs()).fold(0.0, f64::max) / f64::from(UNITS_PER_MM)
}

impl World<'_> {
    /// Holds the place of the tool to the ends of its axes.
    pub(super) fn hold_to_reach(&mut self) {
        if self.status.is_free() {
            self.reach.end();
        }
        if self.turned.coupling != self.tool {
            return;
        }
        let (made, origin) = (self.counts.read(), self.generator.origin());
        let groups = std::array::from_fn(|group| made[group].wrapping_add(origin[group]));
        let counts = self.tool.motor_counts(groups).map(i64::from);
        let (generator, shifts) = (&self.generator, &self.z_shifts);
        let offset = || greatest_height(generator.surface()) + shifts.way() * self.step_of_z;
        let (known, watched) = (self.status.known(), self.generator.watched());
        let beyond = self.reach.look(self.stepper.tick(), known, watched, &counts, offset);
        if self.is_strict {
            assert_eq!(beyond.map(|beyond| beyond.to_string()), None);
        }
    }

    /// The first homed axis that went beyond its end.
    #[must_use]
    pub const fn beyond(&self) -> Option<Beyond> {
        self.reach.found()
    }
}
