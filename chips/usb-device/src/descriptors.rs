//! Descriptors of a serial port: one function of class CDC ACM, as `embassy-usb` 0.6.0 describes it. `tests/answers`
//! compares both, and the answers to requests.

use embassy_usb_driver::{Direction, EndpointAddress};

/// Kinds of descriptors (USB 2.0, table 9-5, and USB 3.2, table 9-6: BOS).
pub const DEVICE: u8 = 1;
/// See [`DEVICE`].
pub const CONFIGURATION: u8 = 2;
/// See [`DEVICE`].
pub const STRING: u8 = 3;
/// See [`DEVICE`].
pub const QUALIFIER: u8 = 6;
/// See [`DEVICE`].
pub const BOS: u8 = 15;

/// Bytes of the packets of the port.
const LONGEST: u8 = 64;

/// Notifications to the host, which nothing here sends; packets from the host; packets to the host.
pub const NOTIFICATIONS: u8 = 0x81;
/// See [`NOTIFICATIONS`].
pub const FROM_HOST: u8 = 0x01;
/// See [`NOTIFICATIONS`].
pub const TO_HOST: u8 = 0x82;

/// The endpoints of the interfaces: of the first, and of the second.
pub const ENDPOINTS: [&[u8]; 2] = [&[NOTIFICATIONS], &[FROM_HOST, TO_HOST]];

/// Bytes of the packets of [`NOTIFICATIONS`], and the frames between two of them.
pub const NOTIFICATION: (u16, u8) = (8, 255);

/// USB 2.1, which has a BOS; a device of several interfaces that an association joins (USB 2.0, ECN on interface
/// association descriptors); control packets of 64 bytes.
const VERSION_AND_CLASS: [u8; 6] = [0x10, 0x02, 0xEF, 2, 1, LONGEST];

/// The device, with the identity that `Identity` has: release 0.1, three strings, one configuration.
pub const fn device([vendor, product]: [u16; 2]) -> [u8; 18] {
    let [v, p] = [vendor.to_le_bytes(), product.to_le_bytes()];
    let [a, b, c, d, e, f] = VERSION_AND_CLASS;
    [18, DEVICE, a, b, c, d, e, f, v[0], v[1], p[0], p[1], 0x10, 0, 1, 2, 3, 1]
}

/// The device at another speed, if it had one.
pub const DEVICE_QUALIFIER: [u8; 10] = {
    let [a, b, c, d, e, f] = VERSION_AND_CLASS;
    [10, QUALIFIER, a, b, c, d, e, f, 1, 0]
};

/// The one capability is the extension of USB 2.0, without link power management.
pub const CAPABILITIES: [u8; 12] = [5, BOS, 12, 0, 1, 7, 16, 2, 0, 0, 0, 0];

/// English of the United States is the language of the strings.
pub const LANGUAGES: [u8; 4] = [4, STRING, 0x09, 0x04];

/// Configuration 1: 100 mA from the bus, and an interface of communication and one of data (CDC 1.1, PSTN 1.2).
#[rustfmt::skip]
pub const PORT: [u8; 70] = [
    9, CONFIGURATION, 70, 0, 2, 1, 0, 0x80, 50,
    // Both interfaces are one function.
    8, 11, 0, 2, 2, 2, 0, 0,
    9, 4, 0, 0, 1, 2, 2, 0, 0,
    // Header, requests for lines and rates, union.
    5, 0x24, 0, 0x10, 0x01,
    4, 0x24, 2, 2,
    5, 0x24, 6, 0, 1,
    7, 5, NOTIFICATIONS, 3, NOTIFICATION.0 as u8, 0, NOTIFICATION.1,
    9, 4, 1, 0, 2, 0x0A, 0, 0, 0,
    7, 5, FROM_HOST, 2, LONGEST, 0, 0,
    7, 5, TO_HOST, 2, LONGEST, 0, 0,
];

/// The address of an endpoint as the driver has it.
pub fn address(endpoint: u8) -> EndpointAddress {
    let direction = if endpoint & 0x80 == 0 { Direction::Out } else { Direction::In };
    EndpointAddress::from_parts(usize::from(endpoint & 0x0F), direction)
}

/// A string descriptor of an ASCII text, as far as it fits.
pub fn string<'b>(text: &str, into: &'b mut [u8]) -> &'b [u8] {
    let mut length = 2;
    for (place, byte) in into.chunks_exact_mut(2).skip(1).zip(text.bytes()) {
        place.copy_from_slice(&[byte, 0]);
        length += 2;
    }
    if let [first, second, ..] = into {
        (*first, *second) = (length as u8, STRING);
    }
    into.get(..length).unwrap_or_default()
}
