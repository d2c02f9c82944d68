//! The Console's ports: its needs from a board, as one type.

use crate::port::{Clock, DriverBus, Lines, Serial, Storage};

/// The ports that the Console needs from a board.
pub struct Ports<S: Serial, D: DriverBus, K: Clock, T: Storage> {
    /// The lines to the hosts.
    pub serial: Lines<S>,
    /// The motor drivers.
    pub drivers: D,
    /// The clock.
    pub clock: K,
    /// Memory for settings; [`NoStorage`](crate::port::NoStorage) if there is none.
    pub storage: T,
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
}

impl<S: Serial, D: DriverBus, K: Clock, T: Storage> PortSet for Ports<S, D, K, T> {
    type Serial = S;
    type Drivers = D;
    type Clock = K;
    type Storage = T;
}
