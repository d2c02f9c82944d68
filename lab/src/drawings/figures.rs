//! Figures: the schematics, table 1 and the workspaces of the CoreH-bot paper, drawn from the routing alone.
//!
//! Radii and the widths of bar and head are larger than they are, as in the paper, so that a reader can tell belts
//! apart. The run of the belts follows from the same tables as every figure of the twin.
//!
//! | file | content |
//! |---|---|
//! | `routing` | the belts of a machine, as in figures 4 to 6 |
//! | `forces` | a simple belt, free bodies, and motions along the axes, as in figures 7 to 9 |
//! | `workspaces` | the reach of three machines, by equations 20 and 21 |
//! | `table` | table 1 |
//! | `radii` | equation 8: motors with pulleys of four sizes |
//! | `page` | the page with all of them, and the numbers of the text |

mod forces;
mod page;
mod radii;
mod routing;
mod table;
mod workspaces;

use crate::queries::paper::Paper;
use corehbot_twin::params::Params;
use corehbot_twin::routing::Place;

/// A file of the folder of figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: String,
}

/// All files: the drawings, and the page that shows them.
#[must_use]
pub fn figures(paper: &Paper) -> Vec<Figure> {
    [
        ("fig-5-corehbot.svg", routing::corehbot()),
        ("fig-6-routings.svg", routing::three()),
        ("fig-7-simple-belt.svg", forces::simple()),
        ("fig-8-free-bodies.svg", forces::free_bodies()),
        ("fig-9-motions.svg", forces::motions()),
        ("table-1.svg", table::table_1(paper)),
        ("equation-8.svg", radii::turns(&paper.radii)),
        ("workspaces.svg", workspaces::workspaces()),
        ("README.md", page::page(paper)),
    ]
    .map(|(name, text)| Figure { name, text })
    .into()
}

/// The dimensions of the drawings: the frame of the paper, with pulleys, bar and head as wide as can be seen.
fn drawn() -> Params {
    Params { pulley_radius_mm: 18.0, bar_pulleys_mm: 150.0, head_pulleys_mm: 110.0, ..Params::default() }
}

/// The tool's place in the drawings: not in the middle, where lines would coincide.
const TOOL: Place = Place::flat(205.0, 250.0);
