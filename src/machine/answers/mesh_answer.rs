//! Answers about the bed's mesh.

use crate::settings::Range;
use crate::storage::{MeshNotSaved, MeshRejected};
use crate::units::Mm;

/// How a mesh is reported.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum MeshForm {
    /// For people, as Marlin's bilinear grid.
    Grid,
    /// For programs: a line a row with tabs, the back of the bed first.
    Table,
}

/// What is said about the mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum MeshAnswer {
    /// There is none.
    None,
    /// Its heights.
    Heights(MeshForm),
    /// Whether it is used, and its fade height.
    State,
    /// A point was measured, of so many.
    Point { number: u16, all: u16, at: [Mm; 2], height: Mm },
    /// Another area is measured than the whole.
    Area { x: Range<Mm>, y: Range<Mm>, points: [usize; 2] },
    /// No object is known to measure around, or its outline came cut.
    NotAdaptive { is_cut: bool },
    /// There is no such point.
    NoPoint,
    /// The fade height is short for the largest deviation.
    ShortFade(Mm),
    /// It is too short, so the mesh does not fade.
    NoFade(Mm),
    /// The mesh is kept.
    Kept,
    /// The places of the kept mesh moved with the probe by so much.
    Moved([Mm; 2]),
    /// The next start refuses the kept mesh.
    Ends,
    /// The kept mesh is forgotten.
    Forgotten,
    /// It covers a part of the bed, so it is not kept.
    Part,
    /// It was not kept.
    NotKept(MeshNotSaved),
    /// There is no kept mesh, or none of this machine.
    Rejected(MeshRejected),
}
