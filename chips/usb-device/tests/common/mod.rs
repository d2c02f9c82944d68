//! A serial port (CDC ACM) on the model of the core, with a host. The port sends back what it gets.

use corehbot_usb_device::{Config, Driver, Identity, Port, Registers, State, on_interrupt};
use corehbot_usb_model::host::{Outcome, Transfer, UsbHost};
use corehbot_usb_model::{Breach, UsbCore};
use embassy_futures::join::join;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_usb::Builder;
use embassy_usb::class::cdc_acm::{self, CdcAcmClass};
use embassy_usb_driver::{Endpoint as _, EndpointIn as _, EndpointOut as _};
use std::cell::{Cell, RefCell};
use std::future::Future;
use std::pin::Pin;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Wake, Waker};

/// Endpoints of each direction, as on the boards.
const N: usize = 3;

/// Requests as Linux makes them.
pub const GET_DEVICE: [u8; 8] = [0x80, 6, 0, 1, 0, 0, 18, 0];
pub const GET_CONFIGURATION: [u8; 8] = [0x80, 6, 0, 2, 0, 0, 255, 0];
pub const SET_ADDRESS: [u8; 8] = [0, 5, 9, 0, 0, 0, 0, 0];
pub const SET_CONFIGURATION: [u8; 8] = [0, 9, 1, 0, 0, 0, 0, 0];
/// The endpoints of the port's data.
pub const TO_DEVICE: usize = 1;
pub const FROM_DEVICE: usize = 2;
/// DTR and RTS of the port.
pub const OPEN: [u8; 8] = [0x21, 0x22, 3, 0, 0, 0, 0, 0];
pub const CLOSE: [u8; 8] = [0x21, 0x22, 0, 0, 0, 0, 0, 0];
/// Rate and format of the port: seven bytes follow.
pub const SET_LINE: [u8; 8] = [0x21, 0x20, 0, 0, 0, 0, 7, 0];
pub const LINE: [u8; 7] = [0, 0xC2, 1, 0, 0, 0, 8];

/// CLEAR_FEATURE(ENDPOINT_HALT) and SET_FEATURE of an endpoint.
pub const fn clear_halt(endpoint: u8) -> [u8; 8] {
    [2, 1, 0, 0, endpoint, 0, 0, 0]
}
pub const fn halt(endpoint: u8) -> [u8; 8] {
    [2, 3, 0, 0, endpoint, 0, 0, 0]
}

thread_local! {
    static DEPTH: Cell<u32> = const { Cell::new(0) };
    static IS_INTERRUPTED: Cell<bool> = const { Cell::new(false) };
}

/// Holds the interrupt of the model off.
pub struct Section;

// SAFETY: a test is one thread, and the interrupt of the model runs in it when `DEPTH` is 0.
unsafe impl RawMutex for Section {
    const INIT: Self = Self;

    fn lock<R>(&self, work: impl FnOnce() -> R) -> R {
        DEPTH.set(DEPTH.get() + 1);
        let result = work();
        DEPTH.set(DEPTH.get() - 1);
        result
    }
}

/// The registers of the model. Its interrupt comes between two accesses of the task, at every `every`-th chance.
#[derive(Clone, Copy)]
pub struct Model {
    core: &'static RefCell<UsbCore>,
    state: &'static State<Section, N>,
    every: &'static Cell<u32>,
    chances: &'static Cell<u32>,
}

/// The identity of the port.
pub const IDENTITY: Identity = Identity { numbers: [0x1209, 1], texts: ["maker", "port", "0123456789AB"] };

impl Model {
    fn new(every: u32) -> Self {
        let (core, state) = (leak(RefCell::new(UsbCore::new())), leak(State::new()));
        Self { core, state, every: leak(Cell::new(every)), chances: leak(Cell::new(0)) }
    }

    fn driver(self) -> Driver<'static, Self, Section, N> {
        Driver::new(self, self.state, Config { fifo_words: 320, turnaround: 6 })
    }

    fn interrupt(self) {
        if self.core.borrow().is_pending() && DEPTH.get() == 0 && !IS_INTERRUPTED.replace(true) {
            on_interrupt(self, self.state);
            IS_INTERRUPTED.set(false);
        }
    }

    fn may_interrupt(self) {
        let every = self.every.get();
        if every == 0 || DEPTH.get() > 0 || IS_INTERRUPTED.get() {
            return;
        }
        self.chances.set(self.chances.get().wrapping_add(1));
        if self.chances.get().is_multiple_of(every) {
            self.interrupt();
        }
    }
}

impl Registers for Model {
    fn read(self, offset: u32) -> u32 {
        self.may_interrupt();
        self.core.borrow_mut().read(offset)
    }

    fn write(self, offset: u32, value: u32) {
        self.may_interrupt();
        self.core.borrow_mut().write(offset, value);
        self.may_interrupt();
    }
}

struct Flag(AtomicBool);

impl Wake for Flag {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// What the port got.
pub type Heard = Rc<RefCell<Vec<u8>>>;

/// The device and its host.
pub struct Bench {
    pub model: Model,
    pub host: UsbHost,
    device: Pin<Box<dyn Future<Output = ()>>>,
    flag: Arc<Flag>,
    /// What the port got.
    pub heard: Heard,
    /// The port takes packets.
    pub listens: Rc<Cell<bool>>,
}

fn leak<T>(value: T) -> &'static mut T {
    Box::leak(Box::new(value))
}

impl Bench {
    /// A device on a bus that nobody has reset.
    pub fn new() -> Self {
        Self::interrupted(0)
    }

