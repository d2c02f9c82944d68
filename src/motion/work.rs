//! Work: what the Console puts into the MoveQueue for the generator.

use super::moves::Move;
use super::surface::SurfaceFrame;
use super::sweep::Sweep;
use super::trajectory::{Stiffening, Taps};
use crate::kinematics::Grouping;
use crate::surface::{Heights, MOST_POINTS};
use crate::units::{Steps, SubTicks};

/// One entry of the MoveQueue.
#[derive(Clone, PartialEq, Debug)]
pub enum Work {
    /// A move.
    Move(Move),
    /// At rest: a resonance test.
    Sweep(Sweep),
    /// Time without motion, in ticks times 2^16.
    Dwell(SubTicks),
    /// At rest: from now on an axis follows these taps. The advance, axis 4, is the difference of its taps.
    Follow(u8, Taps),
    /// At rest: from now on an axis has this stiffening.
    Stiffen(u8, Stiffening),
    /// At rest: from now on the motors are grouped for the tool alone, or so that the belt can circulate too.
    Regroup(Grouping),
    /// At rest: from now on z follows a surface, all at height 0, or none.
    Surface(SurfaceFrame),
    /// At rest: heights of a row of the surface.
    Heights(u8, [i16; MOST_POINTS]),
    /// Without motion: the machine's position, in steps of x, y, z and e. On a surface, z is counted from there.
    Position([Steps; 4]),
}

/// The work that makes z follow a surface with these heights.
pub fn surface_work(frame: SurfaceFrame, heights: &Heights) -> impl Iterator<Item = Work> {
    let rows = (0..heights.rows()).map(|row| Work::Heights(row as u8, heights.row(row)));
    core::iter::once(Work::Surface(frame)).chain(rows)
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
