//! Resonances: the tool is shaken by a sweep, and an accelerometer tells how it vibrates.
//!
//! ```text
//!   words ──▶ plan: a sweep within all limits ──▶ test: shaping off, sensor on, sweep, shaping on, back
//!                                                        │ samples
//!                      modes ◀── response ◀── listen ◀───┘
//! ```
//!
//! | file | for |
//! |---|---|
//! | [`plan`] | the sweep that a line wants, and whether the machine can make it |
//! | [`test`] | the test from the first sample to the last step |
//! | [`listen`] | samples to blocks, each with its commanded acceleration; a sensor that fails |
//! | [`response`] | power of the vibration over power of the command, by frequency |
//! | [`modes`] | frequency and damping of its peaks |
//! | [`choice`] | the shaper for them |
//! | [`no_result`] | why there is none |
//!
//! | word | means |
//! |---|---|
//! | response | abs(H)^2: density of the measured acceleration over density of the commanded one |
//! | mode | a way in which the tool vibrates, with a frequency and a damping |
//! | block | the mean of some samples |
//! | noise | standard deviation of the samples while the tool rests |

mod choice;
pub(in crate::machine) mod commands;
mod listen;
mod modes;
mod no_result;
pub(in crate::machine) mod plan;
mod response;
pub(in crate::machine) mod test;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
