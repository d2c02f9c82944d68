//! How a computer finds a device on its cable: it sees it, waits, and resets the bus.

use corehbot_usb_model::UsbCore;
use corehbot_usb_model::host::UsbHost;

/// A host waits so long after a device appears, for its contacts (USB 2.0, section 7.1.7.3: TATTDB).
const DEBOUNCE_NS: u64 = 100_000_000;
/// It holds a reset so long, and rests after it (USB 2.0, section 7.1.7.5: TDRSTR and TRSTRCY).
const RESET_NS: u64 = 50_000_000;
const RECOVERY_NS: u64 = 10_000_000;

/// How far it has come.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Discovery {
    /// Nothing is on the cable.
    #[default]
    Alone,
    /// It has seen the device, and waits until then.
    Seen(u64),
    /// It holds the bus in reset until then.
    Resetting(u64),
    /// It rests until then.
    Resting(u64),
    /// The device may be asked.
    Ready,
}

impl Discovery {
    /// Goes on at `now`. Returns when it goes on again, or nothing if the device may be asked or is not there.
    pub fn attend(&mut self, host: &mut UsbHost, core: &mut UsbCore, now: u64) -> Option<u64> {
        if !core.is_connected() {
            *self = Self::Alone;
            return None;
        }
        *self = match *self {
            Self::Alone => Self::Seen(now + DEBOUNCE_NS),
            Self::Seen(until) if now >= until => {
                host.reset(core);
                Self::Resetting(now + RESET_NS)
            }
            Self::Resetting(until) if now >= until => {
                core.end_reset();
                Self::Resting(now + RECOVERY_NS)
            }
            Self::Resting(until) if now >= until => Self::Ready,
            stage => stage,
        };
        match *self {
            Self::Seen(until) | Self::Resetting(until) | Self::Resting(until) => Some(until),
            Self::Alone | Self::Ready => None,
        }
    }
}
