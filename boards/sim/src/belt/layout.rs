//! Layout: which machine of the twin the settings are, and which motor of the firmware turns which of its motors.

use corehbot::kinematics::{Row, multiple};
use corehbot::motors::{Motor, MotorName};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_twin::geometry::workspace;
use corehbot_twin::model::ways::Ways;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::drive::drives;
use corehbot_twin::steps::{Column, StepTrace};

/// Motors of the largest machine that the twin knows.
pub const MOST_MOTORS: usize = 4;

/// A switch may be met so far beyond the reach, in mm, as `twin run` has it.
const BEYOND_MM: f64 = 2.0;

/// The drive of a motor of the twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorDrive {
    /// The firmware's motor.
    pub motor: Motor,
    /// Its name.
    pub name: MotorName,
    /// 1, or -1 if it turns in the opposite direction.
    pub sense: i8,
}

/// A machine of the twin, motor by motor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The machine.
    pub machine: Machine,
    /// The drive of each of its motors.
    pub drives: Vec<MotorDrive>,
}

/// Why settings have no belt plant.
#[derive(Clone, Debug, PartialEq)]
pub enum LayoutError {
    /// The twin knows no belts for these motors.
    NoMachine,
    /// The axes are longer than the tool reaches, in mm.
    TooLong {
        /// Length of x and y.
        axes: [f64; 2],
        /// Reach in x and y.
        reach: [f64; 2],
    },
    /// The tool begins where it cannot be, in x and y of G-code.
    OutOfReach([f64; 2]),
}

impl std::fmt::Display for LayoutError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoMachine => {
                f.write_str("the belt plant knows CoreH-bot, CoreXY and AWD CoreXY; this mechanism is none of them")
            }
            Self::TooLong { axes: [x, y], reach: [to_x, to_y] } => {
                write!(f, "axes of {x:.1} by {y:.1} mm: the belt plant's tool reaches {to_x:.1} by {to_y:.1}")
            }
            Self::OutOfReach([x, y]) => write!(f, "the belt plant's tool cannot begin at X{x:.2} Y{y:.2}"),
        }
    }
}

impl std::error::Error for LayoutError {}

impl Layout {
    /// The machine that these settings are.
    ///
    /// # Errors
    /// The twin does not model it.
    pub fn new(settings: &Settings, params: &Params) -> Result<Self, LayoutError> {
        let belt: Vec<(Motor, Row)> =
            settings.mechanism.motors().filter(|(_, [x, y, ..])| (*x, *y) != (0, 0)).collect();
        let rows: Vec<[i8; 2]> = belt.iter().map(|(_, [x, y, ..])| [*x, *y]).collect();
        // No machine of this kind has belt motors that turn for z too, or pulleys of other sizes.
        let is_flat = belt.iter().all(|(_, row)| row[2..] == [0, 0] && multiple(*row) == 1);
        let machine = machine(rows.clone()).filter(|_| is_flat).ok_or(LayoutError::NoMachine)?;
        let columns = rows.into_iter().map(|row| Column { name: String::new(), row }).collect();
        let drives = drives(&StepTrace::new(columns, 1.0), &Ways::new(machine, params));
        let turns = drives.map_err(|_| LayoutError::NoMachine)?.into_iter();
        let drive = |drive: corehbot_twin::steps::drive::Drive| {
            belt.get(drive.column).map(|(motor, _)| MotorDrive {
                motor: *motor,
                name: settings.name_of(*motor),
                sense: drive.sense,
            })
        };
        Ok(Self { machine, drives: turns.filter_map(drive).collect() })
    }

