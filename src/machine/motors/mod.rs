//! Motors: their power, their drivers, and the checks of a belt.
//!
//! | files that commands share | for |
//! |---|---|
//! | [`drivers`] | values of drivers: M569, M906, M913, M914 |
//! | [`driver_report`] | their lines: M122, M569, M906, M913, M914 |
//! | [`belt_check`] | M915 |
//! | [`buzz`] | STEPPER_BUZZ |

pub(in crate::machine) mod belt_alignment;
pub(in crate::machine) mod belt_check;
pub(in crate::machine) mod buzz;
pub(in crate::machine) mod diagnosis;
pub(in crate::machine) mod driver_current;
pub(in crate::machine) mod driver_mode;
mod driver_report;
pub(in crate::machine) mod drivers;
pub(in crate::machine) mod hybrid_threshold;
pub(in crate::machine) mod motor_power;
pub(in crate::machine) mod stall_threshold;
pub(in crate::machine) mod stepper_buzz;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
