//! Queries: answers as tables for people, and as figures with units in their names for programs.
//!
//! Each file is one question. About one place of the tool: [`geometry`], [`stiffness`], [`modes`], [`push`], [`slip`],
//! [`tension`], [`ripple`]. About the whole reach: [`resonance`], [`limits`], [`torque`]. [`shaper`] rates a shaper.
//! [`strain`] is what push and slip have in common. The laboratory has more questions.

pub mod geometry;
pub mod limits;
pub mod modes;
pub mod push;
pub mod resonance;
pub mod ripple;
pub mod shaper;
pub mod slip;
pub mod stiffness;
pub mod strain;
pub mod tension;
pub mod torque;

use crate::geometry::workspace;
use crate::model::elastic::{Elastic, Freedom};
use crate::params::Params;
use crate::routing::{Machine, Place};
use serde::Serialize;

/// The subject of a query: machine, place of its tool, and movable parts.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The machine.
    pub machine: Machine,
    /// Its parameters.
    pub params: Params,
    /// The tool's place.
    pub tool: Place,
    /// Parts that may move besides the tool.
    pub freedom: Freedom,
}

impl Setup {
    /// The nominal machine with fixed motors and idlers without mass.
    #[must_use]
    pub fn nominal(machine: Machine, x: f64, y: f64) -> Self {
        let params = Params::default();
        let tool = workspace(machine, &params).at(x, y);
        Self { machine, params, tool, freedom: Freedom::default() }
    }

    /// The model of it.
    #[must_use]
    pub fn elastic(&self) -> Elastic {
        Elastic::new(self.machine, &self.params, self.tool, self.freedom)
    }

    /// What an answer says about it.
    #[must_use]
    pub const fn at(&self) -> At {
        At { machine: self.machine.key(), x_mm: self.tool.x, y_mm: self.tool.y }
    }
}

/// The subject of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct At {
    /// The machine.
    pub machine: &'static str,
    /// The tool's place, from motor 1's axis.
    pub x_mm: f64,
    /// The same away from the front.
    pub y_mm: f64,
}

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = Machine::name_of(self.machine);
        write!(f, "{name} with the tool at ({:.1}, {:.1}) mm", self.x_mm, self.y_mm)
    }
}

/// A number for people: no -0.
#[must_use]
pub fn shown(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        _ => text,
    }
}
