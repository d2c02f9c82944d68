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

/// What a file has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// The recordings with their names.
    pub recordings: Vec<(String, Recording)>,
    /// Recordings that would mislead, and are left out: each a [`Flaw::In`].
    pub left_out: Vec<Flaw>,
}

/// Reads all recordings. One run of a hundred that is too short or has a gap spoils no other.
///
/// # Errors
/// The file is damaged, or all of its recordings would mislead; the first flaw is told.
pub fn read(packed: &[u8]) -> Result<Contents, Flaw> {
    let text = unpack(packed)?;
    if text.first() == Some(&PICKLE) {
        return Err(Flaw::NotText(
            "an .stdata file of an older Shake&Tune, which only Python reads; \
                                  write it again with a newer one, or as CSV",
        ));
    }
    let mut all = Contents::default();
    for (number, line) in text.split(|byte| *byte == b'\n').enumerate().filter(|(_, l)| !l.trim_ascii().is_empty()) {
        let number = number + 1;
        let Line { name, samples } =
            serde_json::from_slice(line).map_err(|error| Flaw::Json(number, error.to_string()))?;
        let mut rows = Rows::default();
        let recording = samples.into_iter().enumerate().try_for_each(|(i, [time, x, y, z])| {
            // The number of the sample is told as its line.
            rows.push(i + 1, time, [x, y, z])
        });
        match recording.and_then(|()| rows.checked()) {
            Ok(recording) => all.recordings.push((name, recording)),
            Err(flaw) => all.left_out.push(Flaw::In(name, flaw.into())),
        }
    }
    if all.recordings.is_empty() {
        return Err(all.left_out.into_iter().next().unwrap_or(Flaw::Empty));
    }
    Ok(all)
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
