//! Motion, held to an independent model: steps on time, limits kept, every move able to stop.

mod circles;
mod corners;
mod dice;
mod line;
mod model;
mod properties;
mod rounds;
mod shaped;
mod shapers;
mod speeds;
mod timing;
mod ways;
mod zigzag;
