//! Stdata: Shake&Tune's files of several recordings, lines of JSON that zstd packs.
//!
//! Each line is an object with a `name` and `samples`, rows of time in s and acceleration along x, y and z in mm/s^2.
//! Older versions packed an object of Python, which is refused, because only Python itself reads it.

use crate::recording::{Flaw, Recording, Rows};
use ruzstd::decoding::StreamingDecoder;
use serde::Deserialize;
use std::io::Read;

/// First bytes of what zstd packs.
pub const HEAD: &[u8] = b"\x28\xb5\x2f\xfd";

/// Most bytes that are unpacked: a profile of 60 speeds along 4 angles has a fifth of them. A short file can hold
/// endless zeros.
const MOST: u64 = 1 << 31;

/// First byte of a pickled object.
const PICKLE: u8 = 0x80;

#[derive(Deserialize)]
struct Line {
    name: String,
    samples: Vec<[f64; 4]>,
}

/// Reads all recordings with their names.
///
/// # Errors
/// The file is damaged, or a recording would mislead.
pub fn read(packed: &[u8]) -> Result<Vec<(String, Recording)>, Flaw> {
    let text = unpack(packed)?;
    if text.first() == Some(&PICKLE) {
        return Err(Flaw::NotText(
            "an .stdata file of an older Shake&Tune, which only Python reads; \
                                  write it again with a newer one, or as CSV",
        ));
    }
    let mut all = Vec::new();
    for (number, line) in text.split(|byte| *byte == b'\n').enumerate().filter(|(_, l)| !l.trim_ascii().is_empty()) {
        let number = number + 1;
        let Line { name, samples } =
            serde_json::from_slice(line).map_err(|error| Flaw::Json(number, error.to_string()))?;
        let mut rows = Rows::default();
        let recording = samples.into_iter().enumerate().try_for_each(|(i, [time, x, y, z])| {
            // The number of the sample is told as its line.
            rows.push(i + 1, time, [x, y, z])
        });
        let recording = recording.and_then(|()| rows.checked()).map_err(|flaw| Flaw::In(name.clone(), flaw.into()))?;
        all.push((name, recording));
    }
    if all.is_empty() { Err(Flaw::Empty) } else { Ok(all) }
}

/// Every frame of it.
fn unpack(packed: &[u8]) -> Result<Vec<u8>, Flaw> {
    let broken = |_| Flaw::NotText("a broken file packed by zstd; was it copied to its end?");
    let mut text = Vec::new();
    let mut rest = packed;
    while !rest.is_empty() {
        let decoder = StreamingDecoder::new(&mut rest).map_err(|error| broken(error.to_string()))?;
        let left = MOST.saturating_sub(text.len() as u64);
        decoder.take(left).read_to_end(&mut text).map_err(|error| broken(error.to_string()))?;
        if text.len() as u64 >= MOST {
            return Err(Flaw::NotText("a file packed by zstd with more than 2 GB in it"));
        }
    }
    Ok(text)
}
