//! Motion against an independent model: steps on time, limits kept, every move able to stop.

mod alignment;
mod circles;
mod corners;
mod curves;
mod fillets;
mod joining;
mod klipper;
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
