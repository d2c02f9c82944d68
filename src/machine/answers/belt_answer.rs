//! What there is to say of motors that can pull against each other.

use crate::driver::Fault;
use crate::port::Motor;

/// Why motors could not be aligned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum AlignError {
    /// The drivers have no UART.
    NoUart,
    /// A driver does not say how hard its motor pulls.
    Driver(Fault),
    /// Hardly anything was read in a stroke.
    TooFewReadings,
    /// Loads do not change with the strain.
    Flat,
    /// The strain is more than motors hold.
    TooFar,
    /// The findings do not agree.
    Unsure,
    /// Something has happened to the motors meanwhile.
    Changed,
    /// A motor has no torque left where it strains the belt by hardly anything.
    AtLimit(Motor),
    /// The drivers of motors that have just got power do not stand to each other as the phases of the belt say.
    Phase,
}

/// What has happened to the motors of one belt since they were aligned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Diagnosis {
    /// Nothing: the switches are where they were, and nobody strains the belt.
    Nothing,
    /// The tool is elsewhere, and the motors agree: some have skipped alike, or a switch has moved.
    Alike,
    /// One motor has skipped, by so many full steps.
    Skip { motor: Motor, full_steps: i32 },
    /// More than one skip, or nothing that skips explain.
    Several,
}

impl Diagnosis {
    /// Of what two residuals say, that which explains more.
    pub const fn graver(self, other: Self) -> Self {
        if self.rank() > other.rank() { self } else { other }
    }

    const fn rank(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::Alike => 1,
            Self::Skip { .. } => 2,
            Self::Several => 3,
        }
    }
}

/// What there is to say of them.
#[derive(Clone, Copy)]
pub(in crate::machine) enum BeltAnswer {
    /// M122: whether they are aligned, and what was found.
    State,
    /// M122: by how many steps the places of their drivers differ from what the firmware counts, in the sum of a
    /// residual.
    Fields(i32),
    /// M122: the path of the tool in mm since x and y met their switches; none if they did not, or lost their place
    /// since.
    Met([Option<u32>; 2]),
    /// They are aligned: what was found.
    Aligned,
    /// They could not be aligned.
    NotAligned(AlignError),
    /// The motors of this machine cannot pull against each other.
    NoResidual,
    /// A printing move was refused.
    Needed,
    /// Motors were never aligned, or have lost power since, or x and y are not homed.
    NothingToCompare,
    /// How far beside their places the switches of x and y were met, in steps.
    Touched([i32; 2]),
    /// What has happened.
    Diagnosis(Diagnosis),
    /// It was to be set right, but something kept it from being so.
    NotRepaired(AlignError),
    /// It was set right; and how far beside their places the switches were met then, in steps.
    Repaired([i32; 2]),
}
