//! The bus: reset, suspend, resume; endpoints on, off and halted.

use crate::bits::{
    CGONAK, CNAK, DAD, DAINTMSK, DCFG, DCTL, DIEPEMPMSK, DIEPMSK, DOEPMSK, ENUMDNE, EPENA, ESUSP, FULL_SPEED_INTERNAL,
    GAHBCFG, GINT, GINTMSK, GINTSTS, GRXFSIZ, GUSBCFG, IEPINT, OEPINT, RXFLVL, SD0PID, SDIS, SNAK, STALL, STUP,
    THREE_SETUPS, TRDT, USBAEP, USBRST, USBSUSP, WKUPINT, XFRC, diepctl, dieptxf, doepctl, doeptsiz, one_packet,
};
use crate::interrupt::BUS_EVENTS;
use crate::registers::Registers;
use crate::shape::{Config, PACKET, Shape, Shapes};
use crate::state::State;
use crate::stop::stop_in;
use crate::stop_out::stop_out;
use core::future::poll_fn;
use core::task::Poll;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_usb_driver::{Direction, EndpointAddress, Event, Unsupported};

/// Everything that raises the interrupt.
const INTERRUPTS: u32 = BUS_EVENTS | RXFLVL | IEPINT | OEPINT;

/// The bus.
pub struct Bus<'d, R, M: RawMutex, const N: usize> {
    registers: R,
    state: &'d State<M, N>,
    config: Config,
    shapes: Shapes<N>,
    is_started: bool,
}

impl<'d, R: Registers, M: RawMutex, const N: usize> Bus<'d, R, M, N> {
    pub(crate) const fn new(registers: R, state: &'d State<M, N>, config: Config, shapes: Shapes<N>) -> Self {
        Self { registers, state, config, shapes, is_started: false }
    }

    /// Connects to the bus.
    fn start(&mut self) {
        let r = self.registers;
        // Disconnected until all is set. The last write shows the device to the host.
        r.write(DCTL, SDIS);
        r.write(DCFG, FULL_SPEED_INTERNAL);
        r.write(DIEPMSK, XFRC);
        r.write(DOEPMSK, STUP | XFRC);
        r.write(DIEPEMPMSK, 0);
        // Flags from before would count as events of this connection.
        r.write(GINTSTS, u32::MAX);
        r.write(GINTMSK, INTERRUPTS);
        r.set(GAHBCFG, GINT);
        r.write(DCTL, 0);
    }

    /// The next event that `events` of GINTSTS tell of. Several may be latched at once, in the order in which they came
    /// about: what was before a reset is over with it.
    fn event(&mut self, events: u32) -> Option<Event> {
        let r = self.registers;
        let (flags, event) = if events & USBRST != 0 {
            self.state.alone(|| self.reset());
            // A resume after the reset would find it ended.
            (USBRST | USBSUSP | ESUSP | WKUPINT, None)
        } else if events & ENUMDNE != 0 {
            let configuration = r.read(GUSBCFG) & !TRDT;
            r.write(GUSBCFG, configuration | self.config.turnaround << 10);
            (ENUMDNE, Some(Event::Reset))
        } else if events & WKUPINT != 0 {
            // A suspend that is latched beside it is over.
            (WKUPINT | USBSUSP | ESUSP, Some(Event::Resume))
        } else if events & USBSUSP != 0 {
            (USBSUSP | ESUSP, Some(Event::Suspend))
        } else {
            (ESUSP, None)
        };
        r.write(GINTSTS, flags);
        event
    }

    /// The bus was reset: all endpoints are off but endpoint 0, which waits for a request.
    fn reset(&mut self) {
        let (r, state) = (self.registers, self.state);
        (0..N).for_each(|n| stop_in(r, n, false));
        stop_out(r, state, |_| true);
        // A global NAK that nobody here asked for ends too.
        r.write(DCTL, CGONAK);
        state.forget_all();
        // The receive FIFO is first in the memory, and those of the IN endpoints follow it.
        r.write(GRXFSIZ, Shapes::<N>::RECEIVE.into());
        let mut begin = Shapes::<N>::RECEIVE;
        for (n, shape) in self.shapes.ins.iter().enumerate() {
            let Some(shape) = shape else { continue };
            let words = Shapes::<N>::words(*shape);
            r.write(dieptxf(n), u32::from(words) << 16 | u32::from(begin));
            begin += words;
        }
        r.write(doeptsiz(0), THREE_SETUPS | one_packet(PACKET));
        let mask = |shapes: &[Option<Shape>; N]| {
            shapes.iter().enumerate().filter(|(_, shape)| shape.is_some()).fold(0, |mask, (n, _)| mask | 1 << n)
        };
        r.write(DAINTMSK, mask(&self.shapes.ins) | mask(&self.shapes.outs) << 16);
        r.clear(DCFG, DAD);
    }

