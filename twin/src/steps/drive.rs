//! Drive: which column of a trace turns which motor of the twin.
//!
//! A motor takes the steps of a column with its own row over x, y and z, or with the opposite row. The opposite row
//! means a pair in series, or a motor mounted the other way up. The column's row may be a multiple: a motor with a
//! smaller pulley makes more steps for the same belt. Each column is taken once before any is taken twice. So a trace
//! of four drivers turns four motors, and so does one of two drivers, or of another machine with the same pairs.
//!
//! Pulleys of different sizes (\[H\] equation 8) are in the multiples as the firmware has them, and in the machine's
//! radii as they are. The first motor's pulley counts as the steps say, and every other one has its own share of it.

use super::StepTrace;
use crate::model::ways::Ways;
use crate::params::Params;

/// A motor's column and its sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Index of the column.
    pub column: usize,
    /// 1 or -1.
    pub sense: i8,
    /// Steps of this motor for a step of its axes.
    pub multiple: u8,
    /// Belt of a step of its axes, as a part of the trace's.
    pub axis_step: f64,
}

/// No column of the trace has this motor's row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoColumn {
    /// The motor.
    pub motor: u8,
    /// Its steps for a step of x, of y and of z.
    pub row: [i8; 3],
}

impl std::fmt::Display for NoColumn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self { motor, row: [x, y, 0] } => {
                write!(f, "the trace has no motor that turns ({x}, {y}) for x and y, as motor {motor} must")
            }
            Self { motor, row: [x, y, z] } => {
                write!(f, "the trace has no motor that turns ({x}, {y}, {z}) for x, y and z, as motor {motor} must")
            }
        }
    }
}

impl std::error::Error for NoColumn {}

/// The drives of all motors.
///
/// # Errors
/// A motor without a column in the trace.
pub fn drives(trace: &StepTrace, ways: &Ways, params: &Params) -> Result<Vec<Drive>, NoColumn> {
    let mut taken = vec![0_u32; trace.columns.len()];
    let mut drives = Vec::new();
    for (motor, row) in ways.motors.iter().zip(&ways.rows) {
        let row = row.map(|entry| entry.round() as i8);
        let sense = |column: [i8; 3]| {
            let multiple = multiple(column);
            match column.map(|entry| entry / multiple.max(1)) {
                same if same == row => Some((1, multiple)),
                other if other == row.map(|entry| -entry) => Some((-1, multiple)),
                _ => None,
            }
        };
        let fits = trace.columns.iter().enumerate().filter_map(|(i, c)| Some((i, sense(c.row)?)));
        let best = fits.min_by_key(|(i, (sense, _))| (taken.get(*i).copied(), -sense));
        let (column, (sense, multiple)) = best.ok_or(NoColumn { motor: *motor, row })?;
        let axis_step = trace.columns.get(column).map_or(1.0, |column| column.axis_step);
        if let Some(taken) = taken.get_mut(column) {
            *taken += 1;
        }
        drives.push(Drive { column, sense, multiple: multiple.unsigned_abs(), axis_step });
    }
    with_radii(&mut drives, params);
    Ok(drives)
}

/// A motor's step moves as much belt as its pulley is large, and the steps say 1 / multiple of it.
fn with_radii(drives: &mut [Drive], params: &Params) {
    if params.motor_radius_mm.values().is_empty() {
        return;
    }
    let belt = |(motor, drive): (usize, &Drive)| params.radius_mm(motor) * f64::from(drive.multiple);
    let belts: Vec<f64> = drives.iter().enumerate().map(belt).collect();
    let first = belts.first().copied().unwrap_or(1.0);
    for (drive, belt) in drives.iter_mut().zip(belts) {
        drive.axis_step *= belt / first;
    }
}

/// The number that all entries of a row are times -1, 0 or 1.
fn multiple(row: [i8; 3]) -> i8 {
    row.into_iter().map(i8::saturating_abs).max().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Each;
    use crate::routing::Machine;
    use crate::steps::Column;

    fn trace(rows: &[[i8; 2]]) -> StepTrace {
        let columns =
            rows.iter().map(|[x, y]| Column { name: String::new(), row: [*x, *y, 0], axis_step: 1.0 }).collect();
        StepTrace::new(columns, 0.0125)
    }

    #[test]
    fn motors_find_their_columns() {
        let four = trace(&[[-1, 1], [-1, -1], [1, -1], [1, 1]]);
        let found = |machine, trace: &StepTrace| {
            let params = Params::default();
            let drives = drives(trace, &Ways::new(machine, &params), &params).unwrap();
            drives.into_iter().map(|d| (d.column, d.sense)).collect::<Vec<_>>()
        };
        assert_eq!(found(Machine::CoreHBot, &four), [(0, 1), (1, 1), (2, 1), (3, 1)]);
        assert_eq!(found(Machine::CoreXy, &four), [(3, 1), (2, 1)]);
        // A pair in series: motors 1 and 4 turn backward.
        let two = trace(&[[1, 1], [1, -1]]);
        assert_eq!(found(Machine::CoreHBot, &two), [(1, -1), (0, -1), (1, 1), (0, 1)]);
        let cartesian = trace(&[[1, 0], [0, 1]]);
        let params = Params::default();
        let error = drives(&cartesian, &Ways::new(Machine::HBot, &params), &params).unwrap_err();
        assert_eq!(error, NoColumn { motor: 1, row: [1, 1, 0] });
    }
    /// Equation 8 of the paper: 20 teeth on one motor and 16 on the other are 4 and 5 steps for a step of the axes.
    #[test]
    fn motors_with_pulleys_of_two_sizes_make_multiple_steps() {
        let with =
            |params: &Params| drives(&trace(&[[4, 4], [5, -5]]), &Ways::new(Machine::CoreXy, params), params).unwrap();
        let found: Vec<_> = with(&Params::default()).into_iter().map(|d| (d.column, d.sense, d.multiple)).collect();
        assert_eq!(found, [(0, 1, 4), (1, 1, 5)]);
        // Radii that the steps agree with change nothing; a pulley of 20 teeth in the place of 16 pulls 5/4 of the
        // belt.
        let belts = |radii: &[f64]| {
            let params = Params { motor_radius_mm: Each::listed(radii).unwrap(), ..Params::default() };
            with(&params).into_iter().map(|d| d.axis_step).collect::<Vec<_>>()
        };
        assert!(belts(&[6.35, 5.08]).iter().all(|part| (part - 1.0).abs() < 1e-12));
        assert!(belts(&[6.35, 6.35]).iter().zip([1.0, 1.25]).all(|(part, expected)| (part - expected).abs() < 1e-12));
    }
}
