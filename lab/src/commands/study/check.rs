//! Check: the conditions for a study's file.

use super::error::StudyError;
use super::form::{AxisToml, MethodToml, QueryToml, RangeToml, StudyToml};
use super::plan::{MOST, NotVaried, varied};
use crate::sampling::latin::LatinHypercube;
use crate::sampling::{Axis, Design, levels};

/// Most columns or rows of a grid of places: some seconds a sample.
const MOST_PLACES: usize = 200;

/// Farthest place in mm from which G-code may begin, as on the command line.
const FARTHEST_MM: f64 = 5000.0;

type Checked<T> = Result<T, StudyError>;

/// The first problem besides the varied numbers, if any.
pub(super) fn check(study: &StudyToml) -> Checked<()> {
    let wrong = |key: &str, why: &str| Err(StudyError::value(key, why));
    let computes = |query| study.compute.contains(&query);
    if study.compute.is_empty() || has_twins(&study.compute) {
        return wrong("compute", "needs at least one question, each only once");
    }
    if study.machines.is_empty() || has_twins(&study.machines) {
        return wrong("machines", "needs at least one machine, each only once");
    }
    if computes(QueryToml::Push) != study.push.is_some() {
        return wrong("push", "`push` in compute and a force need each other");
    }
    if computes(QueryToml::Run) != study.run.is_some() {
        return wrong("run", "`run` in compute and a file need each other");
    }
    if study.at.is_some() && study.worst_of.is_some() {
        return wrong("worst_of", "use either this or `at`, not both");
    }
    let grids = [("worst_of", study.worst_of), ("resonance.grid", Some(study.resonance.grid))];
    for (key, grid) in grids {
        if grid.is_some_and(|grid| grid.iter().any(|n| !(2..=MOST_PLACES).contains(n))) {
            return wrong(key, &format!("2 to {MOST_PLACES} columns and rows are legal"));
        }
    }
    if !(study.limits.error_mm > 0.0 && study.limits.error_mm <= 10.0) {
        return wrong("limits.error_mm", "above 0 and up to 10 is legal");
    }
    if !(study.limits.torque > 0.0 && study.limits.torque <= 1.0) {
        return wrong("limits.torque", "above 0 and up to 1 is legal");
    }
    if study.at.is_some_and(|at| !at.iter().all(|v| v.is_finite())) {
        return wrong("at", "needs two numbers");
    }
    if study.push.as_ref().is_some_and(|push| !push.force_n.iter().all(|v| v.is_finite())) {
        return wrong("push.force_N", "needs two numbers");
    }
    if let Some(run) = &study.run {
        if run.begin.is_some_and(|begin| !begin.iter().all(|v| v.is_finite())) {
            return wrong(
                "run.begin",
                "needs two numbers: the tool's place in mm from motor 1's axis, which `twin run` calls --at",
            );
        }
        if run.assume_homed.is_some_and(|place| !place.iter().all(|v| v.abs() <= FARTHEST_MM)) {
            return wrong("run.assume_homed", &format!("up to {FARTHEST_MM} mm either way is legal"));
        }
    }
    study.twin.check().map_err(|error| StudyError::value(format!("twin.{}", error.key), error.to_string()))
}

fn has_twins<T: PartialEq>(items: &[T]) -> bool {
    items.iter().enumerate().any(|(i, item)| items.iter().take(i).any(|earlier| earlier == item))
}

/// The keys of the numbers that are varied, in the order of the file, and their values.
pub(super) fn design(study: &StudyToml) -> Checked<(Vec<String>, Design)> {
    let mut rows: Vec<_> = study.vary.iter().collect();
    rows.sort_by_key(|(key, _)| key.span().start);
    if rows.is_empty() {
        return Err(StudyError::value("vary", "needs at least one number"));
    }
    for (key, axis) in &rows {
        legal(study, key.get_ref(), key.span().start, axis)?;
    }
    let keys: Vec<String> = rows.iter().map(|(key, _)| key.get_ref().clone()).collect();
    let axes = keys.iter().zip(rows.iter().map(|(_, axis)| *axis));
    let design = match study.method {
        MethodToml::Grid => {
            for (key, is_there) in [("samples", study.samples.is_some()), ("seed", study.seed.is_some())] {
                if is_there {
                    return Err(StudyError::value(key, "only a latin-hypercube has it"));
                }
            }
            Design::Grid(axes.map(|(key, axis)| grid_axis(key, axis)).collect::<Checked<_>>()?)
        }
        MethodToml::LatinHypercube => {
            let Some(samples) = study.samples.filter(|samples| (1..=MOST).contains(samples)) else {
                return Err(StudyError::value("samples", format!("a latin-hypercube needs 1 to {MOST}")));
            };
            let axes = axes.map(|(key, axis)| latin_axis(key, axis)).collect::<Checked<Vec<_>>>()?;
            Design::LatinHypercube(LatinHypercube::new(&axes, samples, study.seed.unwrap_or_default()))
        }
    };
    Ok((keys, design))
}

/// The number of samples of a design on `machines` machines.
pub(super) fn samples(design: &Design, machines: usize) -> Checked<usize> {
    let samples = design.points().and_then(|points| points.checked_mul(machines));
    samples
        .filter(|samples| *samples <= MOST)
        .ok_or_else(|| StudyError::value("vary", format!("these are more than {MOST} samples")))
}

/// Whether a machine has the number, at all ends of its values; in between it has it too, for all limits are one-sided.
fn legal(study: &StudyToml, key: &str, at: usize, axis: &AxisToml) -> Checked<()> {
    let values = match axis {
        AxisToml::Levels(levels) if levels.is_empty() => {
            return Err(StudyError::value(format!("vary.{key}"), "needs at least one value"));
        }
        AxisToml::Levels(levels) => levels.clone(),
        AxisToml::Range(RangeToml { from, to, .. }) => vec![*from, *to],
    };
    for value in values {
        if !value.is_finite() {
            return Err(StudyError::value(format!("vary.{key}"), format!("{value} is not a number")));
        }
        varied(&study.twin, &[key.to_owned()], &[value]).map_err(|error| match error {
            NotVaried::Unknown { key, known } => StudyError::UnknownNumber { at, key, known },
            error => StudyError::value(format!("vary.{key}"), error.to_string()),
        })?;
    }
    Ok(())
}

fn grid_axis(key: &str, axis: &AxisToml) -> Checked<Vec<f64>> {
    match axis {
        AxisToml::Levels(levels) => Ok(levels.clone()),
        AxisToml::Range(RangeToml { from, to, count: Some(count) }) if (2..=MOST).contains(count) => {
            Ok(levels([*from, *to], *count))
        }
        AxisToml::Range(_) => {
            Err(StudyError::value(format!("vary.{key}"), format!("on a grid, a range needs a count of 2 to {MOST}")))
        }
    }
}

fn latin_axis(key: &str, axis: &AxisToml) -> Checked<Axis> {
    match axis {
        AxisToml::Levels(levels) => Ok(Axis::Levels(levels.clone())),
        AxisToml::Range(RangeToml { from, to, count: None }) => Ok(Axis::Span([*from, *to])),
        AxisToml::Range(_) => Err(StudyError::value(
            format!("vary.{key}"),
            "a latin-hypercube has its number in `samples`, not in a count",
        )),
    }
}
