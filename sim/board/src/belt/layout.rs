//! Layout: which machine of the twin the settings are, and which motor of the firmware turns which of its motors.

use corehbot::kinematics::{Row, multiple};
use corehbot::motors::{MOTORS, Motor, MotorName};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_twin::description::{Description, WrongList, check_lists};
use corehbot_twin::geometry::{Workspace, workspace};
use corehbot_twin::math::ln;
use corehbot_twin::model::ways::Ways;
use corehbot_twin::params::{Each, Params};
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::drive::{Drive, NoColumn, drives};
use corehbot_twin::steps::{Column, StepTrace};

/// Motors of the largest machine.
pub const MOST_MOTORS: usize = MOTORS;

/// A switch may be met so far beyond the reach, in mm, as `twin run` has it.
const BEYOND_MM: f64 = 2.0;

/// The drive of a motor of the twin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorDrive {
    /// The firmware's motor.
    pub motor: Motor,
    /// Its name.
    pub name: MotorName,
    /// 1, or -1 if it turns in the opposite direction.
    pub sense: i8,
    /// Its steps for a step of its axes: above 1 with a smaller pulley than others.
    pub multiple: u8,
    /// Belt of its step as a part of what the steps say: other than 1 where `motor_radius_mm` says otherwise.
    pub belt_part: f64,
}

/// A machine of the twin, motor by motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The machine.
    pub machine: Machine,
    /// Its numbers, in which the frame has room for the axes and pulleys are as large as the motors' steps say.
    pub params: Params,
    /// The drive of each of its motors.
    pub drives: Vec<MotorDrive>,
}

/// Why settings have no belt plant.
#[derive(Clone, Debug, PartialEq)]
pub enum LayoutError {
    /// No motor moves x or y.
    NoMachine,
    /// The named routing needs a motor that there is not.
    NoMotor(Machine, NoColumn),
    /// The named routing has no belt for this motor.
    NoBelt(Machine, MotorName),
    /// A list of numbers does not fit the machine.
    Lists(WrongList),
    /// Pulleys leave the tool no reach in a frame of this width and depth in mm.
    NoRoom([f64; 2]),
    /// The axes are longer than the tool reaches, in mm.
    TooLong {
        /// Length of the axes.
        axes: Vec<f64>,
        /// Reach along them.
        reach: Vec<f64>,
    },
    /// The tool begins where it cannot be, in G-code's coordinates.
    OutOfReach(Vec<f64>),
    /// An accident, as it was written, of a part that the machine does not have: these motors have belts, and these
    /// pulleys could break so.
    NoPart(String, String, Vec<MotorName>, Vec<u8>),
}

/// Names or numbers, one after the other.
fn listed(all: &[impl ToString]) -> String {
    all.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

impl std::fmt::Display for LayoutError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let by = |lengths: &[f64]| lengths.iter().map(|mm| format!("{mm:.1}")).collect::<Vec<_>>().join(" by ");
        match self {
            Self::NoMachine => f.write_str("no motor moves x or y, so there are no belts"),
            Self::NoMotor(machine, NoColumn { motor, row: [x, y, z] }) => write!(
                f,
                "twin.routing = \"{}\": no motor turns ({x}, {y}, {z}) for x, y and z, as its motor {motor} must",
                machine.key()
            ),
            Self::NoBelt(machine, name) => {
                write!(f, "twin.routing = \"{}\": it has no belt for motor {name}", machine.key())
            }
            Self::Lists(wrong) => wrong.fmt(f),
            Self::NoRoom([width, depth]) => write!(
                f,
                "twin.width_mm = {width}, twin.depth_mm = {depth}: the pulleys of frame, bar and head leave the tool no \
                 room"
            ),
            Self::TooLong { axes, reach } => write!(
                f,
                "axes of {} mm: the belts of twin.width_mm, depth_mm and height_mm reach {}",
                by(axes),
                by(reach)
            ),
            Self::NoPart(_, place, motors, pulleys) if pulleys.is_empty() => {
                write!(f, "`{place}` is not a belt motor: {}", listed(motors))
            }
            Self::NoPart(_, place, motors, pulleys) => write!(
                f,
                "`{place}` is neither a belt motor ({}) nor a pulley of `corehbot twin geometry` ({})",
                listed(motors),
                listed(pulleys)
            ),
            Self::OutOfReach(place) => {
                let place: Vec<String> =
                    place.iter().zip("XYZ".chars()).map(|(mm, axis)| format!("{axis}{mm:.2}")).collect();
                write!(f, "the belt plant's tool cannot begin at {}", place.join(" "))
            }
        }
    }
}

impl std::error::Error for LayoutError {}

