//! The lines to the hosts.

/// An event of the serial line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Received {
    /// A byte that arrived whole.
    Byte(u8),
    /// Something was lost or damaged here: overrun, framing or noise error.
    Lost,
    /// A host has opened the line; earlier bytes came from another host. Only for lines that know, such as USB.
    Opened,
}

/// Serial lines to hosts that a machine may have: USB and two UARTs, as on the Octopus. The Console serves each in
/// turn.
pub const LINES: usize = 3;

/// The serial lines of a machine.
pub type Lines<S> = heapless::Vec<S, LINES>;

/// A serial line; never blocks. A line without a host takes all bytes that are sent.
pub trait Serial {
    /// The next thing received, if any.
    fn recv(&mut self) -> Option<Received>;

    /// Takes as many of `bytes` as fit and returns their number; replies must leave at once, not wait for more.
    fn send(&mut self, bytes: &[u8]) -> usize;

    /// The next of the things that have arrived and were neither received nor overheard; [`recv`](Self::recv) returns
    /// it in its turn. Emergencies are heard so behind lines for which there is no room. A line that can hold its host
    /// up may leave it out.
    fn overhear(&mut self) -> Option<Received> {
        None
    }

    /// Whether the next thing to receive was overheard.
    fn was_overheard(&self) -> bool {
        false
    }
}
