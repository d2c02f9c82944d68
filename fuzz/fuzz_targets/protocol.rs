//! Any bytes: see `tests/support/bodies.rs`, which the property tests run as well.
#![no_main]

#[path = "../../tests/support/mod.rs"]
mod support;

libfuzzer_sys::fuzz_target!(|data: &[u8]| support::bodies::protocol(data));
