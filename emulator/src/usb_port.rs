//! The USB port of the chip: the model of its core (`chips/usb-model`) on the bus, with a cable or without.

use crate::decoder::WINDOW;
use corehbot_usb_model::UsbCore;
use rigless::device::{DeviceContext, ErasedDevice, Level, RegisterFile, RequestChange};
use rigless::soc::{Gate, RegisterSpec, Width, Window};
use rigless::time::{EventId, VirtualNanos};
use std::fmt::Debug;
use std::num::NonZeroU64;

/// OTG_FS in the vector table (RM0390 rev 6, table 38).
const INTERRUPTS: &[u16] = &[67];

/// Registers and the FIFOs of six endpoints.
const SIZE: NonZeroU64 = NonZeroU64::new(0x7000).unwrap();

/// The port's place on the bus; it answers while its clock is on.
pub fn window() -> Window {
    let mut window = Window::new("USB_OTG_FS", WINDOW, SIZE);
    window.interrupts = INTERRUPTS;
    window.gate = Some(Gate::by("RCC", "AHB2ENR", "OTGFSEN"));
    window
}

/// What the cable leads to.
pub trait Cable: Debug + Send {
    /// Does what the host does at `now`, in ns. Returns when it comes again, or nothing if it waits for the device.
    fn attend(&mut self, core: &mut UsbCore, now: u64) -> Option<u64>;
}

/// The port.
#[derive(Debug)]
pub struct UsbPort<C> {
    /// The core.
    pub core: UsbCore,
    /// The cable, if one is plugged in.
    pub cable: Option<C>,
    /// The table of registers that the bus has for a window.
    layout: &'static [RegisterSpec],
    is_pending: bool,
    /// When the host comes next.
    next: Option<u64>,
}

/// How often a computer has a look at what it wants to say, when nothing else happens: every ms of emulated time.
pub const IDLE_NS: u64 = 1_000_000;

/// How long a host that waits needs to see a change: a packet of 64 bytes with its token and handshake at 12 Mbit/s.
pub const PACKET_NS: u64 = 50_000;

impl<C: Cable> UsbPort<C> {
    /// A port without a cable.
    pub fn new(layout: &'static [RegisterSpec]) -> Self {
        Self { core: UsbCore::new(), cable: None, layout, is_pending: false, next: None }
    }

    /// Tells the processor, and the host if it waits.
    fn settle(&mut self, context: &mut DeviceContext<'_>) {
        self.drive(context);
        let soon = context.now().0 + PACKET_NS;
        if self.cable.is_some() && self.next.is_none_or(|next| next > soon) {
            self.schedule(soon, context);
        }
    }

    /// Drives the interrupt line.
    fn drive(&mut self, context: &mut DeviceContext<'_>) {
        let is_pending = self.core.is_pending();
        if std::mem::replace(&mut self.is_pending, is_pending) != is_pending {
            context.interrupt(0, if is_pending { Level::High } else { Level::Low });
        }
    }

    fn schedule(&mut self, at: u64, context: &mut DeviceContext<'_>) {
        self.next = Some(at);
        context.schedule(VirtualNanos(at));
    }
}

impl<C: Cable> ErasedDevice for UsbPort<C> {
    fn layout(&self) -> &'static [RegisterSpec] {
        self.layout
    }

    fn read(&mut self, _: usize, _: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        None
    }

    fn write(&mut self, _: usize, _: u64, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn on_event(&mut self, _: EventId, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let now = context.now().0;
        if self.next.is_none_or(|next| next > now) {
            return;
        }
        self.next = None;
        let next = self.cable.as_mut().and_then(|cable| cable.attend(&mut self.core, now));
        if let Some(next) = next {
            self.schedule(next.max(now + 1), context);
        }
        self.drive(context);
    }

    fn on_request(&mut self, _: RequestChange, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn on_clock(&mut self, _: u64, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn poll(&mut self, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn reset(&mut self) {
        self.core.reset();
        (self.is_pending, self.next) = (false, None);
    }

    fn on_access(&mut self, _: u64, _: u64, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn on_refused(&mut self, _: u64, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn read_window(&mut self, offset: u64, _: Width, context: &mut DeviceContext<'_>) -> u64 {
        let value = self.core.read(offset as u32);
        self.settle(context);
        value.into()
    }

    fn write_window(&mut self, offset: u64, _: Width, value: u64, context: &mut DeviceContext<'_>) {
        self.core.write(offset as u32, value as u32);
        self.settle(context);
    }

    fn peek_window(&self, offset: u64, _: Width, _: VirtualNanos) -> Option<u64> {
        self.core.peek(offset as u32).map(u64::from)
    }
}
