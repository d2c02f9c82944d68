//! What one line of G-code sets, as a name: each is a line of M503.

/// What one line sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Setting {
    /// M92.
    Resolutions,
    /// M203.
    MaxSpeeds,
    /// M201.
    MaxAccelerations,
    /// M204.
    Accelerations,
    /// M205.
    Corners,
    /// SET_VELOCITY_LIMIT.
    VelocityLimit,
    /// M593.
    Shapers,
    /// M900 and M572.
    Advance,
    /// M207.
    Retraction,
    /// M208.
    Recovery,
}

impl Setting {
    /// All of them, in the order of M503.
    pub const ALL: [Self; 10] = [
        Self::Resolutions,
        Self::MaxSpeeds,
        Self::MaxAccelerations,
        Self::Accelerations,
        Self::Corners,
        Self::VelocityLimit,
        Self::Shapers,
        Self::Advance,
        Self::Retraction,
        Self::Recovery,
    ];
}
