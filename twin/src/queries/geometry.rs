//! Where the belt runs: segments, wraps, lengths, reach.

use super::{At, Setup, shown};
use crate::geometry::{Layout, layout, workspace};
use crate::model::ways::Ways;
use crate::routing::Stop;
use serde::Serialize;

/// The belts for one place of the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Geometry {
    /// What it is about.
    #[serde(flatten)]
    pub at: At,
    /// Length of each belt.
    pub belt_lengths_mm: Vec<f64>,
    /// Where the tool can be, left and right.
    pub reach_x_mm: [f64; 2],
    /// The same, front and back.
    pub reach_y_mm: [f64; 2],
    /// Straight parts in the direction of travel.
    pub segments: Vec<SegmentAnswer>,
    /// Arcs on pulleys.
    pub wraps: Vec<WrapAnswer>,
    /// Motors, and how far each turns for the tool.
    pub motors: Vec<MotorAnswer>,
}

/// A straight part of a belt.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentAnswer {
    /// Numbers of the pulleys at its ends; 0 is a clamp.
    pub between: [u8; 2],
    /// Free length.
    pub length_mm: f64,
    /// Direction of travel.
    pub heading: [f64; 2],
}

/// An arc on a pulley.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrapAnswer {
    /// The pulley's number.
    pub pulley: u8,
    /// How far the belt turns.
    pub angle_deg: f64,
    /// Length of the arc.
    pub length_mm: f64,
}

/// A motor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotorAnswer {
    /// Its number.
    pub motor: u8,
    /// Belt for a millimetre of x and of y, counter-clockwise.
    pub belt_per_mm: [f64; 2],
}

impl Geometry {
    /// What it is.
    #[must_use]
    pub fn new(setup: &Setup) -> Self {
        let (machine, params) = (setup.machine, &setup.params);
        let Layout { segments, wraps, belt_lengths_mm } = layout(machine, params, setup.tool);
        let reach = workspace(machine, params);
        let stops: Vec<&Stop> = machine.stops().collect();
        let number = |index: usize| stops.get(index).map_or(0, |stop| stop.number);
        let segment = |s: &crate::geometry::Segment| SegmentAnswer {
            between: [number(s.from), number(s.to)],
            length_mm: s.length_mm,
            heading: s.heading,
        };
        let wrap = |w: &crate::geometry::Wrap| WrapAnswer {
            pulley: number(w.stop),
            angle_deg: w.angle_rad.to_degrees(),
            length_mm: w.angle_rad * params.pulley_radius_mm,
        };
        let ways = Ways::new(machine, params);
        let motors = ways.motors.into_iter().zip(ways.rows);
        Self {
            at: setup.at(),
            belt_lengths_mm,
            reach_x_mm: reach.x,
            reach_y_mm: reach.y,
            segments: segments.iter().map(segment).collect(),
            wraps: wraps.iter().map(wrap).collect(),
            motors: motors.map(|(motor, belt_per_mm)| MotorAnswer { motor, belt_per_mm }).collect(),
        }
    }
}

impl std::fmt::Display for Geometry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.at)?;
        let lengths: Vec<String> = self.belt_lengths_mm.iter().map(|mm| format!("{mm:.3} mm")).collect();
        writeln!(f, "  belt   {}", lengths.join(", "))?;
        let ([left, right], [front, back]) = (self.reach_x_mm, self.reach_y_mm);
        writeln!(f, "  reach  x {left:.2} to {right:.2}, y {front:.2} to {back:.2} mm")?;
        for SegmentAnswer { between: [from, to], length_mm, .. } in &self.segments {
            let end = |number: &u8| if *number == 0 { "clamp".to_owned() } else { number.to_string() };
            writeln!(f, "  segment {:>5} - {:<5} {length_mm:>9.3} mm", end(from), end(to))?;
        }
        for WrapAnswer { pulley, angle_deg, length_mm } in &self.wraps {
            writeln!(f, "  wrap on {pulley:>2}  {angle_deg:>5.1} degrees {length_mm:>9.3} mm")?;
        }
        for MotorAnswer { motor, belt_per_mm: [x, y] } in &self.motors {
            writeln!(f, "  motor {motor:<2} turns {} mm/mm of x, {} of y", shown(*x, 0), shown(*y, 0))?;
        }
        Ok(())
    }
}
