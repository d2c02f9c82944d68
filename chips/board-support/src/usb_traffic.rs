//! USB traffic: carries packets between the [`Pump`] and a CDC ACM port, whatever hardware is below.

use core::cell::RefCell;
use core::future::poll_fn;
use core::task::Poll;

use corehbot::port::Received;
use corehbot::units::Instant;
use corehbot_usb_device::Port;
use embassy_futures::join::join3;
use embassy_futures::poll_once;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::waitqueue::AtomicWaker;
use embassy_usb_driver::{Driver, EndpointIn, EndpointOut};

use crate::usb_pump::{PACKET, Pump};

/// A port as both of its ends see it. On a board both run in one executor, so `M` need not hold off interrupts.
/// Handling a packet takes 10 us, longer than the bits of a driver's UART may wait.
pub struct Traffic<M: RawMutex> {
    pump: Mutex<M, RefCell<Pump>>,
    /// The host may get a packet, or the port was opened or closed.
    to_host: AtomicWaker,
    /// There is room for a packet from the host.
    from_host: AtomicWaker,
}

/// The hooks that the port needs from the board.
pub trait Surroundings {
    /// Asks for a poll of the Console.
    fn wake_console(&self);

    /// The Console's clock.
    fn now(&self) -> Instant;
}

impl<M: RawMutex> Default for Traffic<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> Traffic<M> {
    /// A closed port; all zeros, so it costs no flash.
    pub const fn new() -> Self {
        Self { pump: Mutex::new(RefCell::new(Pump::new())), to_host: AtomicWaker::new(), from_host: AtomicWaker::new() }
    }

    /// The next event or byte from the host for the Console.
    pub fn recv(&self, now: impl FnOnce() -> Instant) -> Option<Received> {
        let (received, has_more_room) = self.with(|pump| {
            let had_room = pump.has_room();
            let received = pump.recv(now);
            (received, !had_room && pump.has_room())
        });
        if has_more_room {
            self.from_host.wake();
        }
        received
    }

    /// Takes as many of `bytes` as fit and returns their number.
    pub fn send(&self, bytes: &[u8], now: Instant) -> usize {
        let taken = self.with(|pump| pump.send(bytes, now));
        if taken > 0 {
            self.to_host.wake();
        }
        taken
    }

    /// Serves the port for ever.
    pub async fn run<'d, D: Driver<'d>>(&self, port: &mut Port<'d, D>, board: &impl Surroundings) {
        let Port { device, to_host, from_host } = port;
        let serve = device.run(|is_open| self.set_open(is_open, board));
        join3(serve, self.tell(to_host, board), self.hear(from_host, board)).await;
    }

    fn with<R>(&self, work: impl FnOnce(&mut Pump) -> R) -> R {
        self.pump.lock(|pump| work(&mut pump.borrow_mut()))
    }

    fn set_open(&self, is_open: bool, board: &impl Surroundings) {
        let now = board.now();
        if self.with(|pump| pump.set_open(is_open, now)) {
            self.to_host.wake();
            self.from_host.wake();
            board.wake_console();
        }
    }

    /// Ready as soon as `find` finds something.
    async fn wait<R>(&self, waker: &AtomicWaker, mut find: impl FnMut(&mut Pump) -> Option<R>) -> R {
        poll_fn(|context| {
            waker.register(context.waker());
            self.with(&mut find).map_or(Poll::Pending, Poll::Ready)
        })
        .await
    }

    /// From the Console to the host.
    async fn tell(&self, end: &mut impl EndpointIn, board: &impl Surroundings) -> ! {
        let mut packet = [0; PACKET];
        loop {
            let take = |pump: &mut Pump| pump.packet(&mut packet, board.now()).map(|length| (length, pump.session()));
            let (length, session) = self.wait(&self.to_host, take).await;
            let packet = &packet[..length];
            let is_stale = self.wait(&self.to_host, |pump| (pump.session() != session).then_some(()));
            match select(end.write(packet), is_stale).await {
                Either::First(Ok(())) => {
                    self.with(|pump| pump.on_sent(packet));
                    // Room for more output.
                    board.wake_console();
                }
                Either::First(Err(_)) => end.wait_enabled().await,
                Either::Second(()) => {}
            }
        }
    }

    /// From the host to the Console.
    async fn hear(&self, end: &mut impl EndpointOut, board: &impl Surroundings) -> ! {
        let mut packet = [0; PACKET];
        loop {
            self.wait(&self.from_host, |pump| pump.has_room().then_some(())).await;
            if self.with(Pump::take_stray) {
                let _ = poll_once(end.read(&mut packet));
            }
            match end.read(&mut packet).await {
                Ok(length) => {
                    self.with(|pump| pump.on_packet(&packet[..length]));
                    board.wake_console();
                }
                Err(_) => end.wait_enabled().await,
            }
        }
    }
}

#[cfg(test)]
#[path = "fake_usb.rs"]
mod fake_usb;

#[cfg(test)]
#[path = "usb_traffic_tests.rs"]
mod tests;
