//! Radii: equation 8 of \[H\] with four motors' pulleys of four sizes.
//!
//! A motor turns by its belt over the radius of its own pulley. A controller that takes all pulleys for the first one's
//! turns each motor by its belt over that radius. Then the belts are wrong: the tool goes elsewhere, the belt runs
//! round, and a part of the travel does not fit a rigid belt (equation 11).

use corehbot_twin::model::ways::{Ways, residual_mm};
use corehbot_twin::params::{Params, TOOTH_MM};
use corehbot_twin::routing::Machine;
use serde::Serialize;
use std::f64::consts::TAU;

/// Teeth of the pulleys on motors 1, 4, 8 and 11. With 20 teeth, 10 mm of belt are a quarter of a turn.
pub const TEETH: [u32; 4] = [20, 16, 24, 18];

/// Movements of the tool for which the motors' turns are asked, x and y in mm.
const MOVEMENTS_MM: [[f64; 2]; 3] = [[10.0, 0.0], [0.0, 10.0], [10.0, 10.0]];

/// Corners of a square in the order in which the tool goes round it, x and y in mm.
const SQUARE_MM: [[f64; 2]; 4] = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]];

/// Four pulleys of four sizes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Radii {
    /// Numbers of the motors.
    pub motors: Vec<u8>,
    /// Teeth of their pulleys.
    pub teeth: [u32; 4],
    /// Radii of the belt's pitch line on them.
    pub radius_mm: Vec<f64>,
    /// What the motors turn for a movement of the tool.
    pub movements: Vec<Movement>,
    /// A square by a controller that takes all pulleys for the first motor's.
    pub taken_for_equal: Vec<Corner>,
}

/// A movement of the tool, and its motors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Movement {
    /// x and y of the tool.
    pub tool_mm: [f64; 2],
    /// Belt over each motor.
    pub belt_mm: Vec<f64>,
    /// Turn of each motor, counter-clockwise.
    pub turn_deg: Vec<f64>,
}

/// A corner of the square, from the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Corner {
    /// Where the tool should be.
    pub commanded_mm: [f64; 2],
    /// Where it is: the place that is nearest to all motors.
    pub reached_mm: [f64; 2],
    /// Belt that ran round, counter-clockwise: the mean of the four.
    pub circulation_mm: f64,
    /// What equation 11 is off by: belt that is too much between two motors and too little between others.
    pub residual_mm: f64,
}

impl Radii {
    pub(super) fn new() -> Self {
        let machine = Machine::CoreHBot;
        let radius_mm = TEETH.map(|teeth| f64::from(teeth) * TOOTH_MM / TAU);
        let ways = Ways::new(machine, &Params::default());
        let belts = |[x, y]: [f64; 2]| ways.rows.iter().map(|row| row[0] * x + row[1] * y).collect::<Vec<_>>();
        let movements = MOVEMENTS_MM.map(|tool_mm| {
            let belt_mm = belts(tool_mm);
            let turn_deg = belt_mm.iter().zip(radius_mm).map(|(belt, radius)| (belt / radius).to_degrees()).collect();
            Movement { tool_mm, belt_mm, turn_deg }
        });
        // Turns for the first pulley's radius move each belt by its own.
        let shares = radius_mm.map(|radius| radius / radius_mm[0]);
        let corner = |commanded_mm: [f64; 2]| {
            let turned: Vec<f64> = belts(commanded_mm).iter().zip(shares).map(|(belt, share)| belt * share).collect();
            let [x, y, _] = ways.tool(&turned);
            Corner {
                commanded_mm,
                reached_mm: [x, y],
                circulation_mm: turned.iter().sum::<f64>() / turned.len() as f64,
                residual_mm: residual_mm(machine, &turned).unwrap_or_default(),
            }
        };
        Self {
            radius_mm: radius_mm.into(),
            teeth: TEETH,
            movements: movements.into(),
            taken_for_equal: SQUARE_MM.map(corner).into(),
            motors: ways.motors,
        }
    }
}

impl std::fmt::Display for Radii {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // No -0.00.
        let shown = |value: &f64| (value * 100.0).round() / 100.0 + 0.0;
        let each = |values: &[f64]| values.iter().map(|value| format!("{:>10.2}", shown(value))).collect::<String>();
        let names: String =
            self.motors.iter().zip(self.teeth).map(|(m, t)| format!("{:>10}", format!("{m}: {t}"))).collect();
        writeln!(f, "Equation 8, motor and teeth of its pulley{names}")?;
        for Movement { tool_mm: [x, y], turn_deg, .. } in &self.movements {
            writeln!(f, "{:<41}{}", format!("  turn in degrees for ({x}, {y}) mm"), each(turn_deg))?;
        }
        for Corner { commanded_mm: [x, y], reached_mm: [at_x, at_y], circulation_mm, residual_mm } in
            self.taken_for_equal.iter().skip(1)
        {
            writeln!(
                f,
                "  taken for equal, ({x}, {y}) mm is ({at_x:.2}, {at_y:.2}) mm, circulation {circulation_mm:.2} mm, residual {residual_mm:.2} mm"
            )?;
        }
        Ok(())
    }
}
