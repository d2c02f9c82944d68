//! Picture: frame, bar, head, motors and belts of a machine, seen from above, for a drawing.
//!
//! Places are in mm from motor 1's axis, y away from the front; the script turns them over. A belt is one path of lines
//! and arcs. Belts do not stretch here, so the belt that has passed a path's begin has passed every place of it. A
//! pattern along the path, shifted by this length, moves as the belt does, also where bar and head carry pulleys.

use anyhow::Result;
use corehbot::motors::MOTORS;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::Machine;
use corehbot_sim::belt::layout::{Layout, MotorDrive};
use corehbot_twin::geometry::{Segment, layout, workspace};
use corehbot_twin::routing::{Belt, Block, Place, Role, Runs, Stop};
use serde::Serialize;
use std::fmt::Write as _;

/// A machine that can be drawn.
pub struct Picture {
    layout: Layout,
    belts: Vec<Belt>,
    stops: Vec<Stop>,
    /// Where G-code's X0 Y0 Z0 is.
    origin: [f64; 3],
    /// Belt of a step of each motor, in mm.
    step_mm: Vec<f64>,
}

/// What does not move.
#[derive(Serialize)]
pub struct Frame {
    /// The machine's name for people.
    name: &'static str,
    width_mm: f64,
    depth_mm: f64,
    radius_mm: f64,
    /// Half the width and depth of the head.
    head_mm: [f64; 2],
    /// Left, front, right and back of the tool's reach.
    reach_mm: [f64; 4],
}

/// What moves.
#[derive(Serialize)]
pub struct Moved {
    /// The tool.
    tool: [f64; 2],
    belts: Vec<Run>,
    pulleys: Vec<Pulley>,
}

/// A belt.
#[derive(Serialize)]
struct Run {
    /// A motor on it, by its name.
    motor: String,
    /// As SVG has it, with y upside down.
    path: String,
    /// Belt that has passed the path's begin, in mm.
    passed_mm: f64,
}

/// A pulley or a clamp.
#[derive(Serialize)]
struct Pulley {
    at: [f64; 2],
    role: &'static str,
    block: &'static str,
    /// The motor's name, or the pulley's number, as an accident names it.
    name: String,
    /// How far it has turned from the beginning, counter-clockwise.
    turned_rad: f64,
}

impl Picture {
    /// Draws a machine with belts.
    ///
    /// # Errors
    /// The twin has no belts that do what the motors do, and why.
    pub fn new(machine: &Machine) -> Result<Self, String> {
        let layout = Layout::new(&machine.settings, &machine.twin).map_err(|error| error.to_string())?;
        let settings = &machine.settings;
        let axes = layout.machine.axes();
        let corner = workspace(layout.machine, &layout.params).origin().xyz();
        let begins = [settings.axis_min.x, settings.axis_min.y, settings.axis_min.z].map(Mm::to_num::<f64>);
        let origin = [0, 1, 2].map(|axis| if axis < axes { corner[axis] - begins[axis] } else { 0.0 });
        let step_mm = layout.drives.iter().map(|drive| step_mm(drive, settings)).collect();
        Ok(Self { belts: layout.machine.belts(), stops: layout.machine.stops(), layout, origin, step_mm })
    }

    /// What does not move.
    #[must_use]
    pub fn frame(&self) -> Frame {
        let p = &self.layout.params;
        let reach = workspace(self.layout.machine, p);
        Frame {
            name: self.layout.machine.name(),
            width_mm: p.width_mm,
            depth_mm: p.depth_mm,
            radius_mm: p.pulley_radius_mm,
            head_mm: [p.head_pulleys_mm / 2.0 + 0.3 * p.pulley_radius_mm, p.bar_pulleys_mm / 2.0],
            reach_mm: [reach.x[0], reach.y[0], reach.x[1], reach.y[1]],
        }
    }

