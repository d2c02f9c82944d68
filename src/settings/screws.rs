//! Screws of z: where each of several z motors carries the bed or the gantry, and where the bed is probed for it (G34).

use super::ranges;
use super::rows::{Spec, rows};
use crate::kinematics::SCREWS;
use serde::{Deserialize, Serialize};

/// A place in whole mm: a screw's place may be wrong by 1 mm, which leaves less than a percent of a tilt in a round.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct WholePlace {
    /// Its x.
    pub x: i16,
    /// Its y.
    pub y: i16,
}

impl WholePlace {
    /// A place that nothing has said.
    pub const NOWHERE: Self = Self { x: ranges::NOWHERE, y: ranges::NOWHERE };

    /// Whether something has said both numbers.
    #[must_use]
    pub const fn is_known(self) -> bool {
        self.x != ranges::NOWHERE && self.y != ranges::NOWHERE
    }
}

/// A screw, or the belt of a gantry's corner.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Screw {
    /// Its own place.
    pub place: WholePlace,
    /// The point of the bed that is probed for it.
    pub point: WholePlace,
}

impl Screw {
    /// A screw of a machine that says no places.
    pub const UNKNOWN: Self = Self { place: WholePlace::NOWHERE, point: WholePlace::NOWHERE };

    /// Whether both places are known.
    #[must_use]
    pub const fn is_known(self) -> bool {
        self.place.is_known() && self.point.is_known()
    }

    /// Two ball screws 25 mm next to the bed at half its depth, and two points of the bed. The other two are not used.
    #[must_use]
    pub const fn prototype() -> [Self; SCREWS] {
        const fn at(x: i16, point_x: i16) -> Screw {
            Screw { place: WholePlace { x, y: 200 }, point: WholePlace { x: point_x, y: 200 } }
        }
        [at(-25, 40), at(415, 350), at(0, 0), at(0, 0)]
    }
}

const PLACE: Spec = ranges::SCREW_PLACE.spec().or_nowhere();

rows! {
    for screw in |s, part| s.screws.get_mut(part), named &["screws.1", "screws.2", "screws.3", "screws.4"];

    /// x of the screw that the first, second.. motor of z turns (M422 W).
    140 "x" = &mut screw.place.x, "mm", [PLACE];
    /// y of the screw.
    141 "y" = &mut screw.place.y, "mm", [PLACE];
    /// x of the point that is probed for the screw (M422 S).
    142 "point_x" = &mut screw.point.x, "mm", [PLACE];
    /// y of the point.
    143 "point_y" = &mut screw.point.y, "mm", [PLACE];
}
