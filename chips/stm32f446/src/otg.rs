//! OTG_FS: the USB core of the chip, as a device at full speed, below the driver in `chips/usb-device`.
//!
//! Not by embassy-stm32's own module, which expects 48 MHz where embassy-stm32 0.6.0 would have set them (see
//! [`clocks::start_usb`](crate::clocks::start_usb)).

use corehbot_cortex_m4::finish_stores;
use corehbot_usb_device::{Config, Driver, Registers, State, on_interrupt};
use embassy_stm32::pac::{self, RCC};
use embassy_stm32::{interrupt, pac::Interrupt};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;

use crate::interrupt_storm::{CallRate, count_call};
use crate::ports::{self, Speed};
use crate::resources::USB_FUNCTION;
use crate::wiring::USB;

/// The interrupt of the port.
pub const IRQ: Interrupt = Interrupt::OTG_FS;

/// Endpoints of each direction: those of a serial port, and endpoint 0. The core has six (RM0390, 31.3), and one takes
/// 120 bytes of RAM.
const ENDPOINTS: usize = 3;

/// Words of FIFO memory: 1.25 KiB (RM0390, 31.3).
const FIFO: u16 = 320;

/// Turnaround time in clocks of the bus, from 32 MHz on (RM0390, table of TRDT values).
const TURNAROUND: u32 = 6;

/// Polls of a status register, at four cycles of 180 MHz each or more. They take longer than the 25 ms in which the
/// core becomes a device (RM0390, 31.15.4, FDMOD).
const LOOKS: u32 = 2_000_000;

static STATE: State<CriticalSectionRawMutex, ENDPOINTS> = State::new();

/// The driver of the port.
pub type UsbDriver = Driver<'static, Core, CriticalSectionRawMutex, ENDPOINTS>;

/// The registers of the core.
#[derive(Clone, Copy)]
pub struct Core;

impl Core {
    fn at(offset: u32) -> *mut u32 {
        pac::USB_OTG_FS.as_ptr().cast::<u32>().wrapping_byte_add(offset as usize)
    }
}

impl Registers for Core {
    fn read(self, offset: u32) -> u32 {
        // SAFETY: the driver reads registers of the core and its FIFOs alone, which are all words (RM0390, 31.15).
        unsafe { Self::at(offset).read_volatile() }
    }

    fn write(self, offset: u32, value: u32) {
        // SAFETY: as above; no register of the core reaches memory, because it has no DMA.
        unsafe { Self::at(offset).write_volatile(value) }
    }
}

/// Switches the core on, as a device that is not connected yet. Returns `None` if the core does not become a device.
pub fn start() -> Option<UsbDriver> {
    for pin in USB {
        ports::speed_up(pin, Speed::VeryHigh);
        ports::make_alternate(pin, USB_FUNCTION);
        ports::float(pin);
    }
    RCC.ahb2enr().modify(|w| w.set_usb_otg_fsen(true));
    RCC.ahb2rstr().modify(|w| w.set_usb_otg_fsrst(true));
    RCC.ahb2rstr().modify(|w| w.set_usb_otg_fsrst(false));
    let otg = pac::USB_OTG_FS;
    let is_idle = (0..LOOKS).any(|_| otg.grstctl().read().ahbidl());
    otg.gusbcfg().modify(|w| {
        w.set_fdmod(true);
        w.set_physel(true);
    });
    let is_device = (0..LOOKS).any(|_| !otg.gintsts().read().cmod());
    // The transceiver is on. Nothing senses VBUS, because its pin is USART1's transmitter: VBUS counts as present.
    otg.gccfg_v2().modify(|w| {
        w.set_pwrdwn(true);
        w.set_vbden(false);
    });
    otg.gotgctl().modify(|w| {
        w.set_bvaloen(true);
        w.set_bvaloval(true);
    });
    let config = Config { fifo_words: FIFO, turnaround: TURNAROUND };
    (is_idle && is_device).then(|| Driver::new(Core, &STATE, config))
}

#[interrupt]
fn OTG_FS() {
    static RATE: CallRate = CallRate::new();
    count_call(IRQ, &RATE);
    on_interrupt(Core, &STATE);
    finish_stores();
}