/// A motor's entries for x, y and z, as small as they can be.
fn reduced([x, y, z, _]: Row, multiple: i8) -> [i8; 3] {
    [x, y, z].map(|entry| entry / multiple.max(1))
}

impl Layout {
    /// The machine that these settings and this description are.
    ///
    /// # Errors
    /// No belts do that.
    pub fn new(settings: &Settings, twin: &Description) -> Result<Self, LayoutError> {
        let belt: Vec<(Motor, Row)> =
            settings.mechanism.motors().filter(|(_, [x, y, ..])| (*x, *y) != (0, 0)).collect();
        let rows: Vec<[i8; 3]> = belt.iter().map(|(_, row)| reduced(*row, multiple(*row))).collect();
        let machine = twin.machine(&rows).ok_or(LayoutError::NoMachine)?;
        check_lists(machine, &twin.params).map_err(LayoutError::Lists)?;
        let params = with_room(machine, twin.params.clone(), settings);
        if !workspace(machine, &params).has_room() {
            return Err(LayoutError::NoRoom([twin.params.width_mm, twin.params.depth_mm]));
        }
        let columns =
            belt.iter().map(|(_, [x, y, z, _])| Column { name: String::new(), row: [*x, *y, *z], axis_step: 1.0 });
        let ways = Ways::new(machine, &params);
        let turned = drives(&StepTrace::new(columns.collect(), 1.0), &ways, &params);
        let turned = turned.map_err(|missing| LayoutError::NoMotor(machine, missing))?;
        for (index, (motor, _)) in belt.iter().enumerate() {
            if turned.iter().all(|drive| drive.column != index) {
                return Err(LayoutError::NoBelt(machine, settings.name_of(*motor)));
            }
        }
        let drive = |drive: &Drive| {
            belt.get(drive.column).map(|(motor, _)| MotorDrive {
                motor: *motor,
                name: settings.name_of(*motor),
                sense: drive.sense,
                multiple: drive.multiple,
                belt_part: drive.axis_step,
            })
        };
        let drives: Vec<MotorDrive> = turned.iter().filter_map(drive).collect();
        let params = with_radii(params, &drives, settings);
        Ok(Self { machine, params, drives })
    }

    /// Where G-code's X0 Y0 and the tool are for the twin.
    ///
    /// # Errors
    /// The tool cannot be there, or cannot go where the axes go.
    pub(super) fn places(&self, settings: &Settings, place: [Mm; 3]) -> Result<(Place, Place), LayoutError> {
        let all = workspace(self.machine, &self.params);
        let axes = self.machine.axes();
        let reach = lengths(&all);
        // The axes begin in the corner.
        let begins = [settings.axis_min.x, settings.axis_min.y, settings.axis_min.z].map(Mm::to_num::<f64>);
        let place = place.map(Mm::to_num::<f64>);
        let wanted = lengths_of(settings);
        if wanted.iter().zip(reach).take(axes).any(|(length, reach)| *length > reach + BEYOND_MM) {
            let [wanted, reach] = [wanted, reach].map(|all| all.into_iter().take(axes).collect());
            return Err(LayoutError::TooLong { axes: wanted, reach });
        }
        let is_outside =
            |((at, begin), reach): ((&f64, f64), f64)| !(-BEYOND_MM..=reach + BEYOND_MM).contains(&(at - begin));
        if place.iter().zip(begins).zip(reach).take(axes).any(is_outside) {
            return Err(LayoutError::OutOfReach(place.into_iter().take(axes).collect()));
        }
        let corner = all.origin().xyz();
        // Without belts that lift it the tool is at 0.
        let at = |axis: usize, mm: f64| if axis < axes { mm } else { 0.0 };
        let origin = [0, 1, 2].map(|axis| at(axis, corner[axis] - begins[axis]));
        let start = [0, 1, 2].map(|axis| at(axis, origin[axis] + place[axis]));
        Ok((Place::of_xyz(origin), Place::of_xyz(start)))
    }
}

fn lengths(reach: &Workspace) -> [f64; 3] {
    [reach.x, reach.y, reach.z].map(|[low, high]| high - low)
}

fn lengths_of(settings: &Settings) -> [f64; 3] {
    [settings.axes.x.length, settings.axes.y.length, settings.axes.z.length].map(Mm::to_num)
}

