//! Limits: how hard the machine can be driven before a motor slips, a span goes slack, or the tool rings too much.
//!
//! The worst place of the reach counts. Torque is at standstill; [`super::torque`] has it at speed, by the same demand
//! of each motor. Where the frame is soft, its own mode is a part of the ringing.

use super::{Setup, shown};
use crate::geometry::{Workspace, greatest, workspace};
use crate::model::coordinate::Coordinate;
use crate::model::ways::Ways;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::NotHeld;
use crate::solve::balance::balance;
use crate::solve::modes::{Ringing, modes};
use crate::torque::demand::Demand;
use serde::Serialize;

/// Columns and rows of the grid in which the search for the worst places begins.
const GRID: usize = 7;

/// Limits of all axes that belts move.
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
    /// Along z, where belts lift the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<AxisLimits>,
    /// Error of the tool in y at the side of the reach, for 1 m/s^2 along y: the head's inertia yaws the bar. None
    /// where the bar does not move in y; infinite where its guides do not hold the yaw.
    pub yaw_error_um_per_m_s2: Option<f64>,
    /// Displacement of a soft frame for a lasting 1 m/s^2 along x and along y; none of a rigid one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_um_per_m_s2: Option<[f64; 2]>,
}

/// Limits of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AxisLimits {
    /// Acceleration with which a motor somewhere needs this part of its torque, rotors and friction included; 0 where
    /// friction alone takes it.
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

/// The worst of an axis over all places.
#[derive(Clone, Copy)]
struct Worst {
    /// Error in mm for a jump of speed of 1 mm/s.
    per_speed_s: f64,
    /// The same for a jump of acceleration of 1 mm/s^2.
    per_acceleration_s2: f64,
    /// Force in N that takes a span's whole preload.
    slack_n: f64,
}

impl Limits {
    /// For an allowed error by ringing and a usable part of the holding torque.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup, error_mm: f64, torque_part: f64) -> Result<Self, NotHeld> {
        let Setup { machine, params, .. } = setup;
        let reach = workspace(*machine, params);
        let worst = worst(setup, &reach)?;
        let ways = Ways::new(*machine, params);
        let masses_kg = machine.masses_kg(params);
        let demand = Demand::new(*machine, params)?;
        let limits = |axis: usize| {
            let row: Vec<f64> = ways.rows.iter().map(|row| row[axis]).collect();
            let along = [0, 1, 2].map(|other| if other == axis { 1.0 } else { 0.0 });
            AxisLimits {
                torque_acceleration_mm_s2: demand.acceleration_mm_s2(along, 0.0, 1.0 - torque_part).unwrap_or(0.0),
                slack_acceleration_mm_s2: worst[axis].slack_n / masses_kg[axis] * MM_PER_M,
                ringing_acceleration_mm_s2: error_mm / (2.0 * worst[axis].per_acceleration_s2),
                speed_jump_mm_s: error_mm / worst[axis].per_speed_s,
                slip_jump_mm_s: slip_jump_mm_s(&row, masses_kg[axis], params),
            }
        };
        let arm = (reach.x[1] - reach.x[0]) / 2.0;
        let yaw_stiffness = params.bar_yaw_stiffness_nm_per_rad * MM_PER_M;
        // 1 m/s^2 and 1 kg are 1 N.
        let yaw_error_um = MM_PER_M * params.head_mass_kg * arm * arm / yaw_stiffness;
        let frame = params.frame_stiffness_n_per_mm;
        Ok(Self {
            machine: machine.key(),
            error_mm,
            torque_part,
            x: limits(0),
            y: limits(1),
            z: machine.lifts().then(|| limits(2)),
            yaw_error_um_per_m_s2: machine.has_yawing_bar().then_some(yaw_error_um),
            frame_um_per_m_s2: frame.get(0).map(|_| [0, 1].map(|axis| MM_PER_M * masses_kg[axis] / frame.of(axis))),
        })
    }
}

