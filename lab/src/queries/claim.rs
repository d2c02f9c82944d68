//! Claim: a sentence of a paper, and what a machine says to it.

use serde::Serialize;
use std::fmt;

/// A sentence of a paper, and what a machine says to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// The sentence, shortened.
    pub text: &'static str,
    /// What was found.
    pub found: String,
    /// Whether the machine bears it out.
    pub holds: bool,
}

impl Claim {
    pub(crate) const fn new(text: &'static str, holds: bool, found: String) -> Self {
        Self { text, found, holds }
    }
}

/// The sentences, one below the other, for people.
pub(crate) fn write_claims(f: &mut fmt::Formatter<'_>, claims: &[Claim]) -> fmt::Result {
    for Claim { text, found, holds } in claims {
        writeln!(f, "  {}  {text}\n       {found}", if *holds { "yes" } else { " no" })?;
    }
    Ok(())
}
