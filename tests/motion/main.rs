//! Motion against an independent model: steps on time, limits kept, every move able to stop.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod alignment;
#[path = "../support/belt_equations.rs"]
#[allow(dead_code, reason = "other tests need all of them")]
mod belt_equations;
mod circles;
mod corners;
mod curves;
mod dice;
mod fillets;
mod joining;
mod klipper;
mod line;
mod longest;
mod model;
mod passes;
mod pressure;
mod properties;
mod shaped;
mod shapers;
mod speeds;
mod square_corner;
mod surface;
mod timing;
mod velocity;
mod ways;
mod zigzag;

/// Positions of x, y, z and e in mm, and speeds in mm/s.
pub type Targets = [([f64; 4], f64)];
