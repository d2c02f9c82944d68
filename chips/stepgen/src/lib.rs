//! The step generator's loops, compiled in a crate of their own.
//!
//! Nearly all of a firmware runs seldom and is optimised for the least size. These loops run for each step, and this
//! crate is optimised for speed as well (`profile.firmware` in the root's `Cargo.toml`).
#![no_std]
#![forbid(unsafe_code)]

use corehbot::motion::StepGenerator;
use corehbot::port::Wake;

/// Makes step events, and tells whether the Console may have waited for them: [`StepGenerator::run`].
#[inline(never)]
pub fn generate(generator: &mut StepGenerator<'_>, wake: &dyn Wake) -> bool {
    generator.run(wake)
}