    /// Where G-code's X0 Y0 and the tool are for the twin.
    ///
    /// # Errors
    /// The tool cannot be there, or cannot go where the axes go.
    pub(super) fn places(
        &self,
        settings: &Settings,
        params: &Params,
        place: [Mm; 3],
    ) -> Result<(Place, Place), LayoutError> {
        let all = workspace(self.machine, params);
        let (corner, reach) = (all.origin(), [all.x[1] - all.x[0], all.y[1] - all.y[0]]);
        // The axes begin in the corner.
        let [left, front] = [settings.axis_min.x, settings.axis_min.y].map(Mm::to_num::<f64>);
        let origin = Place { x: corner.x - left, y: corner.y - front };
        let axes = [settings.axes.x.length, settings.axes.y.length].map(Mm::to_num::<f64>);
        if axes.iter().zip(reach).any(|(length, reach)| *length > reach + BEYOND_MM) {
            return Err(LayoutError::TooLong { axes, reach });
        }
        let [x, y, _] = place.map(Mm::to_num::<f64>);
        if [x - left, y - front].iter().zip(reach).any(|(at, reach)| !(-BEYOND_MM..=reach + BEYOND_MM).contains(at)) {
            return Err(LayoutError::OutOfReach([x, y]));
        }
        Ok((origin, Place { x: origin.x + x, y: origin.y + y }))
    }
}

/// The machine with motors that turn like this for x and y. Two motors count as a CoreXY: an H-bot's motors turn alike.
fn machine(mut rows: Vec<[i8; 2]>) -> Option<Machine> {
    rows.sort_unstable();
    match rows[..] {
        [[-1, -1], [-1, 1], [1, -1], [1, 1]] => Some(Machine::CoreHBot),
        [[1, -1], [1, 1]] => Some(Machine::CoreXy),
        [[1, -1], [1, -1], [1, 1], [1, 1]] => Some(Machine::AwdCoreXy),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;
    use corehbot_machine_file as machine_file;
    use std::path::Path;

    fn layout(file: &str) -> Result<Layout, LayoutError> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines").join(file);
        Layout::new(&machine_file::read(&path).unwrap().settings, &Params::default())
    }

    #[test]
    fn machines_that_the_twin_knows_are_found_by_their_motors() {
        let of = |file| layout(file).unwrap();
        let corehbot = of("prototype.toml");
        let each = prototype::BELT
            .iter()
            .map(|motor| MotorDrive { motor, name: prototype::NAMES[motor.index()], sense: 1 })
            .collect::<Vec<_>>();
        assert_eq!(corehbot, Layout { machine: Machine::CoreHBot, drives: each.to_vec() });
        let motors = |layout: Layout| layout.drives.iter().map(|d| (d.motor, d.sense)).collect::<Vec<_>>();
        assert_eq!(of("corexy.toml").machine, Machine::CoreXy);
        assert_eq!(motors(of("corexy.toml")), [(prototype::M11, 1), (prototype::M8, 1)]);
        let awd = of("awd-corexy.toml");
        assert_eq!(awd.machine, Machine::AwdCoreXy);
        // Motors 1 and 8 of the twin pull one belt, which the file gives to motors 4 and 11.
        assert_eq!(motors(awd).len(), 4);
        for file in ["cartesian.toml", "corexz.toml", "corexyz.toml", "core-unequal.toml", "corehbot-two-drivers.toml"]
        {
            assert_eq!(layout(file), Err(LayoutError::NoMachine), "{file}");
        }
    }

    #[test]
    fn a_tool_beyond_its_belts_is_refused() {
        let (mut settings, params) = (Settings::prototype(), Params::default());
        let layout = Layout::new(&settings, &params).unwrap();
        let at = |x: f64, y: f64| [x, y, 0.0].map(Mm::from_num);
        let (origin, start) = layout.places(&settings, &params, at(100.0, 50.0)).unwrap();
        assert!((origin.x - 40.0).abs() < 1e-9 && (origin.y - 26.2).abs() < 1e-9 && (start.x - 140.0).abs() < 1e-9);
        assert_eq!(layout.places(&settings, &params, at(400.0, 0.0)), Err(LayoutError::OutOfReach([400.0, 0.0])));
        // Axes that begin to the left of 0: their least position is the same corner.
        settings.axis_min.x = Mm::from_num(-40);
        let (origin, start) = layout.places(&settings, &params, at(60.0, 50.0)).unwrap();
        assert!((origin.x - 80.0).abs() < 1e-9 && (start.x - 140.0).abs() < 1e-9);
        assert_eq!(layout.places(&settings, &params, at(355.0, 0.0)), Err(LayoutError::OutOfReach([355.0, 0.0])));
        settings.axes.y.length = Mm::from_num(500);
        assert!(matches!(layout.places(&settings, &params, at(0.0, 0.0)), Err(LayoutError::TooLong { .. })));
    }
}
