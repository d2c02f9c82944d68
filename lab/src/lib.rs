//! The laboratory: studies of belt machines that papers ask for, and that no print needs.
//!
//! `corehbot-lab` is its command. It stands on the belt's twin, and nothing stands on it: the firmware, the simulator
//! and the `corehbot` command are built without it. Units and directions are those of [`corehbot_twin`].
//!
//! | room | job |
//! |---|---|
//! | [`queries`] | answers ready to be printed |
//! | [`compensation`] | steps, or chords for a planner, moved ahead by the tool's lag |
//! | [`jump`] | the ringing after a jump of speed |
//! | [`parts`] | reference parts, and the errors of their dimensions |
//! | [`sampling`] | the points of a parameter space that a study uses |
//! | [`yin`] | Yin et al.'s CoreXY on a square, a model of its own |
//! | [`drawings`], [`pages`] | SVG of the answers, and scripts of their pages |
//! | `commands`, [`cli`] | the commands, and the command line |
//!
//! Misprints of the papers and their corrections: docs/research/twin.md.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod cli;
mod commands;
pub mod compensation;
pub mod drawings;
mod examples;
pub mod jump;
pub mod pages;
pub mod parts;
pub mod queries;
pub mod sampling;
pub mod yin;
