//! Homing: each axis meets its switch, or z the probe.

pub(in crate::machine) mod home;
pub(in crate::machine) mod homing_axes;
pub(in crate::machine) mod proof;
pub(in crate::machine) mod shift_z;
pub(in crate::machine) mod switch;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
