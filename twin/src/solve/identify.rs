//! Identify: how stiff belts and motors are, from frequencies that were measured.
//!
//! Two numbers are sought, the belt's tensile stiffness and the motors' holding torque (which is the stiffness of their
//! fields), such that the model rings as was measured: least squares of the logarithms of frequencies, by Gauss and Newton.
//! Masses are taken as given. A number that the frequencies do not tell, as the torque of motors that do not give way, stays
//! within a hundredfold. If the machine that is found does not ring as was measured, it is none, and that is an error.

use super::NotHeld;
use super::modes::{mode_of, modes};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, Freedom};
use crate::params::Params;
use crate::routing::{Machine, Place};
use serde::Serialize;

/// Frequencies that were measured at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// The tool's place.
    pub at: Place,
    /// What x rang at, if it was measured, and y, in Hz.
    pub frequencies_hz: [Option<f64>; 2],
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// Tensile stiffness of the belt.
    #[serde(rename = "belt_EA_N")]
    pub belt_ea_n: f64,
    /// Holding torque of the motors.
    #[serde(rename = "holding_torque_Nm")]
    pub holding_torque_nm: f64,
    /// Greatest difference between what was measured and what the model says, of 1.
    pub worst_difference: f64,
}

/// Why nothing was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IdentifyError {
    /// Nothing holds the machine.
    NotHeld(NotHeld),
    /// The nearest machine does not ring like this.
    Unlike(Unlike),
    /// Only a belt of this stiffness would, in N, and there is none like it.
    NoBelt(f64),
}

/// The frequency from which the nearest machine is furthest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unlike {
    /// The tool's place.
    pub at: Place,
    /// The axis.
    pub axis: Coordinate,
    /// What was measured.
    pub measured_hz: f64,
    /// What the nearest machine rings at.
    pub says_hz: f64,
}

impl std::fmt::Display for IdentifyError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotHeld(error) => error.fmt(f),
            Self::Unlike(Unlike { at, axis, measured_hz, says_hz }) => {
                write!(f, "no belt and motors ring like this: at ({:.1}, {:.1}) mm {axis} rang at ", at.x, at.y)?;
                write!(
                    f,
                    "{measured_hz:.1} Hz, the nearest machine at {says_hz:.1}; measure it again (the slowest strong "
                )?;
                f.write_str("peak, x and y not swapped), and give masses that are not the nominal ones by --params")
            }
            Self::NoBelt(belt_ea_n) => {
                write!(
                    f,
                    "only a belt of {belt_ea_n:.0} N would ring like this, and those sold have 20000 to 56000; "
                )?;
                f.write_str(
                    "measure again (the slowest strong peak, x and y not swapped), and give masses that are not the ",
                )?;
                f.write_str("nominal ones by --params")
            }
        }
    }
}

impl std::error::Error for IdentifyError {}

