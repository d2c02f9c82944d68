//! Work: what the Console puts into the MoveQueue for the generator.

use super::moves::Move;
use super::trajectory::{Stiffening, Taps};
use crate::kinematics::Grouping;
use crate::units::{Steps, SubTicks};

/// One entry of the MoveQueue.
#[derive(Clone, PartialEq, Debug)]
pub enum Work {
    /// A move.
    Move(Move),
    /// Time without motion, in ticks times 2^16.
    Dwell(SubTicks),
    /// At rest: from now on an axis follows these taps. The advance, axis 4, is the difference of its taps.
    Follow(u8, Taps),
    /// At rest: from now on an axis has this stiffening.
    Stiffen(u8, Stiffening),
    /// At rest: from now on the motors are grouped for the tool alone, or so that the belt can circulate too.
    Regroup(Grouping),
    /// Without motion: the machine's position, in steps of x, y, z and e.
    Position([Steps; 4]),
}

/// Work, and the epoch to which it belongs.
#[derive(Clone, PartialEq, Debug)]
pub struct Entry {
    /// The epoch in which it was queued.
    pub epoch: u8,
    /// What to do.
    pub work: Work,
}

const _: () = assert!(core::mem::size_of::<Entry>() <= 104);
