//! Any bytes as a packed file: see `gcode-file/tests/support/packed_bytes.rs`, which the property tests run as well.
#![no_main]

#[path = "../../gcode-file/tests/support/packed_bytes.rs"]
mod packed_bytes;

libfuzzer_sys::fuzz_target!(|data: &[u8]| packed_bytes::any(data));
