//! Properties for any bytes at all, as a G-code file that somebody has: one body for the fuzzer and for the property
//! tests.

use corehbot_gcode_file::{GcodeFileError, Unpacked, plates, unpack};
use std::io::Cursor;

/// Bound of the text, in bytes: far less than what a few bytes inflate to.
const MOST: u64 = 1 << 16;

/// How packed files begin. Bytes behind them reach the readers at once. The first two are binary G-code of version 1,
/// without checksums and with them.
const BEGINS: [&[u8]; 5] =
    [b"GCDE\x01\0\0\0\0\0", b"GCDE\x01\0\0\0\x01\0", b"\x1F\x8B\x08\0\0\0\0\0\0\x03", b"PK\x03\x04", b""];

/// Reads bytes as a file. The first byte chooses its begin, and a plate.
pub fn any(data: &[u8]) {
    let (choice, bytes) = data.split_first().map_or((0, data), |(first, rest)| (usize::from(*first), rest));
    let begin = BEGINS.get(choice % 8).copied().unwrap_or_default();
    let file = [begin, bytes].concat();
    check(&file, (choice >= 128).then_some(choice as u32 % 4));
}

/// Reads a file twice. Both reads agree, nothing exceeds the bound, and an error has its words.
pub fn check(file: &[u8], plate: Option<u32>) {
    let read = || {
        let mut text = Vec::new();
        (unpack(Cursor::new(file), &mut text, plate, MOST), text)
    };
    let (found, text) = read();
    let (again, same) = read();
    assert_eq!(format!("{found:?}"), format!("{again:?}"));
    assert_eq!(text, same);
    assert!(text.len() as u64 <= MOST, "{} bytes", text.len());
    match found {
        Ok(Unpacked::AsItIs) => assert!(text.is_empty()),
        Ok(Unpacked::Written) => assert!(!text.contains(&b'\r')),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    match plates(Cursor::new(file)) {
        Ok(listed) => agree(file, &listed.iter().map(|plate| plate.number).collect::<Vec<_>>()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A listed plate can be chosen, and no number is listed twice.
fn agree(file: &[u8], numbers: &[u32]) {
    for (index, number) in numbers.iter().enumerate() {
        assert!(!numbers[..index].contains(number), "{numbers:?}");
        let found = unpack(Cursor::new(file), std::io::sink(), Some(*number), MOST);
        assert!(!matches!(found, Err(GcodeFileError::NoPlate(..) | GcodeFileError::NoPlates)), "{found:?}");
    }
}
