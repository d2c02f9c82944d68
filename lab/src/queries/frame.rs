//! Frame: the torque of all motors together, which the frame bears (\[H\], after equation 38), for a lasting 1 m/s2.
//!
//! A rigid belt gives the tool the work of the motors: the sum of tau_i dtheta_i is F . dp. On an H-bot and a CoreXY
//! both motors turn by dx / r for dx, and by dy / r in opposite directions for dy. So their sum is r F_x: 2 r dT with F
//! = 2 dT of an H-bot, 4 r dT with F = 4 dT of a CoreXY, as the paper has it. On a closed belt the sum is r (T_out -
//! T_in) over all motors. Each tension stands in it once with each sign. So it is 0 for every force, and not 4 r dT.
//!
//! Rotors need a torque of their own, which belts do not pass on.

use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::model::ways::Ways;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::solve::NotHeld;
use corehbot_twin::solve::balance::balance;
use serde::Serialize;

/// Torque in mN m of all motors together, counter-clockwise on their rotors, for 1 m/s2 along an axis. The frame bears
/// the opposite one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameTorque {
    /// What the belts take.
    #[serde(rename = "belts_mNm_per_m_s2")]
    pub belts_mnm: f64,
    /// What the rotors take.
    #[serde(rename = "rotors_mNm_per_m_s2")]
    pub rotors_mnm: f64,
    /// The belts' part as the paper prints it, without its direction: r times the force along x, none along y.
    #[serde(rename = "printed_mNm_per_m_s2")]
    pub printed_mnm: f64,
}

impl FrameTorque {
    /// Along x and along y, with the tool at a place.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(machine: Machine, params: &Params, tool: Place) -> Result<[Self; 2], NotHeld> {
        let elastic = Elastic::new(machine, params, tool, Freedom::default());
        let ways = Ways::new(machine, params);
        let masses_kg = machine.masses_kg(params);
        let axis = |axis: usize| {
            // The force that accelerates the tool is the one that holds it against the opposite one: 1 kg is 1 N.
            let against = [0, 1, 2].map(|other| if other == axis { -masses_kg[axis] } else { 0.0 });
            let belts_mnm = balance(&elastic, params, against, &[])?.torques_mnm.iter().sum();
            let rotor = |(motor, row): (usize, &[f64; 3])| row[axis] / params.radius_mm(motor);
            let turns: f64 = ways.rows.iter().enumerate().map(rotor).sum();
            // An inertia in kg m2 at 1 m/s2 over a radius in mm is 1000 N m.
            let rotors_mnm = params.rotor_inertia_kg_m2 * turns * 1e6;
            let printed_mnm = if axis == 0 { params.pulley_radius_mm * masses_kg[axis] } else { 0.0 };
            Ok(Self { belts_mnm, rotors_mnm, printed_mnm })
        };
        Ok([axis(0)?, axis(1)?])
    }
}
