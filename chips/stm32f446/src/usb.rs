//! USB: a serial port (CDC ACM) for the host.

use corehbot::port::{Clock as _, Received, Serial};
use corehbot::units::Instant;
use embassy_stm32::uid;
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use static_cell::StaticCell;

use crate::console_waker::wake_console;
use crate::otg::{self, UsbDriver};
use crate::reset_reason::ResetReason;
use crate::step_timer::BoardClock;
use crate::supply;
use crate::wiring::Board;
use corehbot_board_support::usb_traffic::{Surroundings, Traffic};
use corehbot_usb_device::{Identity, Port};

/// The identity that pid.codes keeps for tests (pid.codes/1209/0001): it belongs to no product, but is shared by all
/// tests. A host that finds a device by it should check manufacturer and product too.
const NUMBERS: [u16; 2] = [0x1209, 0x0001];

static TRAFFIC: Traffic<ThreadModeRawMutex> = Traffic::new();

/// The report that waits for the port to be opened. In [`UsbLine`], every line would have room for one.
static FAREWELL: StaticCell<ResetReason> = StaticCell::new();

/// The Console's end of the port.
pub struct UsbLine {
    /// Why the last reset happened, until a host opens the port: it was closed when the others were told.
    farewell: Option<&'static ResetReason>,
    /// The port has not been opened so far.
    is_new: bool,
}

/// The bus's end of the port.
pub type UsbPort = &'static mut Port<'static, UsbDriver>;

/// The one of [`serve`], which would hold it several times.
static PORT: StaticCell<Port<'static, UsbDriver>> = StaticCell::new();

/// Starts the port of `board`; the host sees it when [`serve`] runs. Returns `None` if the USB core does not start.
pub fn start(board: &'static Board, farewell: Option<ResetReason>) -> Option<(UsbLine, UsbPort)> {
    let identity = Identity { numbers: NUMBERS, texts: ["corehbot", board.name, uid::uid_hex()] };
    let port = Port::new(otg::start()?, identity).ok()?;
    let farewell = farewell.map(|reason| &*FAREWELL.init(reason));
    Some((UsbLine { farewell, is_new: true }, PORT.init(port)))
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
    TRAFFIC.run(port, &Contexts).await;
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
