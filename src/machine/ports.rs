//! The Console's ports: its needs from a board, as one type.

use crate::driver::Chip;
use crate::port::{Accelerometer, BoardFacts, Clock, DriverBus, Lines, MotorPower, Serial, Servo, Storage};

/// The types of the ports that the Console needs from a board, so that one parameter names them all.
pub trait PortSet {
    /// A line to a host.
    type Serial: Serial;
    /// The power of the motors.
    type Motors: MotorPower;
    /// The wires to the drivers; [`NoBus`](crate::port::NoBus) if there are none.
    type Drivers: DriverBus;
    /// The chips at these wires.
    type Chip: Chip;
    /// The servo of the probe; [`NoServo`](crate::port::NoServo) if there is none.
    type Servo: Servo;
    /// Facts of the board.
    type Board: BoardFacts;
    /// The clock.
    type Clock: Clock;
    /// Memory for settings; [`NoStorage`](crate::port::NoStorage) if there is none.
    type Storage: Storage;
    /// The accelerometer; [`NoAccelerometer`](crate::port::NoAccelerometer) if there is none.
    type Accelerometer: Accelerometer;
}

/// The ports themselves.
pub struct Ports<P: PortSet> {
    /// The lines to the hosts.
    pub serial: Lines<P::Serial>,
    /// The power of the motors.
    pub motors: P::Motors,
    /// The wires to the drivers.
    pub drivers: P::Drivers,
    /// The servo of the probe.
    pub servo: P::Servo,
    /// Facts of the board.
    pub board: P::Board,
    /// The clock.
    pub clock: P::Clock,
    /// Memory for settings.
    pub storage: P::Storage,
    /// The accelerometer.
    pub accelerometer: P::Accelerometer,
}
