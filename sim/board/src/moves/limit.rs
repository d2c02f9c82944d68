//! Limit: what keeps a move from being faster.

use serde::{Serialize, Serializer};

/// What keeps a move from being faster.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Limit {
    /// The commanded speed.
    #[default]
    Feed,
    /// Speed or acceleration of an axis.
    Axis,
    /// Speed or acceleration of a belt motor.
    Motor,
    /// A corner or a stop: the ramp to it or from it.
    Corner,
    /// The end of the look-ahead.
    LookAhead,
    /// The part of a move that is to be run at one speed.
    CruiseRatio,
    /// Speed or acceleration of the extruder, and what pressure advance leaves of them.
    Extruder,
    /// What z has to do to follow the mesh.
    Mesh,
    /// A host that does not send fast enough.
    SlowHost,
    /// The speed that the firmware has chosen itself: homing, probing, parking.
    Firmware,
}

impl Limit {
    /// All, by their numbers.
    pub const ALL: [Self; 10] = [
        Self::Feed,
        Self::Axis,
        Self::Motor,
        Self::Corner,
        Self::LookAhead,
        Self::CruiseRatio,
        Self::Extruder,
        Self::Mesh,
        Self::SlowHost,
        Self::Firmware,
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Feed => "feed",
            Self::Axis => "axis",
            Self::Motor => "motor",
            Self::Corner => "corner",
            Self::LookAhead => "look-ahead",
            Self::CruiseRatio => "cruise ratio",
            Self::Extruder => "extruder",
            Self::Mesh => "mesh",
            Self::SlowHost => "slow host",
            Self::Firmware => "firmware",
        }
    }
}

impl Serialize for Limit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
