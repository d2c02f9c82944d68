//! The frame in one picture: the torque of all motors on it by machine, and the frequencies of tool and frame by the
//! frame's stiffness.

use super::compare::COMPARED;
use super::frame::FrameTorque;
use corehbot_twin::geometry::workspace;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::params::Each;
use corehbot_twin::queries::{At, Setup, shown};
use corehbot_twin::routing::Machine;
use corehbot_twin::solve::NotHeld;
use corehbot_twin::solve::modes::{Mode, modes};
use serde::Serialize;

/// Stiffnesses of the frame in N/mm: from softer than the belts to ten times as stiff, in steps of 50 (assumed).
const SOFTEST: f64 = 50.0;
const COUNT: u32 = 60;

/// Directions in which a frame on springs moves.
const FRAME_AXES: usize = 2;

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SoftFrame {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// Torques of the compared machines, and of this one, in the middle of the reach.
    pub torques: Vec<MachineTorque>,
    /// Frequencies of tool and frame by the frame's stiffness.
    pub frames: Vec<OnFrame>,
    /// Frequencies of the tool on a rigid frame, ascending.
    #[serde(rename = "rigid_Hz")]
    pub rigid_hz: Vec<f64>,
}

/// The motors' torque on the frame of a machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MachineTorque {
    /// The machine.
    pub machine: &'static str,
    /// For an acceleration along x.
    pub x: FrameTorque,
    /// The same along y.
    pub y: FrameTorque,
}

/// A frame of one stiffness along x and y.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnFrame {
    /// Its stiffness on the ground.
    #[serde(rename = "frame_stiffness_N_per_mm")]
    pub stiffness_n_per_mm: f64,
    /// Frequencies of tool and frame, ascending.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<f64>,
    /// The axis of each: the one along which tool and frame have most of the energy.
    pub along: Vec<&'static str>,
}

/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The axis along which tool and frame have most of the energy of a mode.
fn axis_of(mode: &Mode) -> &'static str {
    let share = |axis: usize| {
        let tool = Coordinate::TOOL.get(axis).map_or(0.0, |tool| mode.share(*tool));
        tool + mode.share(Coordinate::Frame(axis))
    };
    let most = (0..AXES.len()).max_by(|a, b| share(*a).total_cmp(&share(*b)));
    most.and_then(|axis| AXES.get(axis)).copied().unwrap_or_default()
}

impl SoftFrame {
    /// The answer. A stiffness of the frame in the setup does not count.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup) -> Result<Self, NotHeld> {
        let others = COMPARED.into_iter().filter(|machine| *machine != setup.machine);
        let has_room = |machine: &Machine| workspace(*machine, &setup.params).has_room();
        let torque = |machine: Machine| {
            let [x, y] = FrameTorque::new(machine, &setup.params, workspace(machine, &setup.params).centre())?;
            Ok(MachineTorque { machine: machine.key(), x, y })
        };
        let torques =
            std::iter::once(setup.machine).chain(others.filter(has_room)).map(torque).collect::<Result<_, _>>()?;
        let lowest = |stiffness: Each, count: usize| {
            let mut on = setup.clone();
            on.params.frame_stiffness_n_per_mm = stiffness;
            let lowest = modes(&on.elastic())?.into_iter().take(count);
            Ok(lowest.map(|mode| (mode.frequency_hz, axis_of(&mode))).unzip())
        };
        let axes = setup.machine.axes();
        let frame = |i: u32| {
            let stiffness_n_per_mm = SOFTEST * f64::from(i);
            let (frequencies_hz, along) = lowest(Each::all(stiffness_n_per_mm), axes + FRAME_AXES)?;
            Ok(OnFrame { stiffness_n_per_mm, frequencies_hz, along })
        };
        let rigid: (Vec<f64>, Vec<&'static str>) = lowest(Each::NONE, axes)?;
        Ok(Self {
            at: setup.at(),
            torques,
            frames: (1..=COUNT).map(frame).collect::<Result<_, _>>()?,
            rigid_hz: rigid.0,
        })
    }
}

impl std::fmt::Display for SoftFrame {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "Torque of all motors on their rotors for 1 m/s2, mN m; the frame bears the opposite one")?;
        writeln!(f, "  {:<14} {:>9} {:>9} {:>9} {:>9}", "", "along x", "rotors", "printed", "along y")?;
        for MachineTorque { machine, x, y } in &self.torques {
            let [belts, rotors, printed, along_y] =
                [x.belts_mnm, x.rotors_mnm, x.printed_mnm, y.belts_mnm + y.rotors_mnm].map(|torque| shown(torque, 2));
            writeln!(f, "  {:<14} {belts:>9} {rotors:>9} {printed:>9} {along_y:>9}", Machine::name_of(machine))?;
        }
        writeln!(f, "{}: frequencies of tool and frame, Hz", self.at)?;
        let line = |all: &[f64]| all.iter().map(|hz| format!("{hz:>8.2}")).collect::<String>();
        for frame in self.frames.iter().filter(|frame| frame.stiffness_n_per_mm % 500.0 == 0.0) {
            let (all, along) = (line(&frame.frequencies_hz), frame.along.join(" "));
            writeln!(f, "  frame {:>5} N/mm {all}  along {along}", frame.stiffness_n_per_mm)?;
        }
        writeln!(f, "  rigid            {}", line(&self.rigid_hz))
    }
}
