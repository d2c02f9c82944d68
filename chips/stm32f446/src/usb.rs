//! USB: a serial port (CDC ACM) for the host.

use corehbot::port::{Clock as _, Received, Serial};
use corehbot::units::Instant;
use embassy_stm32::uid;
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_usb::class::cdc_acm::{CdcAcmClass, State};
use embassy_usb::{Builder, Config, UsbDevice};
use static_cell::{ConstStaticCell, StaticCell};

use crate::console_waker::wake_console;
use crate::otg::{self, UsbDriver};
use crate::reset_reason::ResetReason;
use crate::step_timer::BoardClock;
use crate::supply;
use crate::wiring::Board;
use corehbot_board_support::usb_pump::PACKET;
use corehbot_board_support::usb_traffic::{Surroundings, Traffic};

/// The identity that pid.codes keeps for tests (pid.codes/1209/0001): it belongs to no product, but is shared by all
/// tests. A host that finds a device by it should check manufacturer and product too.
const IDENTITY: (u16, u16) = (0x1209, 0x0001);

/// Descriptors and packets.
struct Memory {
    /// 70 bytes are used: a configuration with two interfaces and three endpoints.
    configuration: [u8; 128],
    /// 12 bytes are used.
    capabilities: [u8; 32],
    control: [u8; PACKET],
}

static MEMORY: ConstStaticCell<Memory> =
    ConstStaticCell::new(Memory { configuration: [0; 128], capabilities: [0; 32], control: [0; PACKET] });
static STATE: StaticCell<State<'static>> = StaticCell::new();
static TRAFFIC: Traffic<ThreadModeRawMutex> = Traffic::new();

/// The Console's end of the port.
pub struct UsbLine {
    /// Why the last reset happened, until a host opens the port: it was closed when the others were told.
    farewell: Option<ResetReason>,
    /// The port has not been opened so far.
    is_new: bool,
}

/// The bus's end of the port.
pub struct UsbPort {
    device: UsbDevice<'static, UsbDriver>,
    class: CdcAcmClass<'static, UsbDriver>,
}

/// Starts the port of `board`; the host sees it when [`serve`] runs. Returns `None` if the USB core does not start.
///
/// # Panics
/// If it was started before.
pub fn start(board: &'static Board, farewell: Option<ResetReason>) -> Option<(UsbLine, UsbPort)> {
    let memory = MEMORY.take();
    let driver = otg::start()?;
    let mut config = Config::new(IDENTITY.0, IDENTITY.1);
    config.manufacturer = Some("corehbot");
    config.product = Some(board.name);
    config.serial_number = Some(uid::uid_hex());
    let (configuration, capabilities) = (&mut memory.configuration, &mut memory.capabilities);
    let mut builder = Builder::new(driver, config, configuration, capabilities, &mut [], &mut memory.control);
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET as u16);
    Some((UsbLine { farewell, is_new: true }, UsbPort { device: builder.build(), class }))
}

/// The contexts that run besides the port.
struct Contexts;

impl Surroundings for Contexts {
    fn wake_console(&self) {
        wake_console();
    }

    fn now(&self) -> Instant {
        BoardClock.now()
    }
}

/// Serves the port for ever.
#[embassy_executor::task]
pub async fn serve(port: UsbPort) {
    TRAFFIC.run(port.device, port.class, Contexts).await;
}

impl Serial for UsbLine {
    fn recv(&mut self) -> Option<Received> {
        let received = TRAFFIC.recv(|| BoardClock.now());
        if received == Some(Received::Opened) && core::mem::take(&mut self.is_new) {
            if let Some(words) = self.farewell.take() {
                words.parts().into_iter().for_each(|part| _ = self.send(part.as_bytes()));
            }
            supply::warning_parts().for_each(|part| _ = self.send(part.as_bytes()));
        }
        received
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        TRAFFIC.send(bytes, BoardClock.now())
    }
}
