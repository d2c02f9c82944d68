//! The run of the belt: segments, wraps, lengths, reach.

use super::{At, Setup, shown};
use crate::geometry::{Layout, layout, workspace};
use crate::model::ways::Ways;
use crate::params::Params;
use crate::routing::{Machine, Role, Side, Stop};
use serde::Serialize;

/// Angular error of every motor in the paper: half a full step of 1.8 degrees (equation 25).
const ANGLE_DEG: f64 = 0.9;

/// The belts for one place of the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Geometry {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// Length of each belt.
    pub belt_lengths_mm: Vec<f64>,
    /// Reach of the tool, left and right.
    pub reach_x_mm: [f64; 2],
    /// The same, front and back.
    pub reach_y_mm: [f64; 2],
    /// Straight parts in the direction of travel.
    pub segments: Vec<SegmentAnswer>,
    /// Arcs on pulleys.
    pub wraps: Vec<WrapAnswer>,
    /// Motors, with their travel for the tool.
    pub motors: Vec<MotorAnswer>,
    /// Largest error of the tool if each motor is off by half a full step, as far as rigid belts allow.
    pub transmission_error_mm: f64,
    /// Pulleys on the toothed side of a belt; pulleys on its back may be smooth.
    pub toothed_pulleys: Vec<u8>,
    /// The same in short for every machine with these parameters.
    pub machines: Vec<InShort>,
}

/// A machine in short.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InShort {
    /// Its name.
    pub machine: &'static str,
    /// Length of all its belts.
    pub belt_mm: f64,
    /// Reach of its tool, left and right.
    pub reach_x_mm: [f64; 2],
    /// The same, front and back.
    pub reach_y_mm: [f64; 2],
    /// Largest error of its tool if each motor is off by half a full step.
    pub transmission_error_mm: f64,
    /// Number of pulleys on the toothed side, motors included, and number of all pulleys.
    pub toothed_of: [usize; 2],
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
    /// Turn of the belt.
    pub angle_deg: f64,
    /// Length of the arc.
    pub length_mm: f64,
}

/// A motor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotorAnswer {
    /// Its number.
    pub motor: u8,
    /// Belt per millimetre of x, of y and, where belts lift the tool, of z, counter-clockwise.
    pub belt_per_mm: Vec<f64>,
}

impl Geometry {
    /// The answer.
    #[must_use]
    pub fn new(setup: &Setup) -> Self {
        let (machine, params) = (setup.machine, &setup.params);
        let Layout { segments, wraps, belt_lengths_mm } = layout(machine, params, setup.tool);
        let reach = workspace(machine, params);
        let number = numbers(machine);
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
            motors: motors
                .map(|(motor, row)| MotorAnswer { motor, belt_per_mm: row.into_iter().take(machine.axes()).collect() })
                .collect(),
            transmission_error_mm: transmission_error_mm(machine, params),
            toothed_pulleys: toothed(machine),
            machines: Machine::ALL.into_iter().filter(|m| !m.lifts()).map(|m| in_short(m, params)).collect(),
        }
    }
}

/// Numbers of the pulleys by their places among all stops; 0 is a clamp.
pub fn numbers(machine: Machine) -> impl Fn(usize) -> u8 {
    let stops = machine.stops();
    move |index| stops.get(index).map_or(0, |stop| stop.number)
}

fn transmission_error_mm(machine: Machine, params: &Params) -> f64 {
    Ways::new(machine, params).greatest_error_mm(machine, params, ANGLE_DEG.to_radians())
}

/// Numbers of the pulleys on the toothed side of the belt, ascending.
fn toothed(machine: Machine) -> Vec<u8> {
    let is_toothed = |stop: &Stop| matches!(stop.role, Role::Motor | Role::Idler(Side::Inside));
    let mut numbers: Vec<u8> = machine.stops().into_iter().filter(is_toothed).map(|stop| stop.number).collect();
    numbers.sort_unstable();
    numbers
}

fn in_short(machine: Machine, params: &Params) -> InShort {
    let reach = workspace(machine, params);
    let pulleys = machine.stops().iter().filter(|stop| stop.role != Role::Clamp).count();
    InShort {
        machine: machine.key(),
        belt_mm: layout(machine, params, reach.centre()).belt_lengths_mm.iter().sum(),
        reach_x_mm: reach.x,
        reach_y_mm: reach.y,
        transmission_error_mm: transmission_error_mm(machine, params),
        toothed_of: [toothed(machine).len(), pulleys],
    }
}

impl std::fmt::Display for Geometry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.at)?;
        let lengths: Vec<String> = self.belt_lengths_mm.iter().map(|mm| format!("{mm:.3} mm")).collect();
        writeln!(f, "  belt   {}", lengths.join(", "))?;
        let ([left, right], [front, back]) = (self.reach_x_mm, self.reach_y_mm);
        writeln!(f, "  reach  x {left:.2} to {right:.2}, y {front:.2} to {back:.2} mm")?;
        let toothed: Vec<String> = self.toothed_pulleys.iter().map(u8::to_string).collect();
        writeln!(f, "  toothed pulleys     {}", toothed.join(", "))?;
        writeln!(
            f,
            "  transmission error  {:.5} mm for {ANGLE_DEG} degrees of every motor",
            self.transmission_error_mm
        )?;
        for SegmentAnswer { between: [from, to], length_mm, .. } in &self.segments {
            let end = |number: &u8| if *number == 0 { "clamp".to_owned() } else { number.to_string() };
            writeln!(f, "  segment {:>5} - {:<5} {length_mm:>9.3} mm", end(from), end(to))?;
        }
        for WrapAnswer { pulley, angle_deg, length_mm } in &self.wraps {
            writeln!(f, "  wrap on {pulley:>2}  {angle_deg:>5.1} degrees {length_mm:>9.3} mm")?;
        }
        for MotorAnswer { motor, belt_per_mm } in &self.motors {
            let of: Vec<String> = belt_per_mm
                .iter()
                .zip(["mm/mm of x", "of y", "of z"])
                .map(|(mm, of)| format!("{} {of}", shown(*mm, 0)))
                .collect();
            writeln!(f, "  motor {motor:<2} turns {}", of.join(", "))?;
        }
        writeln!(
            f,
            "{:<12}{:>11}{:>16}{:>16}{:>11}{:>13}",
            "", "belt, mm", "x, mm", "y, mm", "error, mm", "toothed of"
        )?;
        for m in &self.machines {
            let name = Machine::name_of(m.machine);
            let pair = |[low, high]: [f64; 2]| format!("{low:.1} to {high:.1}");
            let (x, y, [toothed, all]) = (pair(m.reach_x_mm), pair(m.reach_y_mm), m.toothed_of);
            write!(f, "{name:<12}{:>11.3}{x:>16}{y:>16}{:>11.5}", m.belt_mm, m.transmission_error_mm)?;
            writeln!(f, "{:>13}", format!("{toothed} of {all}"))?;
        }
        Ok(())
    }
}
