//! Any bytes: see `sim/board/tests/common/wild_machine.rs`, which the property tests run as well.
#![no_main]

#[path = "../../sim/board/tests/common/wild_machine.rs"]
mod wild_machine;

libfuzzer_sys::fuzz_target!(|data: &[u8]| wild_machine::dialogue(data));