    /// A device whose interrupt comes at every `every`-th access to a register, and else when the task waits.
    pub fn interrupted(every: u32) -> Self {
        let model = Model::new(every);
        let Port { mut device, mut to_host, mut from_host } = Port::new(model.driver(), IDENTITY).unwrap();
        let (heard, listens) = (Heard::default(), Rc::new(Cell::new(true)));
        let (hears, gate) = (heard.clone(), listens.clone());
        let port = async move {
            let mut packet = [0; 64];
            loop {
                std::future::poll_fn(
                    |_| if gate.get() { std::task::Poll::Ready(()) } else { std::task::Poll::Pending },
                )
                .await;
                let Ok(length) = from_host.read(&mut packet).await else {
                    from_host.wait_enabled().await;
                    continue;
                };
                hears.borrow_mut().extend(&packet[..length]);
                if to_host.write(&packet[..length]).await.is_err() {
                    to_host.wait_enabled().await;
                }
            }
        };
        let device = Box::pin(async move {
            join(device.run(|_| {}), port).await;
        });
        Self::with(model, device, heard, listens)
    }

    /// The device as `embassy-usb` has it, which nothing is said to.
    pub fn of_embassy() -> Self {
        let model = Model::new(0);
        let mut config = embassy_usb::Config::new(IDENTITY.numbers[0], IDENTITY.numbers[1]);
        let [manufacturer, product, serial] = IDENTITY.texts.map(Some);
        (config.manufacturer, config.product, config.serial_number) = (manufacturer, product, serial);
        let mut builder = Builder::new(model.driver(), config, leak([0; 256]), leak([0; 64]), &mut [], leak([0; 64]));
        let _class = CdcAcmClass::new(&mut builder, leak(cdc_acm::State::new()), 64);
        let mut device = builder.build();
        let device = Box::pin(async move {
            device.run().await;
        });
        Self::with(model, device, Heard::default(), Rc::default())
    }

    fn with(model: Model, device: Pin<Box<dyn Future<Output = ()>>>, heard: Heard, listens: Rc<Cell<bool>>) -> Self {
        let flag = Arc::new(Flag(AtomicBool::new(true)));
        let mut bench = Self { model, host: UsbHost::new(), device, flag, heard, listens };
        bench.settle();
        bench
    }

    /// The device works until it waits for the host.
    pub fn settle(&mut self) {
        let waker = Waker::from(self.flag.clone());
        for _ in 0..10_000 {
            self.model.interrupt();
            let _ = self.device.as_mut().poll(&mut Context::from_waker(&waker));
            if !self.flag.0.swap(false, Ordering::Relaxed) && !self.model.core.borrow().is_pending() {
                return;
            }
        }
        panic!("the device never waits: {:?}", self.core().breaches());
    }

    /// The core.
    pub fn core(&self) -> std::cell::RefMut<'_, UsbCore> {
        self.model.core.borrow_mut()
    }

    /// Does something to the core, as the bus would, and lets the device work.
    pub fn bus(&mut self, work: impl FnOnce(&mut UsbCore)) {
        work(&mut self.core());
        self.settle();
    }

    /// The host has a turn, and the device after it. Returns whether a packet moved.
    pub fn turn(&mut self) -> bool {
        let has_moved = self.host.turn(&mut self.model.core.borrow_mut());
        self.settle();
        has_moved
    }

    /// A transfer, to its end; `None` if it does not end.
    pub fn transfer(&mut self, transfer: Transfer) -> Option<Outcome> {
        let id = self.host.submit(transfer);
        for _ in 0..2_000 {
            self.turn();
            while let Some((ended, outcome)) = self.host.take_ended() {
                if ended == id {
                    return Some(outcome);
                }
            }
        }
        self.host.cancel(id);
        None
    }

    /// A request with data to the device, or none.
    pub fn request(&mut self, setup: [u8; 8], data: &[u8]) -> Option<Outcome> {
        self.transfer(Transfer::Control { setup, data: data.to_vec() })
    }

    /// Resets the bus, as a host does that has found a device.
    pub fn reset(&mut self) {
        self.host.reset(&mut self.model.core.borrow_mut());
        self.settle();
        self.bus(UsbCore::end_reset);
    }

    /// From the reset to the open port.
    pub fn enumerate(&mut self) {
        self.reset();
        let Some(Outcome::Done(device)) = self.request(GET_DEVICE, &[]) else { panic!("no device descriptor") };
        assert_eq!((device.len(), device[0], device[1]), (18, 18, 1));
        for (setup, data) in [(SET_ADDRESS, &[][..]), (SET_CONFIGURATION, &[]), (SET_LINE, &LINE), (OPEN, &[])] {
            assert_eq!(self.request(setup, data), Some(Outcome::Done(Vec::new())), "{setup:?}");
        }
    }

    /// Sends bytes through the port and gets them back.
    pub fn echo(&mut self, bytes: &[u8]) -> Vec<u8> {
        let sent = self.transfer(Transfer::Out { endpoint: TO_DEVICE, data: bytes.to_vec() });
        assert_eq!(sent, Some(Outcome::Done(Vec::new())));
        match self.transfer(Transfer::In { endpoint: FROM_DEVICE, length: bytes.len() }) {
            Some(Outcome::Done(back)) => back,
            other => panic!("{other:?}"),
        }
    }

    /// What was done against the manual.
    pub fn breaches(&self) -> Vec<Breach> {
        self.core().breaches().to_vec()
    }
}
