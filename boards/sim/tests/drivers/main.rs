//! Healthy and faulty motor drivers: the firmware's reaction, and that no motor runs on an unproven driver.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod failures;
mod own_values;
mod power;
mod script;
mod trust;
mod values;
