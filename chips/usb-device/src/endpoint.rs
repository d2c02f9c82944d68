//! Packets of bulk and interrupt endpoints.

use crate::bits::{CNAK, EPENA, diepctl, dieptsiz, doepctl, doeptsiz, fifo, one_packet};
use crate::registers::Registers;
use crate::state::State;
use crate::stop::is_active;
use core::future::poll_fn;
use core::task::Poll;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_usb_driver::{EndpointError, EndpointInfo};

/// An endpoint that sends to the host.
pub struct In<'d, R, M: RawMutex, const N: usize> {
    pub(crate) registers: R,
    pub(crate) state: &'d State<M, N>,
    pub(crate) info: EndpointInfo,
}

/// An endpoint that gets packets from the host.
pub struct Out<'d, R, M: RawMutex, const N: usize> {
    pub(crate) registers: R,
    pub(crate) state: &'d State<M, N>,
    pub(crate) info: EndpointInfo,
}

/// Hands a packet to an IN endpoint that has none. Nothing may come between its words.
pub(crate) fn send(registers: impl Registers, n: usize, bytes: &[u8]) {
    registers.write(dieptsiz(n), one_packet(bytes.len()));
    registers.set(diepctl(n), CNAK | EPENA);
    for chunk in bytes.chunks(4) {
        let word = chunk.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
        registers.write(fifo(n), word);
    }
}

impl<R: Registers, M: RawMutex, const N: usize> embassy_usb_driver::Endpoint for In<'_, R, M, N> {
    fn info(&self) -> &EndpointInfo {
        &self.info
    }

    async fn wait_enabled(&mut self) {
        let n = self.info.addr.index();
        poll_fn(|context| {
            self.state.ins.get(n).inspect(|waker| waker.register(context.waker()));
            if is_active(self.registers, diepctl(n)) { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
    }
}

impl<R: Registers, M: RawMutex, const N: usize> embassy_usb_driver::EndpointIn for In<'_, R, M, N> {
    /// Waits until the packet before has reached the host, and hands over this one.
    async fn write(&mut self, buf: &[u8]) -> Result<(), EndpointError> {
        if buf.len() > usize::from(self.info.max_packet_size) {
            return Err(EndpointError::BufferOverflow);
        }
        let (registers, n) = (self.registers, self.info.addr.index());
        poll_fn(|context| {
            self.state.ins.get(n).inspect(|waker| waker.register(context.waker()));
            if !is_active(registers, diepctl(n)) {
                return Poll::Ready(Err(EndpointError::Disabled));
            }
            if registers.read(diepctl(n)) & EPENA != 0 {
                return Poll::Pending;
            }
            self.state.alone(|| send(registers, n, buf));
            Poll::Ready(Ok(()))
        })
        .await
    }
}

impl<R: Registers, M: RawMutex, const N: usize> embassy_usb_driver::Endpoint for Out<'_, R, M, N> {
    fn info(&self) -> &EndpointInfo {
        &self.info
    }

    async fn wait_enabled(&mut self) {
        let n = self.info.addr.index();
        poll_fn(|context| {
            self.state.outs.get(n).inspect(|waker| waker.register(context.waker()));
            if is_active(self.registers, doepctl(n)) { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
    }
}

impl<R: Registers, M: RawMutex, const N: usize> embassy_usb_driver::EndpointOut for Out<'_, R, M, N> {
    /// The next packet. A packet that is longer than `buf` is lost.
    async fn read(&mut self, buf: &mut [u8]) -> Result<usize, EndpointError> {
        let (registers, n) = (self.registers, self.info.addr.index());
        poll_fn(|context| {
            self.state.outs.get(n).inspect(|waker| waker.register(context.waker()));
            if !is_active(registers, doepctl(n)) {
                return Poll::Ready(Err(EndpointError::Disabled));
            }
            let Some(taken) = self.state.take(n, buf) else { return Poll::Pending };
            registers.write(doeptsiz(n), one_packet(self.info.max_packet_size.into()));
            registers.set(doepctl(n), CNAK | EPENA);
            Poll::Ready(taken.map_err(|()| EndpointError::BufferOverflow))
        })
        .await
    }
}