/// Motors that make more steps for the same belt have smaller pulleys, unless the file has their radii. The pulleys of
/// the machine's radius are those that come nearest to it by their steps.
fn with_radii(mut params: Params, drives: &[MotorDrive], settings: &Settings) -> Params {
    let turn_steps = 4.0 * params.pole_pairs * f64::from(settings.drivers.belt.microsteps);
    let steps_per_mm = settings.axes.x.steps_per_mm.to_num::<f64>();
    let off = |multiple: u8| {
        let by_steps = turn_steps / (steps_per_mm * f64::from(multiple)) / std::f64::consts::TAU;
        ln(by_steps / params.pulley_radius_mm).abs()
    };
    let multiples = || drives.iter().map(|drive| drive.multiple);
    let nearest = multiples().min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(1);
    let has_two_sizes = multiples().any(|multiple| multiple != nearest);
    if has_two_sizes && params.motor_radius_mm.values().is_empty() {
        let radius = |drive: &MotorDrive| params.pulley_radius_mm * f64::from(nearest) / f64::from(drive.multiple);
        let radii: Vec<f64> = drives.iter().map(radius).collect();
        params.motor_radius_mm = Each::listed(&radii).unwrap_or(Each::NONE);
    }
    params
}

/// A frame of the nominal size grows to what the axes need: the file says nothing else about it.
fn with_room(machine: Machine, mut params: Params, settings: &Settings) -> Params {
    let nominal = Params::default();
    let lacks: Vec<f64> =
        lengths_of(settings).iter().zip(lengths(&workspace(machine, &params))).map(|(l, reach)| l - reach).collect();
    let sides = [
        (&mut params.width_mm, nominal.width_mm),
        (&mut params.depth_mm, nominal.depth_mm),
        (&mut params.height_mm, nominal.height_mm),
    ];
    for ((side, nominal), lacks) in sides.into_iter().zip(lacks).take(machine.axes()) {
        if *side == nominal && lacks > BEYOND_MM {
            *side += lacks;
        }
    }
    params
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;
    use corehbot_machine_file as machine_file;
    use corehbot_twin::description::Routing;
    use std::path::Path;

    fn layout(file: &str) -> Result<Layout, LayoutError> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines").join(file);
        let machine = machine_file::read(&path).unwrap();
        Layout::new(&machine.settings, &machine.twin)
    }

    fn turns(drive: &MotorDrive) -> (Motor, i8, u8) {
        (drive.motor, drive.sense, drive.multiple)
    }

    #[test]
    fn machines_that_the_twin_knows_are_found_by_their_motors() {
        let of = |file| layout(file).unwrap();
        let corehbot = of("prototype.toml");
        let each = prototype::BELT
            .iter()
            .map(|motor| (motor, prototype::NAMES[motor.index()]))
            .map(|(motor, name)| MotorDrive { motor, name, sense: 1, multiple: 1, belt_part: 1.0 })
            .collect::<Vec<_>>();
        assert_eq!(corehbot, Layout { machine: Machine::CoreHBot, params: Params::default(), drives: each.to_vec() });
        let motors = |layout: Layout| layout.drives.iter().map(|d| (d.motor, d.sense)).collect::<Vec<_>>();
        assert_eq!(of("corexy.toml").machine, Machine::CoreXy);
        assert_eq!(motors(of("corexy.toml")), [(prototype::M11, 1), (prototype::M8, 1)]);
        let awd = of("awd-corexy.toml");
        assert_eq!(awd.machine, Machine::AwdCoreXy);
        // Motors 1 and 8 of the twin pull one belt, which the file gives to motors 4 and 11.
        assert_eq!(motors(awd).len(), 4);
    }

    #[test]
    fn every_machine_of_the_firmware_has_belts() {
        let of = |file| layout(file).map(|layout| (layout.machine.key(), layout.drives.iter().map(turns).collect()));
        let found = |key: &'static str, drives: &[(Motor, i8, u8)]| Ok((key, drives.to_vec()));
        let [m1, m4, m8, m11] = [prototype::M1, prototype::M4, prototype::M8, prototype::M11];
        assert_eq!(of("hbot.toml"), found("hbot", &[(m11, 1, 1), (m8, 1, 1)]));
        // Each driver has two motors that turn in opposite directions.
        let pairs = [(m1, 1, 1), (m4, 1, 1), (m1, -1, 1), (m4, -1, 1)];
        assert_eq!(of("corehbot-two-drivers.toml"), found("corehbot", &pairs));
        assert_eq!(of("core-unequal.toml"), found("corexy", &[(m11, 1, 4), (m8, 1, 5)]));
        let all = [(m1, 1, 1), (m4, 1, 1), (m8, 1, 1), (m11, 1, 1)];
        assert_eq!(of("corexyz.toml"), found("corexyz", &all));
        assert_eq!(of("corexyz-three.toml"), found("corexyz-three", &all[1..]));
        for (file, key, motors) in [
            ("cartesian.toml", "straight", 2),
            ("cartesian-xz.toml", "moving-bed", 2),
            ("dual-y.toml", "straight", 3),
            ("corexz.toml", "moving-bed", 3),
        ] {
            let layout = layout(file).unwrap();
            assert_eq!((layout.machine.key(), layout.drives.len()), (key, motors), "{file}");
        }
    }

    #[test]
    fn pulleys_of_two_sizes_follow_from_the_steps() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines/core-unequal.toml");
        let settings = machine_file::read(&path).unwrap().settings;
        let layout = Layout::new(&settings, &Description::default()).unwrap();
        // 16 of 20 teeth.
        let radii = layout.params.motor_radius_mm.values().to_vec();
        assert!((radii[0] - 6.35).abs() < 1e-12 && (radii[1] - 5.08).abs() < 1e-12, "{radii:?}");
    }

    #[test]
    fn what_rubs_is_a_motor_with_a_belt_by_the_name_of_its_file() {
        let why = |file: &str, name: &str| {
            let accident = format!("rub:{name}@1s").parse().unwrap();
            layout(file).unwrap().motors_of(&accident).map_err(|error| error.to_string())
        };
        assert_eq!(why("prototype.toml", "m8"), Ok(vec![2]));
        assert_eq!(why("prototype.toml", "z1"), Err("`z1` is not a belt motor: m1, m4, m8, m11".to_owned()));
        // Motors of other machines have other names, and two of a pair share one.
        assert_eq!(why("dual-y.toml", "m1").is_err(), !named("dual-y.toml").contains(&"m1".to_owned()));
        for file in ["cartesian.toml", "dual-y.toml", "corexz.toml", "corehbot-two-drivers.toml", "corexyz.toml"] {
            for name in named(file) {
                assert!(why(file, &name).is_ok(), "{file}");
            }
            assert!(why(file, "e0").is_err_and(|error| error.ends_with(&named(file).join(", "))), "{file}");
        }
    }

    /// The different names of the belt motors of a machine.
    fn named(file: &str) -> Vec<String> {
        let names = layout(file).unwrap().drives.into_iter().map(|drive| drive.name.to_string());
        names.fold(Vec::new(), |mut all, name| {
            if !all.contains(&name) {
                all.push(name);
            }
            all
        })
    }

    #[test]
    fn a_routing_that_does_not_fit_the_motors_is_refused() {
        let named = |key: &str| Description { routing: Routing::of(key), ..Description::default() };
        let wrong = |key| Layout::new(&Settings::prototype(), &named(key)).unwrap_err().to_string();
        assert_eq!(wrong("hbot"), "twin.routing = \"hbot\": it has no belt for motor m1");
        let text = wrong("corexyz");
        assert!(text.starts_with("twin.routing = \"corexyz\": no motor turns (-1, 1, 1)"), "{text}");
    }

    #[test]
    fn a_tool_beyond_its_belts_is_refused() {
        let mut settings = Settings::prototype();
        let twin = Description::default();
        let layout = Layout::new(&settings, &twin).unwrap();
        let at = |x: f64, y: f64| [x, y, 0.0].map(Mm::from_num);
        let (origin, start) = layout.places(&settings, at(100.0, 50.0)).unwrap();
        assert!((origin.x - 40.0).abs() < 1e-9 && (origin.y - 26.2).abs() < 1e-9 && (start.x - 140.0).abs() < 1e-9);
        assert_eq!(layout.places(&settings, at(400.0, 0.0)), Err(LayoutError::OutOfReach(vec![400.0, 0.0])));
        // Axes that begin to the left of 0: their least position is the same corner.
        settings.axis_min.x = Mm::from_num(-40);
        let (origin, start) = layout.places(&settings, at(60.0, 50.0)).unwrap();
        assert!((origin.x - 80.0).abs() < 1e-9 && (start.x - 140.0).abs() < 1e-9);
        assert_eq!(layout.places(&settings, at(355.0, 0.0)), Err(LayoutError::OutOfReach(vec![355.0, 0.0])));
        settings.axes.y.length = Mm::from_num(500);
        assert!(matches!(layout.places(&settings, at(0.0, 0.0)), Err(LayoutError::TooLong { .. })));
        // A frame of the nominal size grows with its axes, one that the file measured does not.
        let grown = Layout::new(&settings, &twin).unwrap();
        assert!((grown.params.depth_mm - 552.4).abs() < 1e-9 && grown.places(&settings, at(0.0, 0.0)).is_ok());
        let measured = Description { params: Params { depth_mm: 480.0, ..Params::default() }, ..twin };
        let layout = Layout::new(&settings, &measured).unwrap();
        assert!(matches!(layout.places(&settings, at(0.0, 0.0)), Err(LayoutError::TooLong { .. })));
    }
}
