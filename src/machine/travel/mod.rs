//! Travel: moves, arcs, retractions, offsets, and the modes for later lines.
//!
//! | files that commands share | for |
//! |---|---|
//! | [`moves`], [`arcs`], [`circulate`] | G0 to G3 |
//! | [`retraction`] | G10, G11 |
//! | [`visit`] | ways to known places: G27, G61, RESTORE_GCODE_STATE |
//! | [`z_offset`] | M290, SET_GCODE_OFFSET |

pub(in crate::machine) mod arcs;
pub(in crate::machine) mod circulate;
pub(in crate::machine) mod dwell;
pub(in crate::machine) mod feed_percent;
pub(in crate::machine) mod finish;
pub(in crate::machine) mod flow_percent;
pub(in crate::machine) mod home_offsets;
pub(in crate::machine) mod inches;
pub(in crate::machine) mod modes;
pub(in crate::machine) mod move_lines;
pub(in crate::machine) mod moves;
pub(in crate::machine) mod park;
pub(in crate::machine) mod plane;
pub(in crate::machine) mod quick_stop;
pub(in crate::machine) mod recovery;
pub(in crate::machine) mod retract;
pub(in crate::machine) mod retraction;
pub(in crate::machine) mod retraction_settings;
pub(in crate::machine) mod saved_places;
pub(in crate::machine) mod set_position;
pub(in crate::machine) mod soft_endstops;
pub(in crate::machine) mod tool;
pub(in crate::machine) mod visit;
pub(in crate::machine) mod z_offset;
pub(in crate::machine) mod z_shift;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
