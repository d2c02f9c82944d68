//! The ports: the traits that a board, or a simulator, implements so that the core can run on it.
//!
//! | trait | for |
//! |---|---|
//! | [`StepPort`], [`StepClock`] | the step interrupt |
//! | [`ThermalPort`] | heaters, fans, temperature sensors |
//! | [`MotorPower`] | the power of the motors |
//! | [`DriverBus`] | the wires on which drivers are configured |
//! | [`Servo`] | the pin of a BLTouch |
//! | [`BoardFacts`] | connectors, and why no motor may have power |
//! | [`Serial`] | hosts |
//! | [`Storage`] | settings |
//! | [`Accelerometer`] | resonance tests |
//! | [`Clock`], [`Wake`] | time, and the other contexts |
//!
//! The core uses hardware through these traits only. A simulated fault is one more implementation wrapped round
//! another, never a flag.

mod accelerometer;
mod board;
mod drivers;
mod serial;
mod step;
mod storage;
mod thermal;
mod time;

pub use crate::connectors::{FANS, HEATERS, Heater, OUTPUTS, Output, OutputSet, SENSORS, Sensor};
pub use crate::motors::{Coupling, EndstopSet, GroupSet, Motor, MotorSet};

pub use accelerometer::{Accelerometer, NoAccelerometer};
pub use board::{AnyBoard, BoardFacts, NoServo, Servo};
pub use drivers::{BusError, DriverBus, Frame, MotorPower, NoBus};
pub use serial::{LINES, Lines, Received, Serial};
pub use step::{STEP_PULSE_NS, StepClock, StepPort};
pub use storage::{NoStorage, Storage, StorageError};
pub use thermal::{NoHeaters, ThermalPort};
pub use time::{Clock, Wake};
