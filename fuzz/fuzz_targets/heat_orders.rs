//! Any bytes: see `tests/support/wild_heat.rs`, which the property tests run as well.
#![no_main]

#[path = "../../tests/support/wild_heat.rs"]
mod wild_heat;

libfuzzer_sys::fuzz_target!(|data: &[u8]| wild_heat::heat_orders(data));
