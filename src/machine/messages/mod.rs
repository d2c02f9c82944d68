//! Messages, and reports at once: what a host asks for or says, and nothing depends on.

pub(in crate::machine) mod auto_reports;
pub(in crate::machine) mod endstops;
pub(in crate::machine) mod firmware;
pub(in crate::machine) mod line_number;
pub(in crate::machine) mod message;
pub(in crate::machine) mod position;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
