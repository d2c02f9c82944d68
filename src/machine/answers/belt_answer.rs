//! Answers about motors that can pull against each other.

use crate::driver::Fault;
use crate::machine::state::pulleys::Shift;
use crate::port::Motor;
use crate::units::Mm;

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
    /// The motors have changed in the meantime.
    Changed,
    /// Measured again, this strain is left in mm.
    Strained(Mm),
    /// The loads contradict each other by this strain in mm.
    Drags(Mm),
    /// A motor has no torque left where it strains the belt by hardly anything.
    AtLimit(Motor),
    /// The drivers of motors that have just got power do not stand to each other as the phases of the belt say.
    Phase,
}

/// How the motors of one belt have changed since they were aligned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Diagnosis {
    /// Nothing changed: the switches are in place, and no motor strains the belt.
    Nothing,
    /// The tool is elsewhere, the motors agree, and no skip moves it so far.
    Aside,
    /// The tool is elsewhere, and the motors agree: some have skipped alike, or a switch has moved.
    Alike,
    /// The belt is strained as no skip does it, and nothing else is wrong.
    Moved,
    /// One motor has skipped, by this many full steps.
    Skip { motor: Motor, full_steps: i32 },
    /// More than one skip, or a state that skips cannot explain.
    Several,
}

impl Diagnosis {
    /// Of two residuals' diagnoses, the one that explains more.
    pub const fn graver(self, other: Self) -> Self {
        if self.rank() > other.rank() { self } else { other }
    }

    const fn rank(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::Aside => 1,
            Self::Alike => 2,
            Self::Moved => 3,
            Self::Skip { .. } => 4,
            Self::Several => 5,
        }
    }
}

/// The answers.
#[derive(Clone, Copy)]
pub(in crate::machine) enum BeltAnswer {
    /// M122: whether they are aligned, and the last results.
    State,
    /// M122: the driver positions differ from the step counts of the firmware by this many steps, summed over a
    /// residual.
    Fields(i32),
    /// M122: the path of the tool in mm since x and y met their switches; none if they did not, or lost their place
    /// since.
    Met([Option<u32>; 2]),
    /// A mm of strain takes another part of the load than before, of this residual.
    Load { number: usize, now: u16, before: u16 },
    /// The phase of this residual has changed by so many 1024ths of an electrical turn.
    Pulley { number: usize, by: i32, shift: Shift, is_kept: bool },
    /// A jumped tooth cannot be told from skips on this machine.
    Untold,
    /// They are aligned; these are the results.
    Aligned,
    /// They could not be aligned.
    NotAligned(AlignError),
    /// The motors of this machine cannot pull against each other.
    NoResidual,
    /// A printing move was refused.
    Needed,
    /// Motors were never aligned, or have lost power since, or x and y are not homed.
    NothingToCompare,
    /// Distance in steps of the x and y switches from their expected positions.
    Touched([i32; 2]),
    /// The diagnosis.
    Diagnosis(Diagnosis),
    /// It was to be set right, but something kept it from being so.
    NotRepaired(AlignError),
    /// The fault was repaired; afterwards the x and y switches were this many steps from their expected positions.
    Repaired([i32; 2]),
}
