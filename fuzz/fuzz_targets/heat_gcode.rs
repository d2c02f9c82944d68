//! Any bytes: see `sim/board/tests/common/wild_gcode.rs`, which the property tests run as well.
#![no_main]

#[path = "../../sim/board/tests/common/wild_gcode.rs"]
mod wild_gcode;

libfuzzer_sys::fuzz_target!(|data: &[u8]| wild_gcode::heat_gcode(data));
