//! The host's requests to a serial port (USB 2.0, 9.4; PSTN 1.2, 6.3), and what it has set by them.

use crate::descriptors::{
    BOS, CAPABILITIES, CONFIGURATION, DEVICE, DEVICE_QUALIFIER, LANGUAGES, PORT, QUALIFIER, STRING, device, string,
};
use core::ops::Range;

/// The identity of a device. All texts are ASCII, of at most 31 letters.
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// The numbers of vendor and product.
    pub numbers: [u16; 2],
    /// The names of manufacturer and product, and the serial number.
    pub texts: [&'static str; 3],
}

/// A request of the host.
pub struct Request {
    /// bmRequestType without the direction: kind and recipient.
    target: u8,
    is_in: bool,
    code: u8,
    value: u16,
    index: u16,
    /// Bytes that follow, or that the host wants at most.
    pub length: usize,
}

impl Request {
    /// The request of a SETUP packet.
    pub fn of([target, code, v, value, i, index, l, length]: [u8; 8]) -> Self {
        Self {
            target: target & 0x7F,
            is_in: target & 0x80 != 0,
            code,
            value: u16::from_le_bytes([v, value]),
            index: u16::from_le_bytes([i, index]),
            length: u16::from_le_bytes([l, length]).into(),
        }
    }

    /// Whether the host wants to know something.
    pub const fn is_in(&self) -> bool {
        self.is_in
    }
}

/// What a request is for: standard requests to the device, an interface and an endpoint, and the class's to an
/// interface (USB 2.0, table 9-2).
const OF_DEVICE: u8 = 0x00;
const OF_INTERFACE: u8 = 0x01;
const OF_ENDPOINT: u8 = 0x02;
const OF_PORT: u8 = 0x21;

/// Codes of standard requests (USB 2.0, table 9-4).
const GET_STATUS: u8 = 0;
const CLEAR_FEATURE: u8 = 1;
const SET_FEATURE: u8 = 3;
const SET_ADDRESS: u8 = 5;
const GET_DESCRIPTOR: u8 = 6;
const GET_CONFIGURATION: u8 = 8;
const SET_CONFIGURATION: u8 = 9;
const GET_INTERFACE: u8 = 10;
const SET_INTERFACE: u8 = 11;

/// Features (USB 2.0, table 9-6).
const ENDPOINT_HALT: u16 = 0;
const REMOTE_WAKEUP: u16 = 1;

/// Codes of the class (PSTN 1.2, table 13). The first is accepted and does nothing, as in `embassy-usb`.
const SEND_ENCAPSULATED_COMMAND: u8 = 0x00;
const SET_LINE_CODING: u8 = 0x20;
const GET_LINE_CODING: u8 = 0x21;
const SET_CONTROL_LINE_STATE: u8 = 0x22;

/// Bytes of a rate with its format.
const CODING: usize = 7;

/// The rate after a reset, which nothing uses: 8,000 baud, 8 bits, one stop bit, no parity.
const FIRST_CODING: [u8; CODING] = [0x40, 0x1F, 0, 0, 0, 0, 8];

/// What a request without an answer in bytes asks for.
pub enum Answer {
    /// It cannot be done.
    Reject,
    /// It is done.
    Accept,
    /// It is done after the device has this address.
    Address(u8),
    /// The endpoints of these interfaces go on or off.
    Switch { interfaces: Range<usize>, is_on: bool },
    /// An endpoint is halted or goes on.
    Halt { endpoint: u8, is_halted: bool },
}

/// What the host has set.
pub struct Requests {
    identity: Identity,
    is_configured: bool,
    may_wake: bool,
    /// The host has opened the port (DTR).
    is_open: bool,
    coding: [u8; CODING],
}

impl Requests {
    /// Nothing is set.
    pub const fn new(identity: Identity) -> Self {
        Self { identity, is_configured: false, may_wake: false, is_open: false, coding: FIRST_CODING }
    }

    /// The bus was reset.
    pub const fn reset(&mut self) {
        *self = Self::new(self.identity);
    }

    /// Whether the host has opened the port.
    pub const fn is_open(&self) -> bool {
        self.is_open
    }

