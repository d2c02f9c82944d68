//! The Console's ports: its needs from a board, as one type.

use crate::port::{Accelerometer, Clock, DriverBus, Lines, Serial, Storage};

/// The ports that the Console needs from a board.
pub struct Ports<S: Serial, D: DriverBus, K: Clock, T: Storage, A: Accelerometer> {
    /// The lines to the hosts.
    pub serial: Lines<S>,
    /// The motor drivers.
    pub drivers: D,
    /// The clock.
    pub clock: K,
    /// Memory for settings; [`NoStorage`](crate::port::NoStorage) if there is none.
    pub storage: T,
    /// The accelerometer; [`NoAccelerometer`](crate::port::NoAccelerometer) if there is none.
    pub accelerometer: A,
}

/// The types of a set of [`Ports`], so that one parameter names them all.
pub trait PortSet {
    /// A line to a host.
    type Serial: Serial;
    /// The motor drivers.
    type Drivers: DriverBus;
    /// The clock.
    type Clock: Clock;
    /// Memory for settings.
    type Storage: Storage;
    /// The accelerometer.
    type Accelerometer: Accelerometer;
}

impl<S: Serial, D: DriverBus, K: Clock, T: Storage, A: Accelerometer> PortSet for Ports<S, D, K, T, A> {
    type Serial = S;
    type Drivers = D;
    type Clock = K;
    type Storage = T;
    type Accelerometer = A;
}
