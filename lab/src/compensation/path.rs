//! Path: the intended position of each motor, from the times of its steps.
//!
//! At the time of a step the intended position is half way between the two places. Between these times the path is
//! taken as straight. A resting motor is at its step. Motors that share a column of the trace count once.

use corehbot_twin::geometry::Workspace;
use corehbot_twin::model::ways::Ways;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::drive::{NoColumn, drives};
use corehbot_twin::steps::{StepTrace, TICKS_PER_SECOND};

/// Samples of the path per second: 45 a period of the faster axis, 17 of the slowest mode of the rotors.
pub const RATE: f64 = 5000.0;

/// A motor without a step for this time in s rests, and comes to rest or sets off within a part of it.
const REST_S: f64 = 0.02;

/// This part.
const SET_OFF: f64 = 0.25;

/// Intended position of a motor: time and steps.
pub(super) type Knot = (f64, f64);

/// The motors' paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Times in s and places in steps, motor by motor.
    pub(super) motors: Vec<Vec<Knot>>,
    /// The column of each motor and its sense.
    pub(super) columns: Vec<(usize, i8)>,
    /// Steps of the motors per millimetre of the tool.
    pub(super) rows: Vec<[f64; 2]>,
    /// Weights of the motors: a motor of finer steps counts for as much belt.
    weights: Vec<f64>,
    /// Its length in s.
    pub(super) duration_s: f64,
}

impl Path {
    /// From a trace.
    ///
    /// # Errors
    /// It is of another kind of machine.
    pub fn new(machine: Machine, params: &Params, trace: &StepTrace) -> Result<Self, NoColumn> {
        let ways = Ways::new(machine, params);
        let mut columns: Vec<(usize, i8)> = Vec::new();
        let (mut rows, mut weights) = (Vec::new(), Vec::new());
        for (drive, row) in drives(trace, &ways, params)?.iter().zip(&ways.rows) {
            if columns.iter().all(|(column, _)| *column != drive.column) {
                columns.push((drive.column, drive.sense));
                let finer = f64::from(drive.multiple) / drive.axis_step;
                rows.push([row[0], row[1]].map(|way| way * finer / trace.step_mm));
                weights.push(1.0 / (finer * finer));
            }
        }
        let mut motors = vec![vec![(0.0, 0.0)]; columns.len()];
        let mut before = vec![0_i64; columns.len()];
        for (tick, counts) in trace.counted() {
            let time = tick as f64 / TICKS_PER_SECOND;
            for (((column, sense), knots), before) in columns.iter().zip(&mut motors).zip(&mut before) {
                let now = counts.get(*column).copied().unwrap_or(0) * i64::from(*sense);
                if now != *before {
                    step(knots, time, *before as f64, now as f64);
                    *before = now;
                }
            }
        }
        let duration_s = trace.duration_s() + REST_S;
        for (knots, end) in motors.iter_mut().zip(&before) {
            knots.push((duration_s, *end as f64));
        }
        Ok(Self { motors, columns, rows, weights, duration_s })
    }

    /// The tool 5000 times a second, in mm from the start.
    #[must_use]
    pub fn tool(&self) -> Vec<[f64; 2]> {
        let count = (self.duration_s * RATE) as usize;
        let mut tool = vec![[0.0; 2]; count];
        // The columns of the rows are orthogonal: each coordinate is the sum over the motors divided by the square of
        // its column.
        let rows = || self.rows.iter().zip(&self.weights);
        let squares = [0, 1].map(|axis| rows().map(|(row, weight)| row[axis] * row[axis] * weight).sum::<f64>());
        for (knots, (row, weight)) in self.motors.iter().zip(rows()) {
            let mut at = Walk::new(knots);
            for (sample, place) in tool.iter_mut().enumerate() {
                let steps = at.at(sample as f64 / RATE);
                for ((value, way), square) in place.iter_mut().zip(row).zip(squares) {
                    *value += way * steps * weight / square;
                }
            }
        }
        tool
    }
}

/// The part of the reach that the tool uses if it begins at `start`.
pub(super) fn taken(tool: &[[f64; 2]], start: Place) -> Workspace {
    let mut taken = Workspace { x: [start.x; 2], y: [start.y; 2], z: [start.z; 2] };
    for [x, y] in tool {
        taken.x = [taken.x[0].min(start.x + x), taken.x[1].max(start.x + x)];
        taken.y = [taken.y[0].min(start.y + y), taken.y[1].max(start.y + y)];
    }
    taken
}

/// A motor steps.
fn step(knots: &mut Vec<Knot>, time: f64, before: f64, now: f64) {
    let last = knots.last().map_or(0.0, |(time, _)| *time);
    if time - last > REST_S {
        knots.push((last + SET_OFF * REST_S, before));
        knots.push((time - SET_OFF * REST_S, before));
    }
    knots.push((time, f64::midpoint(before, now)));
}

/// Samples of a step function that is 0 at first, from the times in s of its new values.
pub fn sampled(steps: impl IntoIterator<Item = (f64, f64)>, count: usize) -> Vec<f64> {
    let mut knots = vec![(0.0, 0.0)];
    let mut before = 0.0;
    for (time, now) in steps {
        if now != before {
            step(&mut knots, time, before, now);
            before = now;
        }
    }
    let end = count as f64 / RATE;
    let last = knots.last().map_or(0.0, |(time, _)| *time);
    knots.push((end.min(last + SET_OFF * REST_S), before));
    let mut at = Walk::new(&knots);
    (0..count).map(|sample| at.at(sample as f64 / RATE)).collect()
}

/// A walk along a motor's knots.
pub(super) struct Walk<'k> {
    knots: &'k [Knot],
    index: usize,
}

impl<'k> Walk<'k> {
    pub(super) const fn new(knots: &'k [Knot]) -> Self {
        Self { knots, index: 0 }
    }

    /// Its position at a time. Times must not decrease from call to call.
    pub(super) fn at(&mut self, time: f64) -> f64 {
        while self.knots.get(self.index + 1).is_some_and(|(end, _)| *end <= time) {
            self.index += 1;
        }
        match (self.knots.get(self.index), self.knots.get(self.index + 1)) {
            (Some((t0, a)), Some((t1, b))) if t1 > t0 => a + (b - a) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0),
            (Some((_, a)), _) => *a,
            (None, _) => 0.0,
        }
    }
}
