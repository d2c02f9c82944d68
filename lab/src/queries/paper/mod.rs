//! Paper: what \[H\] states in its table 1 and in its text, next to what the model computes.
//!
//! The paper has its machines with a head as small as their pulleys allow; the prototype's is 80 mm wide. Where this
//! makes a difference both figures stand here. docs/research/twin.md lists the misprints.
//!
//! | file | content |
//! |---|---|
//! | [`table`] | table 1: the length of each segment and wrap |
//! | [`pattern`] | tensions in a motion along an axis, by the paper's condition F |
//! | [`statements`] | numbers in the text |
//! | [`speeds`] | equations 2 and 9 |
//! | [`radii`] | equation 8 with four pulleys of four sizes |

pub mod pattern;
pub mod radii;
pub mod speeds;
pub mod statements;
pub mod table;

use radii::Radii;
use serde::Serialize;
use statements::{Statement, statements};
use table::{Row, table_1};

/// What the paper states, and the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Paper {
    /// Table 1.
    pub table_1: Vec<Row>,
    /// Numbers in the text.
    pub statements: Vec<Statement>,
    /// Equation 8 with unequal radii.
    pub radii: Radii,
}

impl Paper {
    /// The answer, with the dimensions of the paper's table 2.
    #[must_use]
    pub fn new() -> Self {
        Self { table_1: table_1(), statements: statements(), radii: Radii::new() }
    }
}

impl Default for Paper {
    fn default() -> Self {
        Self::new()
    }
}

impl std::fmt::Display for Paper {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let off = self.table_1.iter().map(|row| (row.ours_mm - row.printed_mm).abs()).fold(0.0, f64::max);
        writeln!(f, "Table 1: {} lengths, the largest difference is {off:.6} mm", self.table_1.len())?;
        writeln!(f, "{:<14}{:<66}{:>10}{:>10}", "", "", "paper", "ours")?;
        for s in &self.statements {
            let [printed, ours] = [s.printed, s.ours].map(|value| s.text(value));
            writeln!(f, "{:<14}{:<66}{printed:>10}{ours:>10} {}", s.place, s.what, s.unit)?;
        }
        write!(f, "{}", self.radii)
    }
}
