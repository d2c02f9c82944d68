//! Identify: stiffness of belts and motors from measured frequencies.
//!
//! The fit finds the belt's tensile stiffness and the motors' holding torque (the stiffness of their fields) with which
//! the model has the measured frequencies, by [`least_squares`](super::least_squares). Masses are given. A number that
//! the frequencies do not determine, such as the torque of rigid motors, stays within a factor of a hundred. If the
//! fitted machine does not have the measured frequencies, that is an error.

use super::NotHeld;
use super::least_squares::{FURTHEST, NoMinimum, PROBE, Problem, nearest_minimum};
use super::modes::{mode_of, modes};
use crate::math::{exp, ln};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, Freedom};
use crate::params::Params;
use crate::routing::{Machine, Place};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Frequencies measured at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// The tool's place.
    pub at: Place,
    /// Measured frequencies of x and y in Hz, where there are any.
    pub frequencies_hz: [Option<f64>; 2],
}

/// Result of the fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// Tensile stiffness of the belt.
    #[serde(rename = "belt_EA_N")]
    pub belt_ea_n: f64,
    /// Holding torque of the motors.
    #[serde(rename = "holding_torque_Nm")]
    pub holding_torque_nm: f64,
    /// Largest relative difference between measurement and model, of 1.
    pub worst_difference: f64,
}

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IdentifyError {
    /// Nothing holds the machine.
    NotHeld(NotHeld),
    /// The nearest machine does not have these frequencies.
    Unlike(Unlike),
    /// Only a belt of this stiffness, in N, would fit, and no belt has it.
    NoBelt(f64),
}

/// The frequency with the largest difference from the nearest machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unlike {
    /// The tool's place.
    pub at: Place,
    /// The axis.
    pub axis: Coordinate,
    /// The measured frequency.
    pub measured_hz: f64,
    /// The frequency of the nearest machine.
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
                f.write_str("peak, x and y not swapped), and give masses that are not the nominal ones in [twin]")
            }
            Self::NoBelt(belt_ea_n) => {
                write!(
                    f,
                    "only a belt of {belt_ea_n:.0} N would ring like this, and those sold have 20000 to 56000; "
                )?;
                f.write_str(
                    "measure again (the slowest strong peak, x and y not swapped), and give masses that are not the ",
                )?;
                f.write_str("nominal ones in [twin]")
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

/// Frequencies are measured to 1.5 % (a phone's accelerometer, docs/research/twin.md). A machine further than three
/// times that from one is another machine.
pub const LIKE: f64 = 0.045;

/// Belts differ from the nominal one by less than this factor, as a logarithm: ten, where those sold have 20 to 56 kN.
const NO_BELT: f64 = 2.3;

/// Standard uncertainty of a frequency.
const UNCERTAINTY: f64 = LIKE / 3.0;

/// Weight that keeps an undetermined number in place: it is expected within a factor of e^1000.
const RIDGE: f64 = 1e-6;

/// Belts and motors that ring as measured.
struct Ringing<'m> {
    machine: Machine,
    params: &'m Params,
    rung: &'m [Rung],
    weights: DMatrix<f64>,
}

impl Problem for Ringing<'_> {
    fn excess(&self, logs: &DVector<f64>) -> Result<DVector<f64>, NotHeld> {
        let compared = compared(self.machine, &with(self.params, logs), self.rung)?;
        Ok(DVector::from_iterator(compared.len(), compared.iter().map(|one| one.log() / UNCERTAINTY)))
    }

    fn slopes(&self, logs: &DVector<f64>) -> Result<DMatrix<f64>, NotHeld> {
        let slope = |number: usize| {
            let probed = |by: f64| {
                let mut logs = logs.clone();
                logs[number] += by;
                self.excess(&logs)
            };
            Ok((probed(PROBE)? - probed(-PROBE)?) / (2.0 * PROBE))
        };
        Ok(DMatrix::from_columns(&[slope(0)?, slope(1)?]))
    }

    fn weights(&self) -> &DMatrix<f64> {
        &self.weights
    }
}

