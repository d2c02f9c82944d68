//! Whether the screws of z are level, and why they could not be levelled.

use crate::machine::numbers::Thousandths;
use crate::units::Mm;
use core::fmt;

/// What is known of the screws of z.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Level {
    /// Nothing: they were never levelled.
    Unknown,
    /// They are level.
    Kept,
    /// Their motors lost power since they were levelled. Screws that turn easily may have turned.
    Lost,
}

/// Why the screws of z were not levelled.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum LevelFailure {
    /// They were no nearer to level after they had turned, which was taken back.
    NotNearer { was: Mm, now: Mm },
    /// They are farther from level than screws in order can be.
    TooFar { now: Mm },
}

impl fmt::Display for LevelFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        put!(f, "G34 aborted. ")?;
        match *self {
            Self::NotNearer { was, now } => put!(
                f,
                "Decreasing accuracy: {} mm between screws before they turned, {} mm after, so the turns were taken \
                back. Check that the cables of the z motors are not swapped, and the places of M422",
                Thousandths(was),
                Thousandths(now)
            ),
            Self::TooFar { now } => put!(
                f,
                "{} mm between screws is too much to turn. Level them by hand first, and check the probe",
                Thousandths(now)
            ),
        }
    }
}
