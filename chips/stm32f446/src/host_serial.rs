//! The lines on which a host may be: the Console serves all of them, and they are one type to it.

use corehbot::port::{Received, Serial};

use crate::usart::UsartLine;
use crate::usb::UsbLine;

/// A line to a host.
pub enum HostSerial {
    /// A USART on a header.
    Usart(UsartLine),
    /// The USB port.
    Usb(UsbLine),
}

impl Serial for HostSerial {
    fn recv(&mut self) -> Option<Received> {
        match self {
            Self::Usart(line) => line.recv(),
            Self::Usb(line) => line.recv(),
        }
    }

    fn overhear(&mut self) -> Option<Received> {
        match self {
            Self::Usart(line) => line.overhear(),
            Self::Usb(line) => line.overhear(),
        }
    }

    fn was_overheard(&self) -> bool {
        match self {
            Self::Usart(line) => line.was_overheard(),
            Self::Usb(line) => line.was_overheard(),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        match self {
            Self::Usart(line) => line.send(bytes),
            Self::Usb(line) => line.send(bytes),
        }
    }
}
