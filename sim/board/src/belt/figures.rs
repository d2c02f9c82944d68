//! Figures: the state of the machine after a print, for a person and for a program.

use super::BeltPlant;
use super::layout::MotorDrive;
use corehbot::motors::MotorName;
use corehbot_twin::math::hypot;
use serde::Serialize;
use std::fmt;

/// Full steps of an electrical turn.
const FULL_STEPS: i32 = 4;

/// The figures of one print on the belt plant. The names of the fields are those of the JSON.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct BeltFigures {
    /// The machine as the twin has it.
    pub machine: &'static str,
    /// The seed of the phases; `None` if they are 0.
    pub seed: Option<u64>,
    /// The motors.
    pub motors: Vec<MotorFigures>,
    /// Skips, in order.
    pub skips: Vec<SkipFigures>,
    /// Strain of the belt at the end, in mm; `None` on a machine that cannot strain it.
    pub residual_mm: Option<f64>,
    /// Error of the tool's position at the end, in mm; `None` before homing.
    pub off_mm: Option<f64>,
    /// The same in x and y.
    pub off_xy_mm: Option<[f64; 2]>,
    /// In z, where belts lift the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_z_mm: Option<f64>,
    /// The largest position error since homing, in mm.
    pub largest_off_mm: f64,
    /// Hits at places that the tool never reached.
    pub missed_hits: usize,
    /// Accidents of parts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub accidents: Vec<PartFigures>,
}

/// An accident of a part.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct PartFigures {
    /// As it was written.
    pub accident: String,
    /// When it began, in s of motion time; `None` if its time never came.
    pub began_s: Option<f64>,
    /// By how much belt the motor's pulley is ahead of the motor in the end, in mm, if it is about that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub belt_ahead_mm: Option<f64>,
}

/// The load of a motor.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct MotorFigures {
    /// The name of its driver's motor.
    pub motor: MotorName,
    /// Its own name: with a number if two motors share a driver, in the order of the belt.
    pub name: String,
    /// The largest part of its torque that it bore, of 1.
    pub largest_torque_share: f64,
}

/// A motor that skipped.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct SkipFigures {
    /// Its name.
    pub motor: MotorName,
    /// By how many electrical turns, ahead of where it was sent if positive.
    pub turns: i32,
    /// When, in s of motion time.
    pub time_s: f64,
    /// Where the tool was, in x and y of G-code.
    pub at_mm: [f64; 2],
}

impl BeltPlant {
    /// The figures so far.
    #[must_use]
    pub fn figures(&self) -> BeltFigures {
        let off = self.off_mm();
        let drives = &self.layout.drives;
        let name = |index: usize, motor: MotorName| {
            let of_driver = |drives: &[MotorDrive]| drives.iter().filter(|drive| drive.name == motor).count();
            let is_shared = of_driver(drives) > 1;
            if is_shared { format!("{motor}.{}", of_driver(&drives[..=index])) } else { motor.to_string() }
        };
        let motor = |(index, (drive, rotor)): (usize, (&MotorDrive, &corehbot_twin::stepped_machine::rotor::Rotor))| {
            MotorFigures {
                motor: drive.name,
                name: name(index, drive.name),
                largest_torque_share: rounded(rotor.greatest_share()),
            }
        };
        let skip =
            |skip: &SkipFigures| SkipFigures { time_s: rounded(skip.time_s), at_mm: skip.at_mm.map(rounded), ..*skip };
        let part = |(accident, began_s, motor): (&str, Option<f64>, Option<usize>)| PartFigures {
            accident: accident.to_owned(),
            began_s: began_s.map(rounded),
            belt_ahead_mm: motor.map(|motor| rounded(self.layout.sense(motor) * self.live.shifted_mm(motor))),
        };
        // Rotors are asked one after another, so a later one may tell of an earlier skip.
        let mut skips: Vec<_> = self.skips.iter().map(skip).collect();
        skips.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        BeltFigures {
            machine: self.live.machine().name(),
            seed: self.seed,
            motors: drives.iter().zip(self.live.rotors()).enumerate().map(motor).collect(),
            skips,
            residual_mm: self.live.residual_mm().map(rounded),
            off_mm: off.map(|[x, y, z]| rounded(hypot(hypot(x, y), z))),
            off_xy_mm: off.map(|[x, y, _]| [x, y].map(rounded)),
            off_z_mm: off.filter(|_| self.live.machine().lifts()).map(|[_, _, z]| rounded(z)),
            largest_off_mm: rounded(self.largest_off_mm),
            missed_hits: self.trouble.missed_hits(),
            accidents: self.trouble.of_parts().map(part).collect(),
        }
    }
}

/// To four decimals: a tenth of a micrometre.
fn rounded(value: f64) -> f64 {
    // No -0.
    (value * 1e4).round() / 1e4 + 0.0
}

impl fmt::Display for BeltFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let phases = self.seed.map_or_else(|| "phases 0".to_owned(), |seed| format!("phases of seed {seed}"));
        writeln!(f, "{:<18} {}, {phases}", "belt plant", self.machine)?;
        let shares: Vec<String> =
            self.motors.iter().map(|m| format!("{} {:.0} %", m.name, m.largest_torque_share * 100.0)).collect();
        writeln!(f, "{:<18} {} at most", "torque share", shares.join(", "))?;
        if let Some(residual) = self.residual_mm {
            writeln!(f, "{:<18} {residual:.3} mm", "residual")?;
        }
        match self.off_xy_mm.zip(self.off_mm) {
            Some(([x, y], off)) => {
                let at_most = self.largest_off_mm;
                let z = self.off_z_mm.map_or_else(String::new, |z| format!(", z {z:.3}"));
                writeln!(f, "{:<18} {off:.3} mm off (x {x:.3}, y {y:.3}{z}), {at_most:.3} at most", "tool")?;
            }
            None => writeln!(f, "{:<18} no homing is known of", "tool")?,
        }
        if self.missed_hits > 0 {
            writeln!(f, "{:<18} {} that the tool never came by", "hits", self.missed_hits)?;
        }
        for part in &self.accidents {
            writeln!(f, "{:<18} {part}", "accident")?;
        }
        writeln!(f, "{:<18} {}", "skips", self.skips.len())?;
        for skip in &self.skips {
            writeln!(f, "  {skip}")?;
        }
        Ok(())
    }
}

impl fmt::Display for PartFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { accident, began_s, belt_ahead_mm } = self;
        let Some(began_s) = began_s else { return write!(f, "{accident}: its time never came") };
        write!(f, "{accident}: at {began_s:.3} s")?;
        match belt_ahead_mm {
            Some(mm) => {
                let place = if *mm < 0.0 { "behind" } else { "ahead of" };
                write!(f, ", belt {:.3} mm {place} the motor", mm.abs())
            }
            None => Ok(()),
        }
    }
}

impl fmt::Display for SkipFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { motor, turns, time_s, at_mm: [x, y] } = self;
        let steps = turns * FULL_STEPS;
        write!(f, "{motor} by {steps:+} full steps at {time_s:.3} s, X{x:.2} Y{y:.2}")
    }
}