    /// What the host wants to know, in `buffer` or not; `None` if there is no such thing.
    pub fn find<'b>(
        &self,
        request: &Request,
        buffer: &'b mut [u8],
        is_halted: impl FnOnce(u8) -> bool,
    ) -> Option<&'b [u8]> {
        let is_interface = request.index <= 1;
        let (status, length) = match (request.target, request.code) {
            (OF_DEVICE, GET_DESCRIPTOR) => return self.descriptor(request.value, buffer),
            (OF_PORT, GET_LINE_CODING) if request.index == 0 && request.length == CODING => {
                return copy(&self.coding, buffer);
            }
            (OF_DEVICE, GET_STATUS) => (u8::from(self.may_wake) << 1, 2),
            (OF_DEVICE, GET_CONFIGURATION) => (self.is_configured.into(), 1),
            (OF_INTERFACE, GET_STATUS) if is_interface => (0, 2),
            (OF_INTERFACE, GET_INTERFACE) if is_interface => (0, 1),
            (OF_ENDPOINT, GET_STATUS) => (is_halted(endpoint_of(request)).into(), 2),
            _ => return None,
        };
        copy([status, 0].get(..length)?, buffer)
    }

    /// The descriptor of that kind and number.
    fn descriptor<'b>(&self, kind_and_number: u16, buffer: &'b mut [u8]) -> Option<&'b [u8]> {
        let [number, kind] = kind_and_number.to_le_bytes();
        match kind {
            DEVICE => copy(&device(self.identity.numbers), buffer),
            CONFIGURATION => Some(&PORT),
            STRING => match usize::from(number).checked_sub(1) {
                None => Some(&LANGUAGES),
                Some(text) => Some(string(self.identity.texts.get(text)?, buffer)),
            },
            QUALIFIER => Some(&DEVICE_QUALIFIER),
            BOS => Some(&CAPABILITIES),
            _ => None,
        }
    }

    /// Takes what the host sets.
    pub fn take(&mut self, request: &Request, data: &[u8]) -> Answer {
        let Request { value, index, code, .. } = *request;
        match (request.target, code) {
            (OF_DEVICE, CLEAR_FEATURE | SET_FEATURE) if value == REMOTE_WAKEUP => {
                self.may_wake = code == SET_FEATURE;
                Answer::Accept
            }
            (OF_DEVICE, SET_ADDRESS) => match value {
                1..=127 => Answer::Address(value as u8),
                _ => Answer::Reject,
            },
            (OF_DEVICE, SET_CONFIGURATION) if value <= 1 => {
                self.is_configured = value == 1;
                Answer::Switch { interfaces: 0..2, is_on: self.is_configured }
            }
            // There is one setting of each, and choosing it restarts the endpoints.
            (OF_INTERFACE, SET_INTERFACE) if index as u8 <= 1 && value as u8 == 0 => {
                let interface = usize::from(index as u8);
                Answer::Switch { interfaces: interface..interface + 1, is_on: true }
            }
            (OF_ENDPOINT, CLEAR_FEATURE | SET_FEATURE) if value == ENDPOINT_HALT => {
                Answer::Halt { endpoint: endpoint_of(request), is_halted: code == SET_FEATURE }
            }
            (OF_PORT, SEND_ENCAPSULATED_COMMAND) if index == 0 => Answer::Accept,
            (OF_PORT, SET_LINE_CODING) if index == 0 => match data.first_chunk() {
                Some(coding) => {
                    self.coding = *coding;
                    Answer::Accept
                }
                None => Answer::Reject,
            },
            (OF_PORT, SET_CONTROL_LINE_STATE) if index == 0 => {
                self.is_open = value & 1 != 0;
                Answer::Accept
            }
            _ => Answer::Reject,
        }
    }
}

/// Those bytes in the buffer.
fn copy<'b>(bytes: &[u8], buffer: &'b mut [u8]) -> Option<&'b [u8]> {
    let into = buffer.get_mut(..bytes.len())?;
    into.copy_from_slice(bytes);
    Some(into)
}

/// The endpoint that a request is about.
const fn endpoint_of(request: &Request) -> u8 {
    request.index as u8 & 0x8F
}
