//! The types of the handles, with the ports of a board.

use corehbot::{machine, motion, thermal};

use crate::accelerometer::SpiSensor;
use crate::board_storage::BoardStorage;
use crate::drivers::Drivers;
use crate::heat::BoardHeat;
use crate::host_serial::HostSerial;
use crate::step_timer::BoardClock;
use crate::wake::IrqWake;

/// The ports of a board, except the step ports.
pub type BoardPorts = machine::Ports<HostSerial, Drivers, BoardClock, BoardStorage, SpiSensor>;
/// Heat, with the ports of a board.
pub type ThermalControl = thermal::ThermalControl<'static, BoardHeat, IrqWake>;
/// Steps to be.
pub type StepGenerator = motion::StepGenerator<'static>;
/// Everything else, with the ports of a board.
pub type Console = machine::Console<'static, BoardPorts, IrqWake>;
