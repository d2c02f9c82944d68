//! The core of a chip, and the shapes of its endpoints: packets, and room in the FIFO memory.

/// Bytes of the longest packet: that of bulk and control endpoints at full speed (USB 2.0, sections 5.5.3 and 5.8.3).
pub const PACKET: usize = 64;

/// The least size of a transmit FIFO, in words (RM0390 rev 6, DIEPTXFx).
const LEAST_FIFO: u16 = 16;

/// Words of the receive FIFO beside a packet (RM0390 rev 6, section 31.11.3), for six endpoints and two packets at
/// once. It has 13 for SETUP packets, 1 for the global NAK, 2 for each endpoint that gets data and 1 more for each.
const RECEIVE: u16 = 13 + 1 + 3 * 6 + 2 * (PACKET as u16 / 4 + 1);

/// The properties of the core of a chip.
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// Words of its FIFO memory.
    pub fifo_words: u16,
    /// TRDT for the clock of its bus.
    pub turnaround: u32,
}

/// An endpoint as it was given out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// The bits of its control register that stay.
    pub control: u32,
    /// Bytes of its packets.
    pub longest: u16,
}

/// The endpoints of both directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shapes<const N: usize> {
    pub ins: [Option<Shape>; N],
    pub outs: [Option<Shape>; N],
}

impl<const N: usize> Shapes<N> {
    /// The sizes of the FIFOs in words: of the one that receives, and of an IN endpoint of that shape.
    pub const RECEIVE: u16 = RECEIVE;

    /// Words of the transmit FIFO of an endpoint.
    pub fn words(shape: Shape) -> u16 {
        shape.longest.div_ceil(4).max(LEAST_FIFO)
    }

    pub fn all_words(&self) -> u16 {
        Self::RECEIVE + self.ins.iter().flatten().map(|shape| Self::words(*shape)).sum::<u16>()
    }
}
