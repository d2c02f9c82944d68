//! The jobs: the prints to measure.

use corehbot::connectors::Heater;
use corehbot::motion::LOOKAHEAD_MOVES;
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::surface::{Heights, Mesh};
use corehbot::units::{Hertz, Mm, MmPerSec, Ratio, Seconds, StepsPerMm};
use std::fmt::{self, Write as _};

/// Moves that the look-ahead takes before any leaves.
const GATHERED: u32 = 140;
const _: () =
    assert!(GATHERED as usize <= LOOKAHEAD_MOVES && GATHERED as usize > LOOKAHEAD_MOVES - 16, "nearly all of it");

/// Moves of the planner's job: two look-aheads.
const MOVES: u32 = 300;
const _: () = assert!(MOVES as usize / LOOKAHEAD_MOVES == 2, "the table in docs/explanation/performance.md is of two");

/// Moves of the circle: few enough for the look-ahead, so that no line waits for the motion.
const CHORDS: u32 = 120;

/// Where the tool stands at first.
const START: [i32; 3] = [10, 10, 5];

/// Where it stands on a mesh, so low that all of the mesh counts.
const FIRST_LAYER: Mm = Mm::lit("0.25");

/// The mesh: five by five heights up to 0.15 mm up and down, in units of half a micrometre. They were rolled once. A
/// real bed bends less.
const HEIGHTS: [[i16; 5]; 5] = [
    [-212, 148, 31, -95, 240],
    [66, -287, 173, 205, -138],
    [251, 12, -164, 88, -29],
    [-120, 233, -61, -246, 177],
    [94, -183, 269, 47, -8],
];
const CORNERS: [[i32; 2]; 2] = [[0, 0], [360, 360]];
const FADE: Mm = Mm::const_from_int(10);

/// A job.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, clap::ValueEnum)]
pub enum Job {
    /// X+60 Y+25 with 2,400 steps of E at 100 mm/s, 3000 mm/s2 and 80 steps/mm: the job that the peers were given.
    S,
    /// The same with input shapers (MZV, 60 Hz) and pressure advance (0.05 s).
    Shaped,
    /// X+240 Y+100 with 9,600 steps of E at 300 mm/s and 1280 steps/mm (256 microsteps), shaped as well: little but
    /// steps, 1.42 million motor steps a second. Settings allow 500,000 steps a second of a motor, which the faster
    /// belt pair makes.
    Dense,
    /// X+240 alone, else as before: all four belt motors step in the same events.
    Axis,
    /// 300 moves of 0.2 mm in a straight line at up to 300 mm/s, which they never reach. Their feeds differ by turns,
    /// or they would be joined.
    Planner,
    /// The first 140 of them, which are all planned before motion begins.
    Gathered,
    /// A circle of 120 moves of half a millimetre at 100 mm/s, its lines numbered and with checksums.
    Parse,
    /// The same circle without numbers.
    Plain,
    /// `Shaped` on a mesh, at the height of the first layer.
    Meshed,
    /// `Gathered` on the mesh.
    MeshedMoves,
    /// The circle on a machine with hotend and bed, which are heated during the print.
    Heat,
}

