//! The driver before the bus starts: it gives out endpoints.

use crate::bits::{FULL_SPEED_INTERNAL, own_fifo};
use crate::bus::Bus;
use crate::control::ControlPipe;
use crate::endpoint::{In, Out};
use crate::registers::Registers;
use crate::state::State;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_usb_driver::{Direction, EndpointAddress, EndpointAllocError, EndpointInfo, EndpointType};

/// Bytes of the longest packet: that of bulk and control endpoints at full speed (USB 2.0, sections 5.5.3 and 5.8.3).
pub const PACKET: usize = 64;

/// The least size of a transmit FIFO, in words (RM0390 rev 6, DIEPTXFx).
const LEAST_FIFO: u16 = 16;

/// Words of the receive FIFO beside a packet: 13 for SETUP packets, 1 for the global NAK, 2 for each endpoint that gets
/// data and 1 more for each (RM0390 rev 6, section 31.11.3), for six endpoints; with two packets at once.
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

    fn all_words(&self) -> u16 {
        Self::RECEIVE + self.ins.iter().flatten().map(|shape| Self::words(*shape)).sum::<u16>()
    }
}

/// The driver before the bus starts.
pub struct Driver<'d, R, M: RawMutex, const N: usize> {
    registers: R,
    state: &'d State<M, N>,
    config: Config,
    shapes: Shapes<N>,
}

impl<'d, R: Registers, M: RawMutex, const N: usize> Driver<'d, R, M, N> {
    /// A driver of a core that the chip has switched on as a device.
    pub fn new(registers: R, state: &'d State<M, N>, config: Config) -> Self {
        Self { registers, state, config, shapes: Shapes { ins: [None; N], outs: [None; N] } }
    }

    /// Finds an endpoint for what is asked.
    fn give(
        &mut self,
        direction: Direction,
        ep_type: EndpointType,
        address: Option<EndpointAddress>,
        longest: u16,
        interval_ms: u8,
    ) -> Result<EndpointInfo, EndpointAllocError> {
        let is_control = ep_type == EndpointType::Control;
        if usize::from(longest) > PACKET || ep_type == EndpointType::Isochronous {
            return Err(EndpointAllocError);
        }
        let (place, is_in) = match direction {
            Direction::In => (&mut self.shapes.ins, true),
            Direction::Out => (&mut self.shapes.outs, false),
        };
        let is_wanted = |n: usize| (n == 0) == is_control && address.is_none_or(|address| address.index() == n);
        let mut free = place.iter_mut().enumerate().filter(|(n, shape)| shape.is_none() && is_wanted(*n));
        let (n, shape) = free.next().ok_or(EndpointAllocError)?;
        let fifo = if is_in { own_fifo(n) } else { 0 };
        let control = match n {
            // A code in place of a size: 0 is 64 bytes.
            0 => 0,
            _ => crate::bits::kind(ep_type as u32) | fifo | u32::from(longest),
        };
        *shape = Some(Shape { control, longest });
        if self.shapes.all_words() > self.config.fifo_words {
            return Err(EndpointAllocError);
        }
        let addr = EndpointAddress::from_parts(n, direction);
        Ok(EndpointInfo { addr, ep_type, max_packet_size: longest, interval_ms })
    }
}

impl<'d, R: Registers + 'd, M: RawMutex, const N: usize> embassy_usb_driver::Driver<'d> for Driver<'d, R, M, N> {
    type EndpointOut = Out<'d, R, M, N>;
    type EndpointIn = In<'d, R, M, N>;
    type ControlPipe = ControlPipe<'d, R, M, N>;
    type Bus = Bus<'d, R, M, N>;

    fn alloc_endpoint_out(
        &mut self,
        ep_type: EndpointType,
        ep_addr: Option<EndpointAddress>,
        max_packet_size: u16,
        interval_ms: u8,
    ) -> Result<Self::EndpointOut, EndpointAllocError> {
        let info = self.give(Direction::Out, ep_type, ep_addr, max_packet_size, interval_ms)?;
        Ok(Out { registers: self.registers, state: self.state, info })
    }

    fn alloc_endpoint_in(
        &mut self,
        ep_type: EndpointType,
        ep_addr: Option<EndpointAddress>,
        max_packet_size: u16,
        interval_ms: u8,
    ) -> Result<Self::EndpointIn, EndpointAllocError> {
        let info = self.give(Direction::In, ep_type, ep_addr, max_packet_size, interval_ms)?;
        Ok(In { registers: self.registers, state: self.state, info })
    }

    /// # Panics
    /// If the control packets are not of 64 bytes, or the FIFO memory has no room for them: a mistake in the program.
    fn start(mut self, control_max_packet_size: u16) -> (Self::Bus, Self::ControlPipe) {
        assert!(usize::from(control_max_packet_size) == PACKET, "control packets have 64 bytes");
        for direction in [Direction::Out, Direction::In] {
            let given = self.give(direction, EndpointType::Control, None, control_max_packet_size, 0);
            assert!(given.is_ok(), "the FIFO memory has room for endpoint 0");
        }
        let Self { registers, state, config, shapes } = self;
        (Bus::new(registers, state, config, shapes), ControlPipe { registers, state })
    }
}

/// DCFG of a device at full speed on the transceiver of the chip.
pub(crate) const DEVICE: u32 = FULL_SPEED_INTERNAL;
