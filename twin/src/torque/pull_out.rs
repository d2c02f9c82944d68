//! Pull-out: the largest torque of a hybrid stepper motor at a speed.
//!
//! A phase is a voltage source behind resistance and inductance. With amplitudes as phasors, the real axis along the
//! back EMF E = k w, and p pole pairs,
//!
//! ```text
//! V = E + (R + j p w L) I,    torque = k Re I
//! ```
//!
//! The driver limits |I| to its set current and |V| to the supply. Both limits are discs in the plane of I, the second
//! about -E / (R + j p w L). The torque follows from the largest Re I in both. Where only the voltage limits it, this
//! is the pull-out torque of a hybrid motor by Acarnley (Stepping Motors, chapter on high-speed operation):
//!
//! ```text
//! k V / |Z| - k^2 w R / |Z|^2,    |Z|^2 = R^2 + (p w L)^2
//! ```
//!
//! The constant k follows from the holding torque. The sines of both phases add up to one amplitude, so T = k sqrt(2)
//! I(rms). Conservation of energy gives the same k in E. A saturated chopper gives more than V (a square wave has 4/pi
//! of it). Losses in switches and iron are neglected. So the curve has the right shape, accurate to about 20 %.

use crate::math::hypot;
use crate::params::Params;
use std::f64::consts::SQRT_2;

/// Pull-out torque of a motor in N m at a speed of its shaft in rad/s.
#[must_use]
pub fn pull_out_torque_nm(params: &Params, speed_rad_s: f64) -> f64 {
    let current = SQRT_2 * params.run_current_a;
    let constant = params.holding_torque_nm / current;
    let speed = speed_rad_s.abs();
    let (back_emf, resistance) = (constant * speed, params.phase_resistance_ohm);
    let reactance = params.pole_pairs * speed * params.phase_inductance_mh / 1000.0;
    let impedance_sq = resistance * resistance + reactance * reactance;
    let voltage = Disc {
        centre: [-back_emf * resistance / impedance_sq, back_emf * reactance / impedance_sq],
        // Motors in series share the supply.
        radius: params.supply_v / params.motors_in_series / impedance_sq.sqrt(),
    };
    (constant * greatest_real(current, &voltage)).max(0.0)
}

/// The same of a motor (by its place in the order of the motors' numbers) at a speed of its belt in mm/s.
#[must_use]
pub fn pull_out_torque_at_belt_nm(params: &Params, motor: usize, belt_mm_s: f64) -> f64 {
    pull_out_torque_nm(params, belt_mm_s / params.radius_mm(motor))
}

/// A disc in the plane of complex currents, in A.
struct Disc {
    centre: [f64; 2],
    radius: f64,
}

impl Disc {
    fn has(&self, [x, y]: [f64; 2]) -> bool {
        hypot(x - self.centre[0], y - self.centre[1]) <= self.radius
    }

    /// The point with the largest real part.
    fn rightmost(&self) -> [f64; 2] {
        [self.centre[0] + self.radius, self.centre[1]]
    }
}

/// Largest real part in a disc about 0 and another one; 0 where they do not meet.
fn greatest_real(radius: f64, other: &Disc) -> f64 {
    let own = Disc { centre: [0.0, 0.0], radius };
    if other.has(own.rightmost()) {
        return radius;
    }
    if own.has(other.rightmost()) {
        return other.rightmost()[0];
    }
    // Intersections of the two circles: at `along` from 0 towards the other's centre, and `across` at a right angle.
    let [x, y] = other.centre;
    let distance = hypot(x, y);
    let along = (distance * distance + radius * radius - other.radius * other.radius) / (2.0 * distance);
    let across_sq = radius * radius - along * along;
    if across_sq < 0.0 {
        return 0.0;
    }
    (along * x + across_sq.sqrt() * y.abs()) / distance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest and slowly the motor has its holding torque; at speed, the torque of Acarnley's formula.
    #[test]
    fn torque_is_that_of_the_current_at_first_and_of_the_voltage_at_last() {
        let p = Params::default();
        assert_eq!(pull_out_torque_nm(&p, 0.0), 0.4);
        assert_eq!(pull_out_torque_nm(&p, 10.0), 0.4);
        let k = 0.4 / (SQRT_2 * p.run_current_a);
        for speed in [100.0, 150.0, 300.0] {
            let (r, x) = (p.phase_resistance_ohm, p.pole_pairs * speed * p.phase_inductance_mh / 1000.0);
            let z = r.hypot(x);
            let acarnley = k * p.supply_v / z - k * k * speed * r / (z * z);
            assert!((pull_out_torque_nm(&p, speed) / acarnley - 1.0).abs() < 1e-12);
        }
    }

    /// Tries the definition: no current within the driver's limits gives more torque, and one gives as much.
    #[test]
    fn no_current_within_both_limits_has_more() {
        let p = Params::default();
        let (limit, k) = (SQRT_2 * p.run_current_a, p.holding_torque_nm / (SQRT_2 * p.run_current_a));
        for speed in [20.0, 40.0, 45.0, 50.0, 55.0, 60.0, 80.0, 200.0] {
            let reactance = p.pole_pairs * speed * p.phase_inductance_mh / 1000.0;
            let voltage = |re: f64, im: f64| {
                let (r, x) = (p.phase_resistance_ohm, reactance);
                (k * speed + r * re - x * im).hypot(r * im + x * re)
            };
            let mut best = 0.0_f64;
            for i in 0..=400 {
                for j in -400..=400 {
                    let (re, im) = (limit * f64::from(i) / 400.0, limit * f64::from(j) / 400.0);
                    if re.hypot(im) <= limit && voltage(re, im) <= p.supply_v {
                        best = best.max(k * re);
                    }
                }
            }
            let found = pull_out_torque_nm(&p, speed);
            assert!(found >= best - 1e-12 && found < best + 0.004, "{speed}: {found} {best}");
        }
    }

    #[test]
    fn torque_never_grows_with_speed() {
        let p = Params::default();
        let torques: Vec<f64> = (0..1000).map(|speed| pull_out_torque_nm(&p, f64::from(speed))).collect();
        assert!(torques.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!(torques[999] < 0.05 * torques[0]);
    }
}