    /// The machine with its tool in the middle of its reach.
    fn resting(&self) -> Moved {
        let reach = workspace(self.layout.machine, &self.layout.params);
        let [_, _, z] = reach.origin().xyz();
        let middle = [f64::midpoint(reach.x[0], reach.x[1]), f64::midpoint(reach.y[0], reach.y[1]), z];
        self.moved([0, 1, 2].map(|axis| middle[axis] - self.origin[axis]), [0; MOTORS])
    }

    /// The machine with its tool at a place of G-code, after so many steps of its motors.
    #[must_use]
    pub fn moved(&self, tool: [f64; 3], counts: [i32; MOTORS]) -> Moved {
        let axes = self.layout.machine.axes();
        let at = Place::of_xyz([0, 1, 2].map(|axis| if axis < axes { self.origin[axis] + tool[axis] } else { 0.0 }));
        let laid = layout(self.layout.machine, &self.layout.params, at);
        let travel: Vec<f64> = (self.layout.drives.iter().zip(&self.step_mm))
            .map(|(drive, step)| f64::from(counts[drive.motor.index()]) * f64::from(drive.sense) * step)
            .collect();
        let passed = |stop: &Stop| {
            let motor = stop.motor().map(|number| self.layout.machine.index_of(number));
            motor.and_then(|index| travel.get(index)).copied()
        };
        let (mut first, mut begin) = (0, 0);
        let mut belts = Vec::new();
        for belt in &self.belts {
            let count = belt.stops.len() - usize::from(!belt.is_closed());
            let segments = laid.segments.get(first..first + count).unwrap_or_default();
            let stops = self.stops.get(begin..begin + belt.stops.len()).unwrap_or_default();
            first += count;
            begin += belt.stops.len();
            let path = self.path(belt, segments);
            let motor = stops.iter().find_map(|stop| self.motor_name(stop)).unwrap_or_default();
            belts.push(Run { motor, path, passed_mm: stops.first().and_then(passed).unwrap_or(0.0) });
        }
        let pulleys = self.stops.iter().map(|stop| self.pulley(stop, at, passed(stop))).collect();
        Moved { tool: [at.x, at.y], belts, pulleys }
    }

    fn motor_name(&self, stop: &Stop) -> Option<String> {
        let drive = self.layout.drives.get(self.layout.machine.index_of(stop.motor()?))?;
        Some(drive.name.to_string())
    }

    fn pulley(&self, stop: &Stop, tool: Place, passed_mm: Option<f64>) -> Pulley {
        let named = self.motor_name(stop);
        Pulley {
            at: stop.centre(&self.layout.params, tool),
            role: match stop.role {
                Role::Motor => "motor",
                Role::Idler(_) => "idler",
                Role::Clamp => "clamp",
            },
            block: match stop.block() {
                Block::Frame => "frame",
                Block::Bar => "bar",
                Block::Head => "head",
            },
            name: named.or_else(|| stop.is_idler().then(|| stop.number.to_string())).unwrap_or_default(),
            turned_rad: passed_mm.unwrap_or(0.0) / self.layout.params.pulley_radius_mm,
        }
    }

    /// Lines and arcs of a belt.
    fn path(&self, belt: &Belt, segments: &[Segment]) -> String {
        let radius = self.layout.params.pulley_radius_mm;
        let mut path = String::new();
        let again = segments.first().filter(|_| belt.is_closed());
        let count = segments.len();
        for (index, segment) in segments.iter().chain(again).enumerate() {
            let [x, y] = segment.begin;
            let into = index.checked_sub(1).and_then(|before| segments.get(before));
            let sign = into.and_then(|into| self.stops.get(into.to)).map_or(0.0, Stop::sign);
            let _ = match (index, belt.runs) {
                (0, _) => write!(path, "M{x:.2} {:.2}", -y),
                (_, Runs::Upright) => write!(path, "L{x:.2} {:.2}", -y),
                // Counter-clockwise is SVG's direction 0; no wrap of these machines is more than half a turn.
                (_, Runs::Flat) => {
                    write!(path, "A{radius:.3} {radius:.3} 0 0 {} {x:.2} {:.2}", u8::from(sign < 0.0), -y)
                }
            };
            if index < count {
                let [u, v] = segment.heading;
                let end = [x + u * segment.length_mm, y + v * segment.length_mm];
                let _ = write!(path, "L{:.2} {:.2}", end[0], -end[1]);
            }
        }
        path
    }
}

