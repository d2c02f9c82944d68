//! Prints on the belt plant: the firmware's commands, and their effect.

mod accidents;
mod alignment;
mod buzz;
mod ended;
mod limp;
mod loads;
mod machines;
mod parts;
mod phases;
mod power;
mod printer;
mod pulleys;
mod quiet;
mod routings;
mod skips;
mod trust;
