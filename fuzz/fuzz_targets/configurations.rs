//! Any bytes: see `machine-file/tests/support/configurations.rs`, which the property tests run as well.
#![no_main]

#[path = "../../machine-file/tests/support/configurations.rs"]
mod configurations;

libfuzzer_sys::fuzz_target!(|data: &[u8]| configurations::any(data));
