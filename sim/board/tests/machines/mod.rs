//! Every machine of `examples/machines` prints: it homes, and every step is as its rows and limits say.

mod answers;
mod circulation;
mod eight_motors;
mod endstops;
mod print;
mod prints;
mod shared_motors;
mod stops;

use crate::common::lines;
