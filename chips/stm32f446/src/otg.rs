//! OTG_FS: the USB core of the chip, as a device at full speed, below embassy's driver.
//!
//! Not by embassy-stm32's own module, which expects 48 MHz where embassy-stm32 0.6.0 would have set them (see
//! [`clocks::start_usb`](crate::clocks::start_usb)).

use embassy_stm32::pac::{self, RCC};
use embassy_stm32::{interrupt, pac::Interrupt};
use embassy_usb_synopsys_otg::otg_v1::{Otg, vals::Dspd};
use embassy_usb_synopsys_otg::{Config, Driver, OtgInstance, PhyType, State, on_interrupt};

use crate::ports::{self, Speed};
use crate::resources::USB_FUNCTION;
use crate::storm::{CallRate, count_call};
use crate::wiring::USB;

/// The interrupt of the port.
pub const IRQ: Interrupt = Interrupt::OTG_FS;

/// Endpoints of each direction (RM0390, 31.3).
const ENDPOINTS: usize = 6;

/// Words of FIFO memory: 1.25 KiB (RM0390, 31.3).
const FIFO: u16 = 320;

/// Words of the receive FIFO beyond the packets' words: the number in embassy-stm32 0.6.0.
const MORE_FIFO: u16 = 30;

/// Turnaround time in clocks of the bus, from 32 MHz on (RM0390, table of TRDT values).
const TURNAROUND: u8 = 6;

/// Polls of a status register, at four cycles of 180 MHz each or more. They take longer than the 25 ms in which the
/// core becomes a device (RM0390, 31.15.4, FDMOD).
const LOOKS: u32 = 2_000_000;

static STATE: State<ENDPOINTS> = State::new();

/// embassy's driver of the port.
pub type UsbDriver = Driver<'static, ENDPOINTS>;

fn registers() -> Otg {
    // SAFETY: both crates mean the same device; the address is the address of its first register.
    unsafe { Otg::from_ptr(pac::USB_OTG_FS.as_ptr()) }
}

/// Switches the core on, as a device that is not connected yet. `buffer` holds packets from the host, one for each
/// endpoint. Returns `None` if the core does not become a device.
pub fn start(buffer: &'static mut [u8]) -> Option<UsbDriver> {
    for pin in USB {
        ports::speed_up(pin, Speed::VeryHigh);
        ports::make_alternate(pin, USB_FUNCTION);
        ports::float(pin);
    }
    RCC.ahb2enr().modify(|w| w.set_usb_otg_fsen(true));
    RCC.ahb2rstr().modify(|w| w.set_usb_otg_fsrst(true));
    RCC.ahb2rstr().modify(|w| w.set_usb_otg_fsrst(false));
    let otg = registers();
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
    let instance = OtgInstance {
        regs: otg,
        state: &STATE,
        fifo_depth_words: FIFO,
        endpoint_count: ENDPOINTS,
        phy_type: PhyType::InternalFullSpeed,
        extra_rx_fifo_words: MORE_FIFO,
        calculate_trdt_fn: turnaround,
    };
    (is_idle && is_device).then(|| Driver::new(buffer, instance, Config::default()))
}

fn turnaround(_speed: Dspd) -> u8 {
    TURNAROUND
}

#[interrupt]
fn OTG_FS() {
    static RATE: CallRate = CallRate::new();
    count_call(IRQ, &RATE);
    // SAFETY: registers, state and number of endpoints are those that the one driver has.
    unsafe { on_interrupt(registers(), &STATE, ENDPOINTS) }
}
