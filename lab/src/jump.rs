//! Jump: motors that run at a speed at once, as at the end of a corner, and the tool that rings about its way.

use corehbot_twin::dynamics::plant::{Detail, Plant};
use corehbot_twin::dynamics::state::State;
use corehbot_twin::geometry::{Workspace, workspace};
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::params::Params;
use corehbot_twin::queries::shown;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::RunError;
use corehbot_twin::solve::modes::modes;
use serde::Serialize;

/// Time between two looks, in s. Motors go on as often, so the command is smooth.
const LOOK_S: f64 = 20e-6;

/// Periods of the slowest mode that are watched: on the way the machine changes by a few thousandths.
const PERIODS: f64 = 8.0;

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// The machine.
    pub machine: &'static str,
    /// The jump of speed to the right and away from the front.
    pub speed_mm_s: [f64; 2],
    /// Ringing to the right.
    pub x: Ringing,
    /// Ringing away from the front.
    pub y: Ringing,
}

/// The tool about its commanded place along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Ringing {
    /// Lag at constant speed: the place that the tool rings about, relative to the commanded one. Friction holds it
    /// back.
    pub rest_um: f64,
    /// Largest distance from that place.
    pub amplitude_um: f64,
    /// Frequency, from its passes through that place; none without two of them.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: Option<f64>,
}

impl Jump {
    /// A machine with its tool at rest at a place.
    ///
    /// # Errors
    /// The tool would leave its reach, or numbers diverge.
    pub fn new(
        machine: Machine,
        params: &Params,
        start: Place,
        detail: Detail,
        speed_mm_s: [f64; 2],
    ) -> Result<Self, RunError> {
        let mut plant = Plant::new(machine, params, start, detail);
        let mut state = State::at_rest(&plant);
        let freedom = Freedom { rotors: detail.rotors, ..Freedom::default() };
        let slowest = modes(&Elastic::new(machine, params, start, freedom)).unwrap_or_default();
        let duration = PERIODS / slowest.first().map_or(1.0, |mode| mode.frequency_hz.max(1.0));
        let [vx, vy] = speed_mm_s;
        let range = |at: f64, way: f64| [at.min(at + way), at.max(at + way)];
        let path = Workspace { x: range(start.x, vx * duration), y: range(start.y, vy * duration), z: [start.z; 2] };
        let reach = workspace(machine, params);
        if !reach.bears(&path) {
            return Err(RunError::OutOfReach { path, reach });
        }
        let rows = plant.ways.rows.clone();
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for look in 1..=(duration / LOOK_S) as u32 {
            let way = speed_mm_s.map(|v| v * f64::from(look) * LOOK_S);
            // Motors rest at the mean of their way to the next look.
            let [x_sent, y_sent] = [0, 1].map(|axis| way[axis] - speed_mm_s[axis] * LOOK_S / 2.0);
            for (motor, row) in rows.iter().enumerate() {
                state.step(&plant, motor, row[0] * x_sent + row[1] * y_sent);
            }
            plant.send(&state.sent_mm);
            state.advance(&plant, LOOK_S);
            let at = |axis: usize| state.at.get(axis).copied().unwrap_or(0.0);
            x.push(at(0) - way[0]);
            y.push(at(1) - way[1]);
        }
        if !state.is_finite() {
            return Err(RunError::Diverged(duration));
        }
        Ok(Self { machine: machine.key(), speed_mm_s, x: ringing(&x), y: ringing(&y) })
    }
}

/// Ringing of a row of errors in mm.
fn ringing(errors: &[f64]) -> Ringing {
    let rest = settled(errors);
    let off = errors.iter().map(|error| error - rest);
    let amplitude = off.clone().fold(0.0, |most: f64, off| most.max(off.abs()));
    // Far below a step there is nothing but rounding.
    if amplitude < 1e-6 {
        return Ringing { rest_um: 1000.0 * rest, amplitude_um: 1000.0 * amplitude, frequency_hz: None };
    }
    let passes = rising(errors, rest);
    let frequency_hz = match (passes.first(), passes.last()) {
        (Some(first), Some(last)) if passes.len() > 1 => Some((passes.len() - 1) as f64 / ((last - first) * LOOK_S)),
        _ => None,
    };
    Ringing { rest_um: 1000.0 * rest, amplitude_um: 1000.0 * amplitude, frequency_hz }
}

/// The places in a row at which it rises through a value.
fn rising(errors: &[f64], value: f64) -> Vec<f64> {
    let pairs = errors.windows(2).enumerate();
    let pass = |(index, pair): (usize, &[f64])| match pair {
        [a, b] if *a < value && *b >= value => Some(index as f64 + (value - a) / (b - a)),
        _ => None,
    };
    pairs.filter_map(pass).collect()
}

/// The value about which a row rings and settles. Three extremes in a row of a decaying sine are r + A, r - q A and
/// r + q^2 A, and so give r (Aitken).
fn settled(errors: &[f64]) -> f64 {
    let half = errors.get(errors.len() / 2..).unwrap_or_default();
    let rough = half.iter().sum::<f64>() / half.len().max(1) as f64;
    let sides = half.chunk_by(|a, b| (*a < rough) == (*b < rough));
    let far = |side: &[f64]| side.iter().copied().max_by(|a, b| (a - rough).abs().total_cmp(&(b - rough).abs()));
    let extremes: Vec<f64> = sides.skip(1).filter_map(far).collect();
    // The last side may not be whole.
    let whole = extremes.get(..extremes.len().saturating_sub(1)).unwrap_or_default();
    let of = |three: &[f64]| match three {
        [a, b, c] => Some((a * c - b * b) / (a + c - 2.0 * b)),
        _ => None,
    };
    let found: Vec<f64> = whole.windows(3).filter_map(of).filter(|rest| rest.is_finite()).collect();
    if found.is_empty() { rough } else { found.iter().sum::<f64>() / found.len() as f64 }
}

impl std::fmt::Display for Jump {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [vx, vy] = self.speed_mm_s;
        writeln!(f, "{}, from rest to ({vx}, {vy}) mm/s at once", Machine::name_of(self.machine))?;
        for (axis, ringing) in [("x", self.x), ("y", self.y)] {
            let Ringing { rest_um, amplitude_um, frequency_hz } = ringing;
            write!(f, "  {axis}  rings by {:>8} um", shown(amplitude_um, 2))?;
            if let Some(hz) = frequency_hz {
                write!(f, " at {hz:.2} Hz")?;
            }
            writeln!(f, ", about {} um from the commanded place, its lag at constant speed", shown(rest_um, 2))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_about_a_place_is_found() {
        let ring = |decay: f64| {
            let time = |i: u32| f64::from(i) * LOOK_S;
            let at = |t: f64| 0.01 + 0.2 * (-decay * t).exp() * (std::f64::consts::TAU * 60.0 * t).sin();
            ringing(&(1..6000).map(|i| at(time(i))).collect::<Vec<_>>())
        };
        let damped = ring(15.0);
        assert!((damped.rest_um - 10.0).abs() < 0.01 && damped.amplitude_um > 180.0, "{damped:?}");
        let found = ring(0.0);
        assert!((found.rest_um - 10.0).abs() < 0.01 && (found.amplitude_um - 200.0).abs() < 0.4, "{found:?}");
        assert!((found.frequency_hz.unwrap_or(0.0) - 60.0).abs() < 0.01, "{found:?}");
        assert_eq!(ringing(&[0.0; 100]).frequency_hz, None);
    }
}