/// A machine that does not move, as JSON; or `why` there is no picture.
///
/// # Errors
/// No known case: all fields are numbers and text.
pub fn still(machine: &Machine) -> Result<String> {
    #[derive(Serialize)]
    struct Still {
        #[serde(flatten)]
        frame: Frame,
        resting: Moved,
    }
    Ok(match Picture::new(machine) {
        Ok(picture) => serde_json::to_string(&Still { frame: picture.frame(), resting: picture.resting() })?,
        Err(why) => serde_json::json!({ "why": why }).to_string(),
    })
}

/// Belt of a step of a motor, in mm: a motor's steps are those of the axes that it moves.
fn step_mm(drive: &MotorDrive, settings: &Settings) -> f64 {
    let axes = [&settings.axes.x, &settings.axes.y, &settings.axes.z].map(|axis| axis.steps_per_mm.to_num::<f64>());
    let axis = settings.mechanism.axis_of(drive.motor).and_then(|axis| axes.get(axis));
    drive.belt_part / axis.copied().unwrap_or(axes[0]) / f64::from(drive.multiple)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;

    #[test]
    fn accidents_know_every_pulley_by_the_name_in_the_picture() {
        for text in [None, Some(include_str!("../../examples/machines/corexy.toml").to_owned())] {
            let job = Job { machine: text, has_belt_plant: true, ..Job::default() };
            let still: serde_json::Value = serde_json::from_str(&still(&job.machine().unwrap()).unwrap()).unwrap();
            let pulleys = still["resting"]["pulleys"].as_array().unwrap();
            let named: Vec<&str> = pulleys.iter().map(|pulley| pulley["name"].as_str().unwrap()).collect();
            assert!(named.iter().any(|name| name.starts_with('m')) && named.contains(&"2"), "{named:?}");
            for name in named.into_iter().filter(|name| !name.is_empty()) {
                let breaks = vec![format!("seized:{name}@1s")];
                assert_eq!(Job { breaks, ..job.clone() }.refusals(), "[]");
            }
        }
    }

    #[test]
    fn a_move_to_the_right_turns_all_motors_and_leaves_the_frames_pulleys() {
        let machine = Job::default().prepare().unwrap().machine;
        let picture = Picture::new(&machine).unwrap();
        let before = picture.moved([100.0, 100.0, 0.0], [0; MOTORS]);
        let steps = (10.0 * machine.settings.axes.x.steps_per_mm.to_num::<f64>()) as i32;
        let counts = corehbot::motors::per_motor(&[-steps, -steps, steps, steps], 0);
        let after = picture.moved([110.0, 100.0, 0.0], counts);
        assert!((after.tool[0] - before.tool[0] - 10.0).abs() < 1e-9);
        let turn = 10.0 / picture.layout.params.pulley_radius_mm;
        for (one, other) in before.pulleys.iter().zip(&after.pulleys) {
            let way = if one.block == "head" { 10.0 } else { 0.0 };
            assert!((other.at[0] - one.at[0] - way).abs() < 1e-9);
            assert!(one.role != "motor" || (other.turned_rad.abs() - turn).abs() < 1e-6);
        }
        assert_eq!(after.pulleys.iter().filter(|pulley| pulley.role == "motor").count(), 4);
        assert!(after.belts[0].path.starts_with('M') && (after.belts[0].passed_mm.abs() - 10.0).abs() < 1e-6);
    }
}
