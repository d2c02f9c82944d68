//! A USB bus without hardware: the test puts the host's actions into a [`Wire`] and finds the device's actions there.
//!
//! There are no wakers; the test polls everything until nothing changes any more.

use embassy_usb_driver::{
    Bus, ControlPipe, Direction, Driver, Endpoint, EndpointAddress, EndpointAllocError, EndpointError, EndpointIn,
    EndpointInfo, EndpointOut, EndpointType, Event, Unsupported,
};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;

/// The state between host and device.
#[derive(Default)]
pub struct Wire {
    pub events: VecDeque<Event>,
    /// Requests of the host, with their data.
    pub requests: VecDeque<([u8; 8], Vec<u8>)>,
    /// Answers to requests that ask for something, and how many of the others were accepted and rejected.
    pub answers: Vec<u8>,
    pub verdicts: [usize; 2],
    /// Packets to the device that wait for it to ask.
    pub to_device: VecDeque<Vec<u8>>,
    /// The one packet to the host that hardware holds until the host fetches it.
    pub to_host: Option<Vec<u8>>,
    /// Endpoints that are enabled.
    enabled: Vec<EndpointAddress>,
}

#[derive(Clone, Default)]
pub struct Fake(pub Rc<RefCell<Wire>>);

impl Fake {
    /// Ready as soon as `find` finds something on the wire.
    async fn wait<R>(&self, mut find: impl FnMut(&mut Wire) -> Option<R>) -> R {
        poll_fn(|_| find(&mut self.0.borrow_mut()).map_or(Poll::Pending, Poll::Ready)).await
    }

    fn end(&self, kind: EndpointType, size: u16, direction: Direction, given: Option<EndpointAddress>) -> FakeEnd {
        let number = if kind == EndpointType::Bulk { 2 } else { 1 };
        let addr = given.unwrap_or(EndpointAddress::from_parts(number, direction));
        let info = EndpointInfo { addr, ep_type: kind, max_packet_size: size, interval_ms: 1 };
        FakeEnd { wire: self.clone(), info }
    }
}

/// An endpoint. The only one that carries anything in a direction is the bulk endpoint.
pub struct FakeEnd {
    wire: Fake,
    info: EndpointInfo,
}

type Alloc<T> = Result<T, EndpointAllocError>;

impl<'d> Driver<'d> for Fake {
    type EndpointOut = FakeEnd;
    type EndpointIn = FakeEnd;
    type ControlPipe = Self;
    type Bus = Self;

    fn alloc_endpoint_out(
        &mut self,
        kind: EndpointType,
        address: Option<EndpointAddress>,
        size: u16,
        _: u8,
    ) -> Alloc<FakeEnd> {
        Ok(self.end(kind, size, Direction::Out, address))
    }

    fn alloc_endpoint_in(
        &mut self,
        kind: EndpointType,
        address: Option<EndpointAddress>,
        size: u16,
        _: u8,
    ) -> Alloc<FakeEnd> {
        Ok(self.end(kind, size, Direction::In, address))
    }

    fn start(self, _control_size: u16) -> (Self, Self) {
        (self.clone(), self)
    }
}

impl Bus for Fake {
    async fn enable(&mut self) {}

    async fn disable(&mut self) {}

    async fn poll(&mut self) -> Event {
        let event = self.wait(|wire| wire.events.pop_front()).await;
        if event == Event::Reset {
            let mut wire = self.0.borrow_mut();
            wire.enabled.clear();
            wire.to_host = None;
        }
        event
    }

    fn endpoint_set_enabled(&mut self, address: EndpointAddress, enabled: bool) {
        let ends = &mut self.0.borrow_mut().enabled;
        ends.retain(|end| *end != address);
        ends.extend(enabled.then_some(address));
    }

    fn endpoint_set_stalled(&mut self, _: EndpointAddress, _: bool) {}

    fn endpoint_is_stalled(&mut self, _: EndpointAddress) -> bool {
        false
    }

    async fn remote_wakeup(&mut self) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}

impl ControlPipe for Fake {
    fn max_packet_size(&self) -> usize {
        64
    }

    async fn setup(&mut self) -> [u8; 8] {
        self.wait(|wire| {
            let (request, data) = wire.requests.pop_front()?;
            wire.to_device.extend((!data.is_empty()).then_some(data));
            Some(request)
        })
        .await
    }

    async fn data_out(&mut self, into: &mut [u8], _: bool, _: bool) -> Result<usize, EndpointError> {
        let data = self.wait(|wire| wire.to_device.pop_front()).await;
        into[..data.len()].copy_from_slice(&data);
        Ok(data.len())
    }

    async fn data_in(&mut self, data: &[u8], _: bool, _: bool) -> Result<(), EndpointError> {
        self.0.borrow_mut().answers.extend(data);
        Ok(())
    }

    async fn accept(&mut self) {
        self.0.borrow_mut().verdicts[0] += 1;
    }

    async fn reject(&mut self) {
        self.0.borrow_mut().verdicts[1] += 1;
    }

    async fn accept_set_address(&mut self, _: u8) {
        self.accept().await;
    }
}

impl Endpoint for FakeEnd {
    fn info(&self) -> &EndpointInfo {
        &self.info
    }

    async fn wait_enabled(&mut self) {
        self.wire.wait(|wire| wire.enabled.contains(&self.info.addr).then_some(())).await;
    }
}

impl EndpointOut for FakeEnd {
    async fn read(&mut self, into: &mut [u8]) -> Result<usize, EndpointError> {
        let find = |wire: &mut Wire| {
            let is_enabled = wire.enabled.contains(&self.info.addr);
            if is_enabled { wire.to_device.pop_front().map(Ok) } else { Some(Err(EndpointError::Disabled)) }
        };
        let packet = self.wire.wait(find).await?;
        into[..packet.len()].copy_from_slice(&packet);
        Ok(packet.len())
    }
}

impl EndpointIn for FakeEnd {
    async fn write(&mut self, packet: &[u8]) -> Result<(), EndpointError> {
        self.wire
            .wait(|wire| {
                if !wire.enabled.contains(&self.info.addr) {
                    return Some(Err(EndpointError::Disabled));
                }
                wire.to_host.is_none().then(|| {
                    wire.to_host = Some(packet.to_vec());
                    Ok(())
                })
            })
            .await
    }
}