/// Belts and motors of a machine with these frequencies.
///
/// # Errors
/// Nothing holds the machine, or none has these frequencies.
pub fn identify(machine: Machine, params: &Params, rung: &[Rung]) -> Result<Identified, IdentifyError> {
    let ringing = Ringing { machine, params, rung, weights: DMatrix::identity(2, 2) * RIDGE };
    let logs = match nearest_minimum(&ringing, ringing.point(DVector::zeros(2))?) {
        Ok((found, _)) => found.logs,
        Err(NoMinimum::NotHeld(error)) => return Err(error.into()),
        // Such as motors that are as good as rigid. The differences tell whether the machine fits.
        Err(NoMinimum::OutOfReach(logs) | NoMinimum::NotConverged(logs)) => logs,
    };
    let logs = logs.map(|log| log.clamp(-FURTHEST, FURTHEST));
    let found = with(params, &logs);
    let left = compared(machine, &found, rung)?;
    let worst = left.into_iter().max_by(|a, b| a.log().abs().total_cmp(&b.log().abs()));
    let worst_difference = worst.map_or(0.0, |worst| worst.log().abs());
    match worst {
        Some(worst) if worst_difference > LIKE => Err(IdentifyError::Unlike(worst)),
        _ if logs[0].abs() > NO_BELT => Err(IdentifyError::NoBelt(found.belt_ea_n.of(0))),
        _ => Ok(Identified {
            belt_ea_n: found.belt_ea_n.of(0),
            holding_torque_nm: found.holding_torque_nm,
            worst_difference,
        }),
    }
}

fn with(params: &Params, logs: &DVector<f64>) -> Params {
    Params {
        belt_ea_n: params.belt_ea_n.times(exp(logs[0])),
        holding_torque_nm: params.holding_torque_nm * exp(logs[1]),
        ..params.clone()
    }
}

impl Unlike {
    /// Relative excess of the model's frequency, as a logarithm.
    fn log(&self) -> f64 {
        ln(self.says_hz / self.measured_hz)
    }
}

/// Each measured frequency with the model's.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn measure(params: &Params) -> Vec<Rung> {
        let places = [(235.0, 235.0), (60.0, 50.0)];
        let freedom = Freedom { idlers: true, rotors: true, ..Freedom::default() };
        let ring = |(x, y)| {
            let at = Place::flat(x, y);
            let modes = modes(&Elastic::new(Machine::CoreHBot, params, at, freedom)).unwrap();
            Rung { at, frequencies_hz: [Some(modes[1].frequency_hz), Some(modes[0].frequency_hz)] }
        };
        places.map(ring).to_vec()
    }

    #[test]
    fn belts_and_motors_are_found_again_from_two_places() {
        let true_params = Params { belt_ea_n: 41_000.0.into(), holding_torque_nm: 0.27, ..Params::default() };
        let found = identify(Machine::CoreHBot, &Params::default(), &measure(&true_params)).unwrap();
        assert!((found.belt_ea_n / 41_000.0 - 1.0).abs() < 1e-5, "{found:?}");
        assert!((found.holding_torque_nm / 0.27 - 1.0).abs() < 1e-5, "{found:?}");
        assert!(found.worst_difference < 1e-7, "{found:?}");
    }

    /// Half a percent of error in every frequency, with opposite signs.
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

    /// Harmonics, swapped axes, another machine: the result would be off by 217 %, 56 % and so on.
    #[test]
    fn frequencies_of_no_machine_are_refused() {
        let found = |rung: &[[f64; 4]]| {
            let rung: Vec<Rung> = rung
                .iter()
                .map(|[x, y, fx, fy]| Rung { at: Place::flat(*x, *y), frequencies_hz: [Some(*fx), Some(*fy)] })
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
