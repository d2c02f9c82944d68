//! Motion, held to an independent model: steps on time, limits kept, every move able to stop.

mod alignment;
mod circles;
mod corners;
mod curves;
mod dice;
#[path = "../support/corehbot.rs"]
#[allow(dead_code, reason = "other tests need the rest of it")]
mod equations;
mod line;
mod longest;
mod model;
mod passes;
mod properties;
mod shaped;
mod shapers;
mod speeds;
mod timing;
mod velocity;
mod ways;
mod zigzag;
