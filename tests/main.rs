//! The core through its public items, room by room, against models; and the documents against the code.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "support/actions.rs"]
mod actions;
#[path = "support/arrows.rs"]
mod arrows;
#[path = "support/belt_equations.rs"]
mod belt_equations;
#[path = "support/clock.rs"]
mod clock;
#[path = "support/dice.rs"]
mod dice;
mod driver;
mod faults;
mod gcode;
mod gcode_words;
mod golden_steps;
mod keys;
mod layers;
#[path = "support/line.rs"]
mod line;
mod line_noise;
mod line_properties;
mod line_protocol;
mod line_receiver;
mod line_silence;
mod links;
mod mechanisms;
mod motion;
mod owners;
#[path = "support/printer.rs"]
mod printer;
mod programs;
mod reference;
mod replies;
mod setting_ranges;
mod setting_rows;
#[path = "support/sources.rs"]
mod sources;
mod stepper;
mod storage;
mod support;
mod surface;
mod thermal;
#[path = "support/wild_heat.rs"]
mod wild_heat;
