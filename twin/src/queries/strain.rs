//! Strain: the common part of answers about belts and motors under load, for pushes and slips.

use super::{Setup, shown};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::Elastic;
use crate::model::ways::residual_mm;
use crate::solve::balance::Balance;
use serde::Serialize;
use std::collections::BTreeMap;

/// Effect of a load on tool, belts and motors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strain {
    /// Displacement of the tool to the right.
    pub dx_mm: f64,
    /// Displacement away from the front.
    pub dy_mm: f64,
    /// Displacement up; none where no belts lift the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dz_mm: Option<f64>,
    /// Part of the motor travel that a rigid belt cannot follow; none on machines without a residual.
    pub residual_mm: Option<f64>,
    /// Change of each span's tension.
    #[serde(rename = "tension_change_N")]
    pub tension_change_n: BTreeMap<&'static str, f64>,
    /// The motors of the torques.
    pub motors: Vec<u8>,
    /// Holding torque of each motor against the load, counter-clockwise.
    #[serde(rename = "motor_torque_mNm")]
    pub motor_torque_mnm: Vec<f64>,
}

impl Strain {
    pub(super) fn new(setup: &Setup, elastic: &Elastic, balance: &Balance) -> Self {
        let motors = setup.machine.motors();
        let turned: Vec<f64> = motors.iter().map(|number| balance.of(elastic, Coordinate::Motor(*number))).collect();
        let spans = elastic.links.links.iter().map(|link| link.span);
        Self {
            dx_mm: balance.of(elastic, Coordinate::X),
            dy_mm: balance.of(elastic, Coordinate::Y),
            dz_mm: elastic.links.index(Coordinate::Z).map(|_| balance.of(elastic, Coordinate::Z)),
            residual_mm: residual_mm(setup.machine, &turned),
            // Where links are segments, all segments of a span have one tension, because only the belt turns an idler.
            tension_change_n: spans.zip(balance.tensions_n.iter().copied()).collect(),
            motors,
            motor_torque_mnm: balance.torques_mnm.clone(),
        }
    }
}

impl std::fmt::Display for Strain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "  tool     dx {:>9} mm   dy {:>9} mm", shown(self.dx_mm, 5), shown(self.dy_mm, 5))?;
        if let Some(dz) = self.dz_mm {
            write!(f, "   dz {:>9} mm", shown(dz, 5))?;
        }
        writeln!(f)?;
        if let Some(residual) = self.residual_mm {
            writeln!(f, "  residual    {:>9} mm of belt", shown(residual, 5))?;
        }
        for (span, change) in &self.tension_change_n {
            writeln!(f, "  span {span:<8} {:>8} N", shown(*change, 2))?;
        }
        for (motor, torque) in self.motors.iter().zip(&self.motor_torque_mnm) {
            writeln!(f, "  motor {motor:<7} {:>8} mN m", shown(*torque, 1))?;
        }
        Ok(())
    }
}
