//! Resonance: analysis of an accelerometer's recordings of a printer's tool, of any machine.
//!
//! Everything here is computed from samples in memory. There are no files, threads or clocks, so it runs in a browser
//! too. A file uses only those above it:
//!
//! | file | job |
//! |---|---|
//! | [`label`] | axis, speed and angle that a file's name tells |
//! | [`recording`] | text of a raw file to checked samples |
//! | [`stdata`] | files of Shake&Tune with several recordings |
//! | [`spectrum`] | power spectral density, as Klipper computes it |
//! | [`density`] | files with spectra instead of samples |
//! | [`spectrogram`] | power over time and frequency, to look at |
//! | [`sweep`] | the commanded acceleration of a sweep |
//! | [`gcode`] | the same sweep as G-code |
//! | [`modes`] | frequencies and dampings, fitted to the response |
//! | [`shapers`] | shapers that are compared: those of this firmware, and one that only Klipper has |
//! | [`klipper`] | Klipper's score and choice |
//! | [`axis`] | an axis: modes, both rankings, the line that sets a shaper |
//! | [`belts`] | comparison of two belt paths |
//! | [`run`] | vibration at one speed along one angle |
//! | [`motors`] | what each pair of motors does to the tool, by its frequency |
//! | [`symmetry`] | how alike directions are that mirror each other |
//! | [`profile`] | vibration by speed and angle |
#![forbid(unsafe_code)]

pub mod axis;
pub mod belts;
pub mod density;
pub mod gcode;
pub mod klipper;
pub mod label;
pub mod modes;
pub mod motors;
pub mod profile;
pub mod recording;
pub mod run;
pub mod shapers;
pub mod spectrogram;
pub mod spectrum;
pub mod stdata;
pub mod sweep;
pub mod symmetry;
