//! The driver before the bus starts: it gives out endpoints.

use crate::bits::own_fifo;
use crate::bus::Bus;
use crate::control::ControlPipe;
use crate::endpoint::{In, Out};
use crate::registers::Registers;
use crate::shape::{Config, PACKET, Shape, Shapes};
use crate::state::State;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_usb_driver::{Direction, EndpointAddress, EndpointAllocError, EndpointInfo, EndpointType};

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