impl From<NotHeld> for IdentifyError {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

/// Frequencies are measured to 1.5 % (a phone's accelerometer, docs/twin.md), so a machine that is further from one than three
/// times that is another.
pub const LIKE: f64 = 0.045;

/// Belts differ from the nominal one by less than this factor, as a logarithm: ten, where those sold have 20 to 56 kN.
const NO_BELT: f64 = 2.3;

/// Rounds of the search; it ends in a few.
const ROUNDS: usize = 40;

/// A number is changed by this part to see what follows.
const PROBE: f64 = 1e-5;

/// Neither number changes by more than this factor in a round (as a logarithm).
const LONGEST_STEP: f64 = 0.7;

/// Nor by more than a hundredfold in all (as a logarithm).
const FURTHEST: f64 = 4.605;

/// Keeps a number that the frequencies do not tell where it is.
const RIDGE: f64 = 1e-9;

/// Belts and motors of a machine that rang like this.
///
/// # Errors
/// Nothing holds the machine, or none rings like this.
pub fn identify(machine: Machine, params: &Params, rung: &[Rung]) -> Result<Identified, IdentifyError> {
    let mut logs = [0.0_f64; 2];
    for _ in 0..ROUNDS {
        let now = logs_of(&compared(machine, &with(params, logs), rung)?);
        let mut slopes = [Vec::new(), Vec::new()];
        for (i, slope) in slopes.iter_mut().enumerate() {
            let mut probed = logs;
            if let Some(log) = probed.get_mut(i) {
                *log += PROBE;
            }
            let then = logs_of(&compared(machine, &with(params, probed), rung)?);
            *slope = then.iter().zip(&now).map(|(a, b)| (a - b) / PROBE).collect::<Vec<f64>>();
        }
        let step = newton(&slopes, &now);
        for (log, step) in logs.iter_mut().zip(step) {
            *log = (*log + step.clamp(-LONGEST_STEP, LONGEST_STEP)).clamp(-FURTHEST, FURTHEST);
        }
        if step.iter().all(|step| step.abs() < 1e-10) {
            break;
        }
    }
    let found = with(params, logs);
    let left = compared(machine, &found, rung)?;
    let worst = left.into_iter().max_by(|a, b| a.log().abs().total_cmp(&b.log().abs()));
    let worst_difference = worst.map_or(0.0, |worst| worst.log().abs());
    match worst {
        Some(worst) if worst_difference > LIKE => Err(IdentifyError::Unlike(worst)),
        _ if logs[0].abs() > NO_BELT => Err(IdentifyError::NoBelt(found.belt_ea_n)),
        _ => {
            Ok(Identified { belt_ea_n: found.belt_ea_n, holding_torque_nm: found.holding_torque_nm, worst_difference })
        }
    }
}

fn with(params: &Params, [belt, torque]: [f64; 2]) -> Params {
    Params {
        belt_ea_n: params.belt_ea_n * belt.exp(),
        holding_torque_nm: params.holding_torque_nm * torque.exp(),
        ..params.clone()
    }
}

impl Unlike {
    /// By how much the model rings faster, as a logarithm.
    fn log(&self) -> f64 {
        (self.says_hz / self.measured_hz).ln()
    }
}

fn logs_of(compared: &[Unlike]) -> Vec<f64> {
    compared.iter().map(Unlike::log).collect()
}

/// Each frequency beside the model's.
fn compared(machine: Machine, params: &Params, rung: &[Rung]) -> Result<Vec<Unlike>, NotHeld> {
    let freedom = Freedom { idlers: true, rotors: true, ..Freedom::default() };
    let mut all = Vec::new();
    for Rung { at, frequencies_hz } in rung {
        let modes = modes(&Elastic::new(machine, params, *at, freedom))?;
        for (axis, measured) in [Coordinate::X, Coordinate::Y].into_iter().zip(frequencies_hz) {
            if let (Some(mode), Some(measured_hz)) = (mode_of(&modes, axis), *measured) {
                all.push(Unlike { at: *at, axis, measured_hz, says_hz: mode.frequency_hz });
            }
        }
    }
    Ok(all)
}

/// The step that would make the differences least if they went on as they go.
fn newton([first, second]: &[Vec<f64>; 2], differences: &[f64]) -> [f64; 2] {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (aa, bb, ab) = (dot(first, first) + RIDGE, dot(second, second) + RIDGE, dot(first, second));
    let (a, b) = (dot(first, differences), dot(second, differences));
    let determinant = aa * bb - ab * ab;
    [-(bb * a - ab * b) / determinant, -(aa * b - ab * a) / determinant]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measure(params: &Params) -> Vec<Rung> {
        let places = [(235.0, 235.0), (60.0, 50.0)];
        let freedom = Freedom { idlers: true, rotors: true, ..Freedom::default() };
        let ring = |(x, y)| {
            let at = Place { x, y };
            let modes = modes(&Elastic::new(Machine::CoreHBot, params, at, freedom)).unwrap();
            Rung { at, frequencies_hz: [Some(modes[1].frequency_hz), Some(modes[0].frequency_hz)] }
        };
        places.map(ring).to_vec()
    }

    #[test]
    fn belts_and_motors_are_found_again_from_two_places() {
        let true_params = Params { belt_ea_n: 41_000.0, holding_torque_nm: 0.27, ..Params::default() };
        let found = identify(Machine::CoreHBot, &Params::default(), &measure(&true_params)).unwrap();
        assert!((found.belt_ea_n / 41_000.0 - 1.0).abs() < 1e-5, "{found:?}");
        assert!((found.holding_torque_nm / 0.27 - 1.0).abs() < 1e-5, "{found:?}");
        assert!(found.worst_difference < 1e-7, "{found:?}");
    }

    /// Half a percent of error in every frequency, one way here and the other way there.
    #[test]
    fn errors_of_measurement_are_told_and_do_little() {
        let mut rung = measure(&Params::default());
        for (i, rung) in rung.iter_mut().enumerate() {
            let part = if i == 0 { 1.005 } else { 0.995 };
            rung.frequencies_hz = rung.frequencies_hz.map(|hz| hz.map(|hz| hz * part));
        }
        let found = identify(Machine::CoreHBot, &Params::default(), &rung).unwrap();
        assert!((found.belt_ea_n / 30_000.0 - 1.0).abs() < 0.15, "{found:?}");
        assert!(found.worst_difference < 0.006, "{found:?}");
    }

    /// Harmonics, swapped axes, another machine: what is found would ring within 217 %, 56 % and so on.
    #[test]
    fn frequencies_of_no_machine_are_refused() {
        let found = |rung: &[[f64; 4]]| {
            let rung: Vec<Rung> = rung
                .iter()
                .map(|[x, y, fx, fy]| Rung { at: Place { x: *x, y: *y }, frequencies_hz: [Some(*fx), Some(*fy)] })
                .collect();
            identify(Machine::CoreHBot, &Params::default(), &rung)
        };
        let harmonic = found(&[[235.0, 235.0, 101.4, 57.6], [60.0, 50.0, 215.6, 61.9]]).unwrap_err();
        let told = harmonic.to_string();
        assert!(told.contains("at (60.0, 50.0) mm x rang at 215.6 Hz") && told.contains("measure it again"), "{told}");
        assert!(matches!(found(&[[235.0, 235.0, 57.6, 101.4]]), Err(IdentifyError::Unlike(_))));
        assert!(matches!(found(&[[235.0, 235.0, 10.1, 5.76]]), Err(IdentifyError::NoBelt(_))));
        assert!(found(&[[235.0, 235.0, 101.4, 57.6], [60.0, 50.0, 107.6, 62.0]]).is_ok());
    }
}
