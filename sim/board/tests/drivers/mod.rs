//! Healthy and faulty motor drivers: the firmware's reaction, and that no motor runs on an unproven driver.

mod failures;
mod own_values;
mod power;
mod script;
mod trust;
mod values;
