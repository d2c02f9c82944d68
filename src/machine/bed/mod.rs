//! The bed: the Z probe, the mesh, and the screws of z.
//!
//! | files that commands share | for |
//! |---|---|
//! | [`probing`] | places of the probe in a line |
//! | [`measure`], [`levelling`], [`mesh_points`] | the mesh: G29, M420, M421 |
//! | [`screws`] | G34, G35 |

pub(in crate::machine) mod bed_height;
pub(in crate::machine) mod bed_mesh;
pub(in crate::machine) mod hand_screws;
pub(in crate::machine) mod levelling;
pub(in crate::machine) mod measure;
pub(in crate::machine) mod mesh_point;
pub(in crate::machine) mod mesh_points;
pub(in crate::machine) mod mesh_use;
pub(in crate::machine) mod print_area;
pub(in crate::machine) mod print_objects;
pub(in crate::machine) mod probe_pin;
pub(in crate::machine) mod probing;
pub(in crate::machine) mod repeatability;
pub(in crate::machine) mod screw_levelling;
pub(in crate::machine) mod screw_place;
pub(in crate::machine) mod screws;
pub(in crate::machine) mod servo;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
