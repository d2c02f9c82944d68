//! Mechanisms as data: forward and inverse in whole numbers, the motor motions that are not allowed, and why motors of
//! a group step in the same instant.

mod figures;
mod machines;
mod prototype;
mod residuals;
mod rows;
mod stepping;
mod zigzag;