    fn set_in_enabled(&self, n: usize, shape: Shape, enabled: bool) {
        let r = self.registers;
        stop_in(r, n, false);
        let active = if enabled { USBAEP | SD0PID } else { 0 };
        r.write(diepctl(n), shape.control | SNAK | active);
    }

    fn set_out_enabled(&self, n: usize, shape: Shape, enabled: bool) {
        let (r, state) = (self.registers, self.state);
        stop_out(r, state, |other| other == n);
        state.forget(n);
        if enabled {
            r.write(doeptsiz(n), one_packet(shape.longest.into()));
            r.write(doepctl(n), shape.control | USBAEP | SD0PID | CNAK | EPENA);
        } else {
            r.write(doepctl(n), shape.control | SNAK);
        }
    }

    /// Halts an endpoint, or lets it go on with DATA0 (USB 2.0, section 9.4.5, also if it was not halted).
    fn set_in_stalled(&self, n: usize, stalled: bool) {
        let r = self.registers;
        if stalled {
            stop_in(r, n, true);
        } else {
            let control = r.read(diepctl(n)) & !STALL;
            r.write(diepctl(n), control & !EPENA | SD0PID);
        }
    }

    fn set_out_stalled(&self, n: usize, stalled: bool) {
        let r = self.registers;
        if stalled {
            r.set(doepctl(n), STALL);
        } else {
            let control = r.read(doepctl(n)) & !STALL;
            r.write(doepctl(n), control & !EPENA | SD0PID);
        }
    }

    fn shape(&self, address: EndpointAddress) -> Option<(usize, Shape)> {
        let n = address.index();
        let shapes = match address.direction() {
            Direction::In => &self.shapes.ins,
            Direction::Out => &self.shapes.outs,
        };
        Some((n, (*shapes.get(n)?)?))
    }

    /// Wakes whoever waits for an endpoint.
    fn wake(&self, address: EndpointAddress) {
        let wakers = match address.direction() {
            Direction::In => &self.state.ins,
            Direction::Out => &self.state.outs,
        };
        if let Some(waker) = wakers.get(address.index()) {
            waker.wake();
        }
    }
}

impl<R: Registers, M: RawMutex, const N: usize> embassy_usb_driver::Bus for Bus<'_, R, M, N> {
    async fn enable(&mut self) {}

    async fn disable(&mut self) {}

    async fn poll(&mut self) -> Event {
        poll_fn(|context| {
            if !self.is_started {
                self.start();
                self.is_started = true;
                // Nothing senses VBUS, so power counts as present.
                return Poll::Ready(Event::PowerDetected);
            }
            self.state.bus.register(context.waker());
            loop {
                let events = self.registers.read(GINTSTS) & BUS_EVENTS;
                if events == 0 {
                    // The interrupt took them out when it woke this task.
                    self.state.alone(|| self.registers.write(GINTMSK, INTERRUPTS));
                    return Poll::Pending;
                }
                if let Some(event) = self.event(events) {
                    return Poll::Ready(event);
                }
            }
        })
        .await
    }

    fn endpoint_set_enabled(&mut self, ep_addr: EndpointAddress, enabled: bool) {
        let Some((n, shape)) = self.shape(ep_addr).filter(|(n, _)| *n != 0) else { return };
        self.state.alone(|| match ep_addr.direction() {
            Direction::In => self.set_in_enabled(n, shape, enabled),
            Direction::Out => self.set_out_enabled(n, shape, enabled),
        });
        self.wake(ep_addr);
    }

    fn endpoint_set_stalled(&mut self, ep_addr: EndpointAddress, stalled: bool) {
        let Some((n, _)) = self.shape(ep_addr) else { return };
        self.state.alone(|| match ep_addr.direction() {
            Direction::In => self.set_in_stalled(n, stalled),
            Direction::Out => self.set_out_stalled(n, stalled),
        });
        self.wake(ep_addr);
    }

    fn endpoint_is_stalled(&mut self, ep_addr: EndpointAddress) -> bool {
        let Some((n, _)) = self.shape(ep_addr) else { return false };
        let control = match ep_addr.direction() {
            Direction::In => diepctl(n),
            Direction::Out => doepctl(n),
        };
        self.registers.read(control) & STALL != 0
    }

    async fn remote_wakeup(&mut self) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}
