//! The answers of the Z probe.

use crate::settings::Range;
use crate::units::Mm;

/// What the probe has found, or why it was not asked.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum ProbeAnswer {
    /// There is no probe.
    None,
    /// It cannot touch there, but within these.
    OutOfReach { at: [Mm; 2], reaches: [Range<Mm>; 2] },
    /// The height of the bed at a place.
    Bed { at: [Mm; 2], height: Mm },
    /// M48 begins.
    Test,
    /// M48 V2: a touch of so many.
    Sample { number: u16, of: u16, height: Mm },
    /// M48 has ended; whether it tells more than the deviation.
    Finished { spread: Spread, is_verbose: bool },
    /// M280: the servo's angle, if it has got one.
    Servo(Option<u16>),
    /// M401 H.
    Quick(bool),
}

/// Mean and spread of touches.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Spread {
    pub mean_nm: i64,
    pub least: Mm,
    pub most: Mm,
    /// Standard deviation.
    pub sigma_nm: u64,
}
