//! A plate of a project that was sliced as a whole.

/// A plate with its G-code.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Plate {
    /// Its number, from 1.
    pub number: u32,
    /// Its file in the archive.
    pub name: String,
}
