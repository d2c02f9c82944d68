//! Answers about the screws of z.

use crate::kinematics::SCREWS;
use crate::units::Mm;

/// A line of G34 or G35.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum ScrewAnswer {
    /// A round of G34 begins.
    Round(u16),
    /// Heights of the bed at the screws, of which this many count.
    Heights([Mm; SCREWS], usize),
    /// G34 has ended after some of its rounds, with this difference between screws.
    Done { rounds: u16, of: u16, left: Mm, is_level: bool },
    /// G35: a corner, and how much higher than the first one its bed is; the thread's pitch, and whether it turns
    /// clockwise to go up.
    Corner { corner: Corner, higher: Mm, pitch: Mm, is_clockwise: bool },
}

/// A corner of the bed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Corner {
    FrontLeft,
    FrontRight,
    BackRight,
    BackLeft,
}

impl Corner {
    /// All of them, one next to the other.
    pub const ALL: [Self; 4] = [Self::FrontLeft, Self::FrontRight, Self::BackRight, Self::BackLeft];

    /// Marlin's name (Configuration_adv.h, `TRAMMING_POINT_NAME_1`).
    pub const fn name(self) -> &'static str {
        match self {
            Self::FrontLeft => "Front-Left",
            Self::FrontRight => "Front-Right",
            Self::BackRight => "Back-Right",
            Self::BackLeft => "Back-Left",
        }
    }

    /// Whether it is at the right, and whether it is at the back.
    pub const fn sides(self) -> [bool; 2] {
        [matches!(self, Self::FrontRight | Self::BackRight), matches!(self, Self::BackRight | Self::BackLeft)]
    }
}
