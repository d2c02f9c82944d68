//! What became of the mesh in storage, as hosts read it.

use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::exact;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::storage::{MOST_STORED, MeshNotSaved, MeshRejected};
use crate::units::Mm;
use core::fmt::{self, Display, Formatter};

/// What became of the mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum News {
    /// It is kept.
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

impl News {
    /// Says it, as the answer.
    pub fn answer<P: PortSet, W: Wake>(self, main_loop: &mut MainLoop<'_, P, W>) -> Answer<'static> {
        main_loop.say(text!("{self}"));
        Answer::Said
    }
}

impl Display for News {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kept => put!(f, "echo:Mesh stored"),
            Self::Moved(by) => {
                let [x, y] = by.map(exact);
                put!(f, "echo:Stored mesh moved with the probe: X{x} Y{y}")
            }
            Self::Ends => {
                put!(f, "echo:Stored mesh ends with the next start: steps or axes are others. Send G29, M500")
            }
            Self::Forgotten => put!(f, "echo:Stored mesh forgotten"),
            Self::Part => {
                put!(f, "echo:Mesh not stored: it covers a part of the bed. G29 without an area measures all")
            }
            Self::NotKept(MeshNotSaved::TooLarge) => {
                put!(f, "echo:Mesh not stored: there is room for {MOST_STORED} points; it counts until a reset")
            }
            Self::NotKept(MeshNotSaved::Storage(error)) => put!(f, "echo:Mesh not stored: {error}"),
            Self::NotKept(MeshNotSaved::NotKept) => put!(f, "echo:Mesh not stored: storage does not keep written data"),
            Self::Rejected(why) => {
                let why = match why {
                    MeshRejected::Blank => packed!("none was stored"),
                    MeshRejected::Damaged => packed!("it is damaged"),
                    MeshRejected::Machine => packed!("it is of a machine with other axes, motors or another probe"),
                };
                put!(f, "echo:No stored mesh: {why}. Prints are not levelled until G29")
            }
        }
    }
}
