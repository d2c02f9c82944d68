//! Any bytes: see `sim/board/tests/common/wild_bed.rs`, which tests by seed run as well.
#![no_main]

#[path = "../../sim/board/tests/common/wild_bed.rs"]
mod wild_bed;

libfuzzer_sys::fuzz_target!(|data: &[u8]| wild_bed::bed_gcode(data));