/// The worst of each axis over the reach.
fn worst(setup: &Setup, reach: &Workspace) -> Result<[Worst; 3], NotHeld> {
    let axes = || Coordinate::TOOL.into_iter().take(setup.machine.axes());
    let at = |tool: Place| {
        let elastic = Setup { tool, ..setup.clone() }.elastic();
        let modes = modes(&elastic)?;
        let mut figures = [f64::NEG_INFINITY; 9];
        for (own, coordinate) in figures.chunks_mut(3).zip(axes()) {
            let ringing = Ringing::of(&modes, coordinate).ok_or(NotHeld)?;
            let push = Coordinate::TOOL.map(|axis| if axis == coordinate { 1.0 } else { 0.0 });
            let pulled = balance(&elastic, &setup.params, push, &[])?.tensions_n;
            let preloads = elastic.links.links.iter().zip(pulled);
            let slack_n = preloads.map(|(link, tension)| setup.params.preload_n.of(link.belt) / tension.abs());
            let softest_n = slack_n.fold(f64::INFINITY, f64::min);
            own.copy_from_slice(&[ringing.over_frequency(1), ringing.over_frequency(2), -softest_n]);
        }
        Ok(figures)
    };
    let [xs, xa, xn, ys, ya, yn, zs, za, zn] = greatest(reach, [GRID, GRID], at)?;
    let of =
        |[per_speed_s, per_acceleration_s2, slack_n]: [f64; 3]| Worst { per_speed_s, per_acceleration_s2, slack_n };
    Ok([of([xs, xa, -xn]), of([ys, ya, -yn]), of([zs, za, -zn])])
}

/// From the motor travel and the moving mass.
fn slip_jump_mm_s(row: &[f64], mass_kg: f64, params: &Params) -> f64 {
    let turning = || row.iter().enumerate().filter(|(_, way)| way.abs() > 0.5);
    let rotors: f64 = turning().map(|(motor, way)| way * way * params.rotor_mass_kg(motor)).sum();
    // From rest to the angle where a field lets go: twice its force times its electrical radian.
    let energy = |motor: usize| 2.0 * params.holding_force_n(motor) * params.electrical_radian_mm(motor);
    let energy_n_mm: f64 = turning().map(|(motor, _)| energy(motor)).sum();
    (2.0 * energy_n_mm * MM_PER_M / (mass_kg + rotors)).sqrt()
}

impl std::fmt::Display for Limits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = Machine::name_of(self.machine);
        let up = self.z.map_or(String::new(), |_| format!("{:>10}", "z"));
        writeln!(f, "{name}, worst place of the reach{:>20}{:>10}{up}", "x", "y")?;
        let mut row = |what: &str, figure: fn(&AxisLimits) -> f64| {
            let up = self.z.map_or(String::new(), |z| format!("{:>10}", shown(figure(&z), 0)));
            writeln!(f, "  {what:<46}{:>9}{:>10}{up}", shown(figure(&self.x), 0), shown(figure(&self.y), 0))
        };
        let (torque, um) = (100.0 * self.torque_part, 1000.0 * self.error_mm);
        row(&format!("acceleration with {torque:.0} % of the torque, mm/s2"), |a| a.torque_acceleration_mm_s2)?;
        row("acceleration that makes a span slack, mm/s2", |a| a.slack_acceleration_mm_s2)?;
        row(&format!("ramp that rings by {um:.0} um, mm/s2"), |a| a.ringing_acceleration_mm_s2)?;
        row(&format!("jump of speed that makes {um:.0} um, mm/s"), |a| a.speed_jump_mm_s)?;
        row("jump of speed at which motors slip, mm/s", |a| a.slip_jump_mm_s)?;
        match self.yaw_error_um_per_m_s2 {
            Some(um) if um.is_finite() => writeln!(f, "  yaw of the bar at the side: {um:.1} um for 1 m/s2 along y")?,
            Some(_) => writeln!(f, "  yaw of the bar: not held by its guides")?,
            None => {}
        }
        if let Some([x, y]) = self.frame_um_per_m_s2 {
            writeln!(
                f,
                "  the frame gives way by {x:.1} um for 1 m/s2 along x, {y:.1} along y; it rings in the rows above"
            )?;
        }
        Ok(())
    }
}
