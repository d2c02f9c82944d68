//! The other end of the USB cable: a computer of this program, or a real one.

use crate::usb_line::UsbLine;
use crate::usb_port::Cable;
use crate::usbip::UsbIp;
use corehbot_usb_model::UsbCore;

/// The other end of the USB cable.
#[derive(Debug)]
pub enum Plug {
    /// A computer of this program.
    Line(Box<UsbLine>),
    /// A real computer.
    Network(Box<UsbIp>),
}

impl Cable for Plug {
    fn attend(&mut self, core: &mut UsbCore, now: u64) -> Option<u64> {
        match self {
            Self::Line(line) => line.attend(core, now),
            Self::Network(network) => network.attend(core, now),
        }
    }
}
