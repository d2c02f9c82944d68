//! What a pause does with the tool and the heat.

use crate::units::{Mm, MmPerSec};
use serde::{Deserialize, Serialize};

/// Where the tool waits while a print is paused, and how it gets there and back.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Pause {
    /// Filament that is pulled back before the tool leaves the part.
    pub retract: Mm,
    /// Speed at which it is pulled back.
    pub retract_speed: MmPerSec,
    /// Speed at which it is pushed forward again.
    pub unretract_speed: MmPerSec,
    /// How far the tool is lifted off the part.
    pub lift: Mm,
    /// Whether the tool goes to its parking place.
    pub park: bool,
    /// The parking place.
    pub x: Mm,
    /// The same.
    pub y: Mm,
    /// Speed of the way to the parking place and back.
    pub travel_speed: MmPerSec,
    /// Minutes after which heaters go off; they go off after [`idle_min`](super::ThermalSettings::idle_min) at the latest.
    pub heat_off_min: u8,
}

impl Pause {
    /// 2 mm at 60 mm/s are Marlin's (Configuration_adv.h 2.1, `PAUSE_PARK_RETRACT_LENGTH`), and so is the corner, 10 mm from both ends
    /// (Configuration.h, `NOZZLE_PARK_POINT`). An extruder of 80 mm/s is not asked for all of it. Filament goes forward more slowly, as
    /// melt resists. 10 mm are out of reach of what a nozzle drips. Heat goes off as it does without a pause.
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
