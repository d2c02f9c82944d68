//! Calibrated: numbers of a machine found from measurements, as a file of parameters with comments on each.

use super::measured::Measured;
use anyhow::{Context as _, Result, anyhow};
use corehbot_twin::calibration::{CalibrateError, Calibrated as Found, Estimate, Misfit, Parameter, calibrate};
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::{Each, Params, ROWS};
use corehbot_twin::routing::Machine;
use serde::Serialize;
use std::path::Path;

/// The result of a calibration.
#[derive(Serialize)]
pub(super) struct Calibrated {
    estimates: Vec<Estimate>,
    /// Numbers that are hardly better known than before.
    not_told: Vec<Estimate>,
    /// Parameters that were not sought.
    fixed: Vec<Parameter>,
    measurements: Vec<Told>,
    /// All numbers of the machine.
    params: Params,
}

/// A measurement and the model.
#[derive(Serialize)]
struct Told {
    measurement: String,
    #[serde(flatten)]
    misfit: Misfit,
}

/// A measurement that is off by more uncertainties than this should be checked again.
const SUSPICIOUS: f64 = 3.0;

impl Calibrated {
    /// From a file of measurements.
    ///
    /// # Errors
    /// Errors in the file, quantities that the measurements do not determine, or measurements that contradict each
    /// other on every machine.
    pub(super) fn read(path: &Path, machine: Machine, params: &Params) -> Result<Self> {
        let Measured { measurements, fixed } = Measured::read(path, &workspace(machine, params))?;
        let (names, measurements): (Vec<_>, Vec<_>) = measurements.into_iter().unzip();
        let found = calibrate(machine, params, &measurements, &fixed);
        let found = found.map_err(|error| unlike(&names, error)).with_context(|| path.display().to_string())?;
        let Found { params, estimates, not_told, misfits } = found;
        let told = |(measurement, misfit)| Told { measurement, misfit };
        let measurements = names.into_iter().zip(misfits).map(told).collect();
        Ok(Self { estimates, not_told, fixed, measurements, params })
    }

    /// Keys that differ from the nominal machine, and were not found now.
    fn kept(&self) -> Vec<(&'static str, Each)> {
        let nominal = Params::default();
        let is_found = |key: &str| self.estimates.iter().chain(&self.not_told).any(|e| e.parameter.key() == key);
        let other = ROWS.iter().filter(|row| row.values(&self.params) != row.values(&nominal) && !is_found(row.key));
        other.map(|row| (row.key, row.values(&self.params))).collect()
    }
}

impl std::fmt::Display for Calibrated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "# For the machine file. Standard uncertainties follow from those of the measurements and of what is not told."
        )?;
        writeln!(f, "[twin]")?;
        for Estimate { parameter, value, uncertainty, .. } in &self.estimates {
            writeln!(f, "{} = {}  # +- {:.1} %", parameter.key(), digits(*value), 100.0 * uncertainty)?;
        }
        for (key, value) in self.kept() {
            writeln!(f, "{key} = {value}  # as it was")?;
        }
        for Estimate { parameter, value, uncertainty, assumed_uncertainty } in &self.not_told {
            let [now, before] = [uncertainty, assumed_uncertainty].map(|u| u.exp());
            let value = digits(*value);
            writeln!(
                f,
                "{} = {value}  # not told: good to a factor of {now:.2}, assumed {before:.2}",
                parameter.key()
            )?;
        }
        for parameter in &self.fixed {
            writeln!(f, "# Fixed: {} stays {}, taken as exact.", parameter.key(), parameter.of(&self.params))?;
        }
        for Told { measurement, misfit: Misfit { part, uncertainties } } in &self.measurements {
            let percent = 100.0 * part;
            write!(f, "# {measurement}: the model says {percent:+.1} %, {:.1} uncertainties", uncertainties.abs())?;
            writeln!(f, "{}", if uncertainties.abs() > SUSPICIOUS { "; look at it again" } else { "" })?;
        }
        Ok(())
    }
}

/// Why no machine fits; names the measurement that is furthest from the nearest machine.
fn unlike(names: &[String], error: CalibrateError) -> anyhow::Error {
    let CalibrateError::Unlike(misfits) = &error else { return error.into() };
    let all = names.iter().zip(misfits);
    let worst = all.max_by(|a, b| a.1.uncertainties.abs().total_cmp(&b.1.uncertainties.abs()));
    let Some((name, Misfit { part, uncertainties })) = worst else { return error.into() };
    let (percent, uncertainties) = (100.0 * part, uncertainties.abs());
    anyhow!(
        "no machine measures like this: of {name} the nearest one says {percent:+.0} %, {uncertainties:.0} \
        uncertainties; check its unit and measure it again; if it stays, check the others"
    )
}

/// Five digits, because measurements by hand are no more exact.
fn digits(value: f64) -> String {
    let before = value.abs().log10().floor() as i32 + 1;
    let behind = usize::try_from(5 - before).unwrap_or(0);
    format!("{value:.behind$}")
}
