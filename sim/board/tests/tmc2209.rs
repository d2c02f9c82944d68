//! The model of a TMC2209 follows its datasheet.

use corehbot_sim::tmc2209::{self, Corruption, GSTAT, IFCNT, IHOLD_IRUN, IOIN, Tmc2209, chopconf, gconf};

fn with_crc(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.push(tmc2209::crc(&bytes));
    bytes
}

fn read(chip: &mut Tmc2209, register: u8) -> Option<u32> {
    let reply = chip.exchange(&with_crc(vec![5, 0, register]));
    let [5, 0xFF, echoed, a, b, c, d, sum] = reply[..] else { return None };
    assert_eq!((echoed, sum), (register, tmc2209::crc(&reply[..7])));
    Some(u32::from_be_bytes([a, b, c, d]))
}

fn write(chip: &mut Tmc2209, register: u8, value: u32) {
    let [a, b, c, d] = value.to_be_bytes();
    assert_eq!(chip.exchange(&with_crc(vec![5, 0, register | 0x80, a, b, c, d])), [0u8; 0]);
}

/// Read requests with a last byte from the public record: IFCNT of address 0 is 05 00 02 8F, GCONF 05 00 00 48.
#[test]
fn checksums_are_those_seen_on_real_wires() {
    assert_eq!(tmc2209::crc(&[0x05, 0x00, 0x00]), 0x48);
    assert_eq!(tmc2209::crc(&[0x05, 0x00, 0x02]), 0x8F);
}

#[test]
fn a_new_chip_says_that_it_was_reset_and_runs_by_its_pins() {
    let mut chip = Tmc2209::new(0);
    assert_eq!(read(&mut chip, GSTAT), Some(1));
    assert_eq!(read(&mut chip, IOIN).map(|v| v >> 24), Some(0x21));
    assert_eq!(read(&mut chip, chopconf::ADDRESS), Some(0x1000_0053));
    assert_eq!(chip.microsteps(), 8);
    assert_eq!(Tmc2209::new(3).microsteps(), 16);
    write(&mut chip, GSTAT, 7);
    assert_eq!((read(&mut chip, GSTAT), read(&mut chip, IFCNT)), (Some(0), Some(1)));
    write(&mut chip, chopconf::ADDRESS, 0x1400_0053);
    assert_eq!(chip.microsteps(), 8, "MRES does not count yet");
    write(&mut chip, gconf::ADDRESS, 0x1C0);
    assert_eq!(chip.microsteps(), 16);
    assert_eq!(read(&mut chip, IHOLD_IRUN), Some(0), "write only");
    chip.reset();
    assert_eq!((chip.microsteps(), read(&mut chip, IFCNT)), (8, Some(0)));
}

#[test]
fn what_is_damaged_or_for_another_does_not_count() {
    let mut chip = Tmc2209::new(0);
    let mut request = with_crc(vec![5, 0, 0x80, 0, 0, 1, 0xC0]);
    request[7] ^= 1;
    assert_eq!(chip.exchange(&request), [0u8; 0]);
    assert_eq!(chip.exchange(&with_crc(vec![5, 1, IFCNT])), [0u8; 0]);
    assert_eq!(read(&mut chip, IFCNT), Some(0));
    // Noise before a datagram, and a byte too few before a rest.
    assert_eq!(chip.exchange(&[0xFF, 5, 0]), [0u8; 0]);
    assert_eq!(read(&mut chip, gconf::ADDRESS), Some(0x101));
}

#[test]
fn faults_are_as_asked() {
    let mut chip = Tmc2209::new(0);
    chip.corrupt_reply(1, Corruption::Flip { byte: 4, mask: 0x10 });
    chip.corrupt_reply(2, Corruption::Cut(3));
    let request = with_crc(vec![5, 0, GSTAT]);
    assert!(read(&mut chip, GSTAT).is_some());
    let reply = chip.exchange(&request);
    assert_ne!(tmc2209::crc(&reply[..7]), reply[7]);
    assert_eq!(chip.exchange(&request).len(), 3);
    chip.power_off();
    assert_eq!(chip.exchange(&request), [0u8; 0]);
    chip.power_on();
    chip.is_silent = true;
    assert_eq!(chip.exchange(&request), [0u8; 0]);
}
