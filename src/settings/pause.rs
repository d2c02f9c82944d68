//! The tool and the heaters in a pause.

use super::ranges;
use super::rows::{Spec, rows};
use crate::units::{Mm, MmPerSec};
use serde::{Deserialize, Serialize};

/// Where the tool waits while a print is paused, and its path there and back.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Pause {
    /// Filament that is pulled back before the tool leaves the part.
    pub retract: Mm,
    /// Speed at which it is pulled back.
    pub retract_speed: MmPerSec,
    /// Speed at which it is pushed forward again.
    pub unretract_speed: MmPerSec,
    /// The lift of the tool off the part.
    pub lift: Mm,
    /// Whether the tool goes to its parking place.
    pub park: bool,
    /// The parking place.
    pub x: Mm,
    /// The same.
    pub y: Mm,
    /// Speed of the move to the parking place and back.
    pub travel_speed: MmPerSec,
    /// Minutes after which heaters go off; they go off after [`idle_min`](super::ThermalSettings::idle_min) at the
    /// latest.
    pub heat_off_min: u8,
}

impl Pause {
    /// 2 mm at 60 mm/s are Marlin's (Configuration_adv.h 2.1, `PAUSE_PARK_RETRACT_LENGTH`), and so is the corner, 10 mm
    /// from both ends (Configuration.h, `NOZZLE_PARK_POINT`). An extruder of 80 mm/s is not driven at its full speed.
    /// Filament goes forward more slowly, as melt resists. 10 mm are beyond the reach of a nozzle's drips. Heat goes
    /// off as it does without a pause.
    pub(super) const fn prototype() -> Self {
        Self {
            retract: Mm::const_from_int(2),
            retract_speed: MmPerSec::const_from_int(60),
            unretract_speed: MmPerSec::const_from_int(20),
            lift: Mm::const_from_int(10),
            park: true,
            x: Mm::const_from_int(10),
            y: Mm::const_from_int(10),
            travel_speed: MmPerSec::const_from_int(100),
            heat_off_min: 30,
        }
    }
}

rows! {
    for pause in |s, _| Some(&mut s.pause), named &["pause"];

    /// Filament that is pulled back before the tool leaves the part; 0 is none.
    49 "retract" = &mut pause.retract, "mm", [ranges::PAUSE_RETRACT.spec()];
    /// Speed at which filament is pulled back.
    50 "retract_speed" = &mut pause.retract_speed, "mm/s", [ranges::SPEED.spec()];
    /// Speed at which filament is pushed forward again.
    51 "unretract_speed" = &mut pause.unretract_speed, "mm/s", [ranges::SPEED.spec()];
    /// How far the tool is lifted off the part; 0 is not at all.
    52 "lift" = &mut pause.lift, "mm", [ranges::PAUSE_LIFT.spec()];
    /// Whether the tool goes to the place of x and y.
    53 "park" = &mut pause.park, "", [Spec::SWITCH];
    /// x of the parking place; beyond the reachable space it is the edge.
    54 "x" = &mut pause.x, "mm", [ranges::PLACE.spec()];
    /// y of the parking place; beyond the reachable space it is the edge.
    55 "y" = &mut pause.y, "mm", [ranges::PLACE.spec()];
    /// Speed of the way to the parking place and back.
    56 "travel_speed" = &mut pause.travel_speed, "mm/s", [ranges::SPEED.spec()];
    /// Time of a pause after which heaters go off, to be heated again before the print goes on. They go off after
    /// thermal.idle_min at the latest.
    57 "heat_off_min" = &mut pause.heat_off_min, "min", [ranges::PAUSE_HEAT_MIN.spec()];
}
