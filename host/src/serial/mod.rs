//! Serial lines: to a board, and as a pseudo-terminal that a host opens; the clock, a person at the machine, and the
//! wiring of a simulated printer at its end.

mod hand;
mod line;
mod pace;
mod ports;
mod pseudo_terminal;
mod surroundings;

pub use hand::Hand;
pub use line::SerialLine;
pub use pace::{Pace, Speed};
pub use pseudo_terminal::Port;
pub use surroundings::Surroundings;
