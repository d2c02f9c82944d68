//! Endpoint 0: requests of the host.
//!
//! A host may give up a request at any time and send another one. Whatever waits then ends, with
//! [`EndpointError::Disabled`] if it has an answer.

use crate::bits::{CNAK, DAD, DCFG, EPENA, STALL, THREE_SETUPS, diepctl, doepctl, doeptsiz, one_packet};
use crate::endpoint::send;
use crate::registers::Registers;
use crate::shape::PACKET;
use crate::state::State;
use core::future::poll_fn;
use core::task::Poll;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_usb_driver::EndpointError;

/// Endpoint 0.
pub struct ControlPipe<'d, R, M: RawMutex, const N: usize> {
    pub(crate) registers: R,
    pub(crate) state: &'d State<M, N>,
}

impl<R: Registers, M: RawMutex, const N: usize> ControlPipe<'_, R, M, N> {
    /// Does a part of the answer to a request, unless the host has given it up: the answer would go to the next one.
    fn answer(&self, work: impl FnOnce()) -> Result<(), EndpointError> {
        self.state.alone(|| {
            if self.state.has_request() {
                return Err(EndpointError::Disabled);
            }
            work();
            Ok(())
        })
    }

    /// Lets the host send a packet.
    fn expect(&self) -> Result<(), EndpointError> {
        self.answer(|| {
            self.state.forget(0);
            self.registers.write(doeptsiz(0), THREE_SETUPS | one_packet(PACKET));
            self.registers.set(doepctl(0), CNAK | EPENA);
        })
    }

    /// Ready when `find` finds something, or when the host has given up the request.
    async fn wait<T>(&self, mut find: impl FnMut() -> Option<T>) -> Result<T, EndpointError> {
        poll_fn(|context| {
            self.state.ins.first().inspect(|waker| waker.register(context.waker()));
            self.state.outs.first().inspect(|waker| waker.register(context.waker()));
            if self.state.has_request() {
                return Poll::Ready(Err(EndpointError::Disabled));
            }
            find().map_or(Poll::Pending, |found| Poll::Ready(Ok(found)))
        })
        .await
    }

    /// The packet before has reached the host.
    async fn wait_sent(&self) -> Result<(), EndpointError> {
        self.wait(|| (self.registers.read(diepctl(0)) & EPENA == 0).then_some(())).await
    }

    /// Hands a packet to the host, unless it has given up the request.
    async fn send(&self, bytes: &[u8]) -> Result<(), EndpointError> {
        self.wait_sent().await?;
        self.answer(|| send(self.registers, 0, bytes))
    }

    /// The next packet of the host.
    async fn take(&self, buffer: &mut [u8]) -> Result<usize, EndpointError> {
        let taken = self.wait(|| self.state.take(0, buffer)).await?;
        taken.map_err(|()| EndpointError::BufferOverflow)
    }
}

impl<R: Registers, M: RawMutex, const N: usize> embassy_usb_driver::ControlPipe for ControlPipe<'_, R, M, N> {
    fn max_packet_size(&self) -> usize {
        PACKET
    }

    async fn setup(&mut self) -> [u8; 8] {
        poll_fn(|context| {
            self.state.outs.first().inspect(|waker| waker.register(context.waker()));
            let Some(request) = self.state.take_request() else { return Poll::Pending };
            // Three more SETUP packets in a row; packets of data are not expected yet.
            self.registers.write(doeptsiz(0), THREE_SETUPS | one_packet(PACKET));
            Poll::Ready(request)
        })
        .await
    }

    async fn data_out(&mut self, buf: &mut [u8], _: bool, _: bool) -> Result<usize, EndpointError> {
        self.expect()?;
        self.take(buf).await
    }

    async fn data_in(&mut self, data: &[u8], _: bool, last: bool) -> Result<(), EndpointError> {
        if last {
            // The host ends the request with an empty packet.
            self.expect()?;
        }
        self.send(data).await?;
        if last {
            self.take(&mut []).await?;
        }
        Ok(())
    }

    async fn accept(&mut self) {
        // A request that was given up needs no answer.
        if self.send(&[]).await.is_ok() {
            _ = self.wait_sent().await;
        }
    }

    async fn reject(&mut self) {
        _ = self.answer(|| {
            self.registers.set(diepctl(0), STALL);
            self.registers.set(doepctl(0), STALL);
        });
    }

    /// The core answers to the new address after the status stage (RM0390 rev 6, section 31.16.4).
    async fn accept_set_address(&mut self, addr: u8) {
        let configuration = self.registers.read(DCFG) & !DAD;
        self.registers.write(DCFG, configuration | u32::from(addr) << 4);
        self.accept().await;
    }
}
