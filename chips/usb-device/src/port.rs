//! A serial port (CDC ACM) on any driver of [`embassy_usb_driver`]: it answers the host's requests, and switches its
//! endpoints on.
//!
//! `embassy-usb` does the same for devices of any kind, and composes their descriptors when it runs. Here they are
//! tables. The answers are the same, except that a rate (SET_LINE_CODING) of no known format is given back as it came.

use crate::descriptors::{ENDPOINTS, FROM_HOST, NOTIFICATION, NOTIFICATIONS, TO_HOST, address};
use crate::requests::{Answer, Identity, Request, Requests};
use crate::shape::PACKET;
use core::future::poll_fn;
use core::pin::pin;
use core::task::Poll;
use embassy_usb_driver::{Bus, ControlPipe, Driver, EndpointAllocError, EndpointType, Event};

/// The port before it runs.
pub struct Port<'d, D: Driver<'d>> {
    /// The bus and its requests.
    pub device: Device<'d, D>,
    /// Packets to the host.
    pub to_host: D::EndpointIn,
    /// Packets from the host.
    pub from_host: D::EndpointOut,
}

/// The bus's end of a port.
pub struct Device<'d, D: Driver<'d>> {
    bus: D::Bus,
    control: D::ControlPipe,
    requests: Requests,
}

/// What came first.
enum Happened {
    Event(Event),
    Request([u8; 8]),
}

impl<'d, D: Driver<'d>> Port<'d, D> {
    /// A port on a bus that nobody has started.
    ///
    /// # Errors
    /// If the core has no such endpoints.
    pub fn new(mut driver: D, identity: Identity) -> Result<Self, EndpointAllocError> {
        let (size, interval) = NOTIFICATION;
        let given = Some(address(NOTIFICATIONS));
        driver.alloc_endpoint_in(EndpointType::Interrupt, given, size, interval)?;
        let from_host = driver.alloc_endpoint_out(EndpointType::Bulk, Some(address(FROM_HOST)), PACKET as u16, 0)?;
        let to_host = driver.alloc_endpoint_in(EndpointType::Bulk, Some(address(TO_HOST)), PACKET as u16, 0)?;
        let (bus, control) = driver.start(PACKET as u16);
        Ok(Self { device: Device { bus, control, requests: Requests::new(identity) }, to_host, from_host })
    }
}

impl<'d, D: Driver<'d>> Device<'d, D> {
    /// Serves the bus for ever. Tells `on_line` whether the host has the port open, whenever that may have changed.
    pub async fn run(&mut self, mut on_line: impl FnMut(bool)) -> ! {
        loop {
            match self.next().await {
                // A suspended bus needs nothing: a request comes only after it has resumed.
                Happened::Event(Event::Suspend | Event::Resume) => {}
                Happened::Event(Event::Reset) => {
                    self.requests.reset();
                    on_line(false);
                }
                Happened::Event(Event::PowerDetected) => self.bus.enable().await,
                Happened::Event(Event::PowerRemoved) => self.bus.disable().await,
                Happened::Request(request) => self.answer(&Request::of(request), &mut on_line).await,
            }
        }
    }

    /// Events first: a reset ends the requests before it.
    async fn next(&mut self) -> Happened {
        let (mut event, mut request) = (pin!(self.bus.poll()), pin!(self.control.setup()));
        poll_fn(|context| {
            if let Poll::Ready(event) = event.as_mut().poll(context) {
                return Poll::Ready(Happened::Event(event));
            }
            request.as_mut().poll(context).map(Happened::Request)
        })
        .await
    }

    /// Answers a request, unless the host gives it up.
    async fn answer(&mut self, request: &Request, on_line: &mut impl FnMut(bool)) {
        let mut packet = [0; PACKET];
        let answer = if request.is_in() {
            let is_halted = |endpoint| self.bus.endpoint_is_stalled(address(endpoint));
            match self.requests.find(request, &mut packet, is_halted) {
                Some(found) => {
                    let found = found.get(..request.length).unwrap_or(found);
                    return self.send(found, request.length).await;
                }
                None => Answer::Reject,
            }
        } else {
            let data = match packet.get_mut(..request.length) {
                None => None,
                Some([]) => Some(0),
                Some(into) => match self.control.data_out(into, true, true).await {
                    Ok(length) => Some(length),
                    Err(_) => return,
                },
            };
            match data.and_then(|length| packet.get(..length)) {
                None => Answer::Reject,
                Some(data) => self.requests.take(request, data),
            }
        };
        // Before the answer, as the host may send as soon as it has that.
        on_line(self.requests.is_open());
        match answer {
            Answer::Reject => return self.control.reject().await,
            Answer::Address(address) => return self.control.accept_set_address(address).await,
            Answer::Accept => {}
            Answer::Switch { interfaces, is_on } => {
                let endpoints = ENDPOINTS.get(interfaces).unwrap_or_default().iter().copied().flatten();
                endpoints.for_each(|endpoint| self.bus.endpoint_set_enabled(address(*endpoint), is_on));
            }
            Answer::Halt { endpoint, is_halted } => self.bus.endpoint_set_stalled(address(endpoint), is_halted),
        }
        self.control.accept().await;
    }

    /// Sends an answer of at most `wanted` bytes. An empty packet ends one that is shorter and ends with a full packet.
    async fn send(&mut self, mut rest: &[u8], wanted: usize) {
        if wanted == 0 {
            // `embassy-usb` sends nothing then, and the host goes on to its next request.
            return;
        }
        let is_short = rest.len() < wanted;
        let mut is_first = true;
        loop {
            let (packet, next) = rest.split_at(rest.len().min(PACKET));
            let is_last = next.is_empty() && !(is_short && packet.len() == PACKET);
            if self.control.data_in(packet, is_first, is_last).await.is_err() || is_last {
                return;
            }
            (rest, is_first) = (next, false);
        }
    }
}
