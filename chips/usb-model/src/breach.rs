//! Breaches: what a program does to the core although the manual forbids it. The core of the model goes on as well as
//! it can, as the chip's would; a test asks that there are none.

/// What the manual forbids (RM0390 rev 6, section 31, unless named otherwise). Numbers are endpoints.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Breach {
    /// A register that the device mode does not have, by its offset.
    NoRegister(u32),
    /// The next entry was popped before all words of the last packet were read: so many are left.
    UnreadWords(usize),
    /// A word was read from an empty receive FIFO.
    EmptyRead,
    /// A word was written although the endpoint has no transfer that needs it.
    UnneededWord(usize),
    /// A word was written to a full transmit FIFO.
    TransmitOverflow(usize),
    /// Another register was accessed between the words of a packet, which corrupts the FIFO (ES0298, transmit data
    /// FIFO).
    InterruptedWords(usize),
    /// Size or count of a transfer changed while the endpoint was enabled.
    ChangedTransfer(usize),
    /// A transfer began with more bytes than its packets carry, or without a packet.
    WrongSize(usize),
    /// A transfer began while words of an earlier one were still in the transmit FIFO.
    StaleWords(usize),
    /// A transfer began on an endpoint that is not active.
    InactiveEndpoint(usize),
    /// An IN endpoint began a transfer from the FIFO of another one (TXFNUM).
    OtherFifo(usize),
    /// An endpoint was to be disabled that was not enabled.
    DisabledIdle(usize),
    /// An IN endpoint was disabled before its NAK was in effect.
    DisabledWithoutNak(usize),
    /// An OUT endpoint was disabled before the global OUT NAK was in effect.
    DisabledWithoutGlobalNak(usize),
    /// OUT endpoint 0 was to be disabled, which it cannot be.
    DisabledControl,
    /// A transmit FIFO was flushed while its endpoint could send from it.
    FlushedInUse(usize),
    /// The receive FIFO was flushed while packets could come in.
    FlushedReceive,
    /// The areas of the FIFOs overlap, or do not fit the memory.
    FifoAreas,
    /// A FIFO changed its size while an endpoint used it.
    ResizedInUse,
    /// The host talked to a core with this turnaround time (TRDT), which full speed does not allow at this clock.
    Turnaround(u32),
}
