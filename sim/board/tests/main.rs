//! The whole firmware in the simulator: prints, hosts, heat, the bed, the belt.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod absurd;
mod accidents;
mod any_machine;
mod axis_moves;
mod bed;
mod bed_visualizer;
mod beds_of_machines;
mod belt;
mod braking;
#[path = "../../../tests/support/btt_tft.rs"]
mod btt_tft;
mod cancels;
mod circles;
mod commands;
mod common;
mod console;
mod dense;
mod determinism;
mod drivers;
#[path = "../../../tests/support/eeprom_marlin.rs"]
mod eeprom_marlin;
mod emergencies;
mod every_setting;
#[path = "../../../tests/support/extent.rs"]
mod extent;
mod fans;
mod filament;
mod first_layer;
mod floods;
mod heat;
mod heat_lives;
mod heat_timeout;
mod host_pauses;
mod hosts;
mod lookahead_time;
mod machines;
mod mesh;
mod move_limits;
mod no_reading;
mod offsets;
mod overrides;
mod paused;
mod pauses;
mod print_words;
mod protocol;
mod resonance;
mod restart;
mod retraction;
mod retried;
mod safe_z_home;
mod screens;
mod second_sensor;
mod self_test;
mod shaper_changes;
mod shaping;
mod silent_hosts;
mod sliced;
mod slow_axes;
mod slow_lines;
mod slowness;
mod soak;
mod start_blocks;
mod stopped;
mod supply;
#[path = "../../../tests/support/mod.rs"]
mod support;
mod tmc2209;
mod touches;
mod underrun;
mod wild_bed;
mod wild_gcode;
