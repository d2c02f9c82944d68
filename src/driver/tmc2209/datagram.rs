//! Datagrams: the frames on the one-wire UART of a TMC2209, in both directions.
//!
//! A datagram is sync, address, register and, in a write or a reply, the value with its highest byte first. A checksum
//! ends it (datasheet rev 1.09, sections 4.1 and 4.2).

use super::registers::Register;
use crate::port::Frame;

/// Begins every datagram (section 4.1.1).
const SYNC: u8 = 0x05;

/// Address of every driver, because each has its own wire: MS1 and MS2 low (section 4.1.1).
const DRIVER: u8 = 0;

/// Address in every reply: the master's (section 4.1.2).
const MASTER: u8 = 0xFF;

/// The register bit for a write (section 4.1.1).
const WRITE: u8 = 0x80;

/// Bytes of a reply (section 4.1.2).
pub(super) const REPLY: usize = 8;

/// Frame that asks for a register.
pub(super) fn read(register: Register) -> Frame {
    finish(&[SYNC, DRIVER, register.address()])
}

/// Frame that writes a register.
pub(super) fn write(register: Register, value: u32) -> Frame {
    let [a, b, c, d] = value.to_be_bytes();
    finish(&[SYNC, DRIVER, register.address() | WRITE, a, b, c, d])
}

/// The value of `register` in a reply; `None` if the reply is invalid or damaged.
pub(super) fn value(reply: &[u8], register: Register) -> Option<u32> {
    let [body @ .., sum] = reply else { return None };
    match *body {
        [SYNC, MASTER, address, a, b, c, d] if address == register.address() && checksum(body) == *sum => {
            Some(u32::from_be_bytes([a, b, c, d]))
        }
        _ => None,
    }
}

fn finish(body: &[u8]) -> Frame {
    let mut frame = Frame::new();
    // Eight bytes fit, and no body is longer than seven.
    let _ = frame.extend_from_slice(body);
    let _ = frame.push(checksum(body));
    frame
}

/// CRC-8 with the polynomial x^8 + x^2 + x + 1, fed with the lowest bit of each byte first. Four bits are looked up at
/// once.
fn checksum(bytes: &[u8]) -> u8 {
    let mut sum = 0;
    for byte in bytes.iter().map(|byte| byte.reverse_bits()) {
        for bits in [byte >> 4, byte & 0xF] {
            sum = (sum << 4) ^ CARRIES[usize::from((sum >> 4) ^ bits)];
        }
    }
    sum
}

/// What four bits that leave the checksum add to it.
const CARRIES: [u8; 16] = {
    let mut carries = [0; 16];
    let mut bits = 0;
    while bits < carries.len() {
        let mut sum = (bits as u8) << 4;
        let mut bit = 0;
        while bit < 4 {
            sum = sum << 1 ^ if sum >> 7 == 0 { 0 } else { 0x07 };
            bit += 1;
        }
        carries[bits] = sum;
        bits += 1;
    }
    carries
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_those_seen_on_real_wires() {
        assert_eq!(read(Register::Gconf), [0x05, 0x00, 0x00, 0x48]);
        assert_eq!(read(Register::Ifcnt), [0x05, 0x00, 0x02, 0x8F]);
        assert_eq!(write(Register::Gstat, 7)[..7], [0x05, 0x00, 0x81, 0, 0, 0, 7]);
    }

    #[test]
    fn a_reply_counts_only_if_it_is_whole_and_meant() {
        let reply = finish(&[SYNC, MASTER, 0x6C, 0x10, 0x00, 0x00, 0x53]);
        assert_eq!(value(&reply, Register::Chopconf), Some(0x1000_0053));
        assert_eq!(value(&reply, Register::Gconf), None);
        assert_eq!(value(&reply[..7], Register::Chopconf), None);
        assert_eq!(value(&[], Register::Chopconf), None);
        for place in 0..REPLY {
            for bit in 0..8 {
                let mut damaged = reply.clone();
                damaged[place] ^= 1 << bit;
                assert_eq!(value(&damaged, Register::Chopconf), None);
            }
        }
    }
}
