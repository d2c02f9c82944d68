//! Solve: equilibria and modes of a model, the model from its modes, and the search for it.

pub mod balance;
pub mod identify;
pub mod least_squares;
pub mod modes;

/// The machine is not held: it can move without any force, so there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotHeld;

impl std::fmt::Display for NotHeld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("nothing holds the belt: too many motors are without power")
    }
}

impl std::error::Error for NotHeld {}
