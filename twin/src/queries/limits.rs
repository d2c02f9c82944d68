//! Limits: how hard the machine can be driven before a motor slips, a span goes slack, or the tool rings too much.
//!
//! The worst place of the reach counts. Torque is at standstill; [`super::torque`] has it at speed.

use super::resonance::points;
use super::{Setup, shown};
use crate::geometry::workspace;
use crate::model::coordinate::Coordinate;
use crate::model::ways::Ways;
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use crate::solve::balance::balance;
use crate::solve::modes::{mode_of, modes};
use serde::Serialize;
use std::f64::consts::TAU;

/// Columns and rows of the grid of places.
const GRID: usize = 7;

/// Limits of both axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// The machine.
    pub machine: &'static str,
    /// Allowed error by ringing.
    pub error_mm: f64,
    /// Usable part of the holding torque, of 1.
    pub torque_part: f64,
    /// Along x.
    pub x: AxisLimits,
    /// Along y.
    pub y: AxisLimits,
    /// Error of the tool in y at the side of the reach, for 1 m/s^2 along y: the head's inertia yaws the bar.
    pub yaw_error_um_per_m_s2: f64,
}

/// Limits of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AxisLimits {
    /// Acceleration that takes this part of the motors' torque, rotors included.
    pub torque_acceleration_mm_s2: f64,
    /// Acceleration that takes a span's whole preload.
    pub slack_acceleration_mm_s2: f64,
    /// A ramp of this acceleration and any length rings by no more than the error.
    pub ringing_acceleration_mm_s2: f64,
    /// A speed jump of this size, as at a corner, makes the error.
    pub speed_jump_mm_s: f64,
    /// A speed jump of this size has more energy than all fields hold: the motors slip.
    pub slip_jump_mm_s: f64,
}

/// mm in an m: N over kg to mm/s^2.
const MM_PER_M: f64 = 1000.0;

impl Limits {
    /// For an allowed error by ringing and a usable part of the holding torque.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup, error_mm: f64, torque_part: f64) -> Result<Self, NotHeld> {
        let Setup { machine, params, .. } = setup;
        let reach = workspace(*machine, params);
        let (xs, ys) = (points(reach.x, GRID), points(reach.y, GRID));
        let mut slowest_hz = [f64::INFINITY; 2];
        let mut tension_n = [0.0_f64; 2];
        for tool in ys.iter().flat_map(|y| xs.iter().map(|x| reach.at(*x, *y))) {
            let elastic = Setup { tool, ..setup.clone() }.elastic();
            let modes = modes(&elastic)?;
            for (axis, coordinate) in [Coordinate::X, Coordinate::Y].into_iter().enumerate() {
                let hz = mode_of(&modes, coordinate).map_or(f64::INFINITY, |mode| mode.frequency_hz);
                let push = [0, 1].map(|i| if i == axis { 1.0 } else { 0.0 });
                let pulled = balance(&elastic, params, push, &[])?.tensions_n.into_iter().map(f64::abs);
                let most = pulled.fold(0.0, f64::max);
                if let (Some(slowest), Some(tension)) = (slowest_hz.get_mut(axis), tension_n.get_mut(axis)) {
                    *slowest = slowest.min(hz);
                    *tension = tension.max(most);
                }
            }
        }
        let ways = Ways::new(*machine, params);
        let mass = machine.masses_kg(params);
        let [x, y] = [0, 1].map(|i| {
            let row: Vec<f64> = ways.rows.iter().map(|row| row[i]).collect();
            axis(&row, mass[i], slowest_hz[i], tension_n[i], params, error_mm, torque_part)
        });
        let arm = (reach.x[1] - reach.x[0]) / 2.0;
        let stiffness = params.bar_yaw_stiffness_nm_per_rad * MM_PER_M;
        // 1 m/s^2 and 1 kg are 1 N.
        let yaw_error_um_per_m_s2 = MM_PER_M * params.head_mass_kg * arm * arm / stiffness;
        Ok(Self { machine: machine.key(), error_mm, torque_part, x, y, yaw_error_um_per_m_s2 })
    }
}

/// From the motor travel, the moving mass, the lowest frequency, and the tension per N.
fn axis(
    row: &[f64],
    mass_kg: f64,
    slowest_hz: f64,
    tension_n: f64,
    params: &Params,
    error_mm: f64,
    torque_part: f64,
) -> AxisLimits {
    let omega = TAU * slowest_hz;
    let pull: f64 = row.iter().map(|way| way.abs() * params.holding_force_n(0)).sum();
    let rotors: f64 = row.iter().map(|way| way * way * params.rotor_mass_kg(0)).sum();
    // From rest to the angle where a field lets go: twice its force times its electrical radian.
    let energy_n_mm = 2.0 * params.holding_force_n(0) * params.electrical_radian_mm(0) * row.len() as f64;
    let moving = mass_kg + rotors;
    AxisLimits {
        torque_acceleration_mm_s2: torque_part * pull / moving * MM_PER_M,
        slack_acceleration_mm_s2: params.preload_n.of(0) / (tension_n * mass_kg) * MM_PER_M,
        ringing_acceleration_mm_s2: error_mm * omega * omega / 2.0,
        speed_jump_mm_s: error_mm * omega,
        slip_jump_mm_s: (2.0 * energy_n_mm * MM_PER_M / moving).sqrt(),
    }
}

impl std::fmt::Display for Limits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = Machine::name_of(self.machine);
        writeln!(f, "{name}, worst place of the reach{:>20}{:>10}", "x", "y")?;
        let mut row = |what: &str, figure: fn(&AxisLimits) -> f64| {
            writeln!(f, "  {what:<46}{:>9}{:>10}", shown(figure(&self.x), 0), shown(figure(&self.y), 0))
        };
        let (torque, um) = (100.0 * self.torque_part, 1000.0 * self.error_mm);
        row(&format!("acceleration with {torque:.0} % of the torque, mm/s2"), |a| a.torque_acceleration_mm_s2)?;
        row("acceleration that makes a span slack, mm/s2", |a| a.slack_acceleration_mm_s2)?;
        row(&format!("ramp that rings by {um:.0} um, mm/s2"), |a| a.ringing_acceleration_mm_s2)?;
        row(&format!("jump of speed that makes {um:.0} um, mm/s"), |a| a.speed_jump_mm_s)?;
        row("jump of speed at which motors slip, mm/s", |a| a.slip_jump_mm_s)?;
        writeln!(f, "  yaw of the bar at the side: {:.1} um for 1 m/s2 along y", self.yaw_error_um_per_m_s2)
    }
}
