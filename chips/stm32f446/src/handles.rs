//! The types of the handles, with the ports of a board.

use corehbot::driver::Tmc2209;
use corehbot::{machine, motion, thermal};

use crate::accelerometer::SpiSensor;
use crate::board_facts::ThisBoard;
use crate::board_heat::BoardHeat;
use crate::board_storage::BoardStorage;
use crate::drivers::Drivers;
use crate::host_serial::HostSerial;
use crate::motor_power::EnableLines;
use crate::servo::ServoLine;
use crate::step_timer::BoardClock;
use crate::wake::IrqWake;

/// The ports of a board, except the step ports.
pub type BoardPorts = machine::Ports<PortTypes>;
/// The types of these ports.
pub enum PortTypes {}

impl machine::PortSet for PortTypes {
    type Serial = HostSerial;
    type Motors = EnableLines;
    type Drivers = Drivers;
    type Chip = Tmc2209;
    type Servo = ServoLine;
    type Board = ThisBoard;
    type Clock = BoardClock;
    type Storage = BoardStorage;
    type Accelerometer = SpiSensor;
}

/// Heat, with the ports of a board.
pub type ThermalControl = thermal::ThermalControl<'static, BoardHeat, IrqWake>;
/// Steps to be.
pub type StepGenerator = motion::StepGenerator<'static>;
/// Everything else, with the ports of a board.
pub type Console = machine::Console<'static, PortTypes, IrqWake>;