impl Job {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::S,
        Self::Shaped,
        Self::Dense,
        Self::Axis,
        Self::Planner,
        Self::Gathered,
        Self::Parse,
        Self::Plain,
        Self::Meshed,
        Self::MeshedMoves,
        Self::Heat,
    ];

    /// The host's lines.
    pub fn gcode(self) -> String {
        match self {
            Self::S | Self::Shaped | Self::Meshed => "G1 X70 Y35 E6 F6000\n".to_owned(),
            Self::Dense => "G1 X250 Y110 E24 F18000\n".to_owned(),
            Self::Axis => "G1 X250 E24 F18000\n".to_owned(),
            Self::Planner | Self::Gathered | Self::MeshedMoves => line(self.moves()),
            Self::Parse | Self::Plain => circle(),
            Self::Heat => format!("M302 P1\nM140 S60\nM104 S200\n{}", circle()),
        }
    }

    /// The machine.
    pub fn settings(self) -> Settings {
        let mut settings = Settings::prototype();
        // The settling time of rotors is not work.
        settings.belt.settling_ms = 0;
        if matches!(self, Self::Shaped | Self::Meshed | Self::Dense | Self::Axis) {
            let shaper = Shaper::new(ShaperKind::Mzv, Hertz::from_num(60), Ratio::from_num(0.1));
            (settings.shapers.x, settings.shapers.y) = (shaper, shaper);
            settings.advance.time = Seconds::from_num(0.05);
        }
        if self == Self::Heat {
            for heater in [Heater::Hotend, Heater::Bed] {
                settings.thermal.heater_mut(heater).is_fitted = true;
            }
        }
        if matches!(self, Self::Dense | Self::Axis) {
            for axis in [&mut settings.axes.x, &mut settings.axes.y] {
                axis.steps_per_mm = StepsPerMm::from_num(1280);
            }
            settings.motor_max_speed = MmPerSec::from_num(390);
        }
        settings
    }

    /// Where it stands.
    pub fn start(self) -> [Mm; 3] {
        let [x, y, z] = START.map(Mm::from_num);
        [x, y, if self.is_on_mesh() { FIRST_LAYER } else { z }]
    }

    const fn is_on_mesh(self) -> bool {
        matches!(self, Self::Meshed | Self::MeshedMoves)
    }

    /// The mesh that z follows.
    pub fn mesh(self) -> Option<Mesh> {
        let heights = Heights::filled(5, 5, |column, row| HEIGHTS.get(row)?.get(column).copied())?;
        let [first, last] = CORNERS.map(|corner| corner.map(Mm::from_num));
        Mesh::new(heights, first, last, FADE).ok().filter(|_| self.is_on_mesh())
    }

    /// Moves in it.
    pub const fn moves(self) -> u32 {
        match self {
            Self::S | Self::Shaped | Self::Meshed | Self::Dense | Self::Axis => 1,
            Self::Planner => MOVES,
            Self::Gathered | Self::MeshedMoves => GATHERED,
            Self::Parse | Self::Plain | Self::Heat => CHORDS,
        }
    }

    /// Whether its lines have numbers and checksums.
    pub fn is_numbered(self) -> bool {
        self != Self::Plain
    }
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::S => "s",
            Self::Shaped => "shaped",
            Self::Dense => "dense",
            Self::Axis => "axis",
            Self::Planner => "planner",
            Self::Gathered => "gathered",
            Self::Parse => "parse",
            Self::Plain => "plain",
            Self::Meshed => "meshed",
            Self::MeshedMoves => "meshed-moves",
            Self::Heat => "heat",
        })
    }
}

fn line(moves: u32) -> String {
    let mut text = String::from("G1 F18000\n");
    for i in 1..=moves {
        let along = f64::from(i);
        // Writing into a String cannot fail.
        let (x, y, e, feed) = (10.0 + 0.16 * along, 10.0 + 0.12 * along, 0.00665 * along, 18_000 - i % 2);
        let _ = writeln!(text, "G1 X{x:.3} Y{y:.3} E{e:.5} F{feed}");
    }
    text
}

fn circle() -> String {
    let mut text = String::from("G1 F6000\n");
    let radius = 0.5 * f64::from(CHORDS) / std::f64::consts::TAU;
    for i in 1..=CHORDS {
        let angle = f64::from(i) * std::f64::consts::TAU / f64::from(CHORDS);
        let (x, y) = (10.0 + radius * (1.0 - angle.cos()), 35.0 + radius * angle.sin());
        let _ = writeln!(text, "G1 X{x:.3} Y{y:.3} E{:.5}", 0.01745 * f64::from(i));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::Job;

    #[test]
    fn jobs_are_for_machines_that_can_be() {
        for job in Job::ALL {
            assert_eq!(job.settings().check(), Ok(()), "{job}");
            assert_eq!(job.mesh().is_some(), job.is_on_mesh(), "{job}");
        }
    }
}
