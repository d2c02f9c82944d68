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
}
