//! Demand: motor torque needed by moves, and the resulting limits of speed and acceleration.
//!
//! In slow motion without ringing, the motors bear the inertia and friction of head and bar through the belt. The belt
//! shares them among the motors at that place, with compliant fields. Each motor also bears the inertia and friction of
//! its own rotor. A motor turns with the belt speed of its row; [`pull_out`](super::pull_out) gives its torque at that
//! speed.

use super::pull_out::pull_out_torque_at_belt_nm;
use crate::geometry::workspace;
use crate::math::{cos, sin};
use crate::model::elastic::{Elastic, Freedom};
use crate::model::ways::Ways;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::NotHeld;
use crate::solve::balance::balance;

/// mm in an m, mN m in an N m.
const MM_PER_M: f64 = 1000.0;

/// Columns and rows of the grid of places.
const GRID: usize = 5;

/// Highest belt speed in mm/s; GT2 on 20 teeth would turn at 7,500 rpm.
const FASTEST_MM_S: f64 = 5000.0;

/// Halvings of a bisection.
const HALVINGS: usize = 60;

/// Torque demand of moves on the motors of a machine, over its whole reach.
#[derive(Clone, Debug)]
pub struct Demand {
    params: Params,
    machine: Machine,
    ways: Ways,
    /// For each place and motor: its torque in N m per newton that the tool needs along x, y and z.
    shares: Vec<Vec<[f64; 3]>>,
}

/// A motor's torque in N m as the tool's acceleration times a slope, plus a constant.
struct Line {
    slope: f64,
    own: f64,
    available: f64,
}

impl Demand {
    /// Evaluates a grid of places over the reach, including its sides.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(machine: Machine, params: &Params) -> Result<Self, NotHeld> {
        let reach = workspace(machine, params);
        let freedom = Freedom { rotors: true, ..Freedom::default() };
        let share = |tool: Place| {
            let elastic = Elastic::new(machine, params, tool, freedom);
            // The force that accelerates the tool equals the force that holds it against the opposite one.
            let along = |axis: usize| [0, 1, 2].map(|other| if other == axis { -1.0 } else { 0.0 });
            let [x, y, z] = [0, 1, 2].map(|axis| balance(&elastic, params, along(axis), &[]));
            let all = x?.torques_mnm.into_iter().zip(y?.torques_mnm).zip(z?.torques_mnm);
            Ok(all.map(|((x, y), z)| [x, y, z].map(|torque| torque / MM_PER_M)).collect())
        };
        let shares = reach.grid(GRID, GRID).into_iter().map(share).collect::<Result<_, NotHeld>>()?;
        Ok(Self { params: params.clone(), machine, ways: Ways::new(machine, params), shares })
    }

    /// Every motor at every place, for a direction (of length 1) and a speed of the tool in mm/s.
    fn lines(&self, along: [f64; 3], speed_mm_s: f64) -> impl Iterator<Item = Line> {
        let p = &self.params;
        let (masses_kg, guides) = (self.machine.masses_kg(p), p.guides());
        let inertia = [0, 1, 2].map(|axis| masses_kg[axis] / MM_PER_M * along[axis]);
        // Friction acts like acceleration; at rest it also opposes the move.
        let sign = |d: f64| if d.abs() < 1e-9 { 0.0 } else { d.signum() };
        let rub = |(viscous, dry): (f64, f64), d: f64| viscous * d * speed_mm_s / MM_PER_M + dry * sign(d);
        let friction = [0, 1, 2].map(|axis| rub(guides[axis], along[axis]));
        let rotor = move |motor: usize, way: f64| {
            let radius_m = p.radius_mm(motor) / MM_PER_M;
            let inertia = p.rotor_inertia_kg_m2 * way / p.radius_mm(motor);
            let drag = p.rotor_damping_nm_s * way * speed_mm_s / MM_PER_M / radius_m;
            (inertia, drag, pull_out_torque_at_belt_nm(p, motor, way * speed_mm_s))
        };
        let rotors: Vec<_> = self.ways.rows.iter().enumerate().map(|(i, row)| rotor(i, dot(row, &along))).collect();
        self.shares.iter().flat_map(move |motors| {
            let line = move |(share, (inertia_nm, drag, available)): (&[f64; 3], &(f64, f64, f64))| {
                let of = |force: [f64; 3]| dot(share, &force);
                Line { slope: of(inertia) + inertia_nm, own: of(friction) + drag, available: *available }
            };
            motors.iter().zip(rotors.clone()).map(move |(share, rotor)| line((share, &rotor)))
        })
    }

    /// Smallest remaining part of its torque that a motor keeps anywhere, of 1; below 0 it slips.
    #[must_use]
    pub fn margin(&self, direction: [f64; 3], speed_mm_s: f64, acceleration_mm_s2: f64) -> f64 {
        let kept = |line: Line| 1.0 - (line.slope * acceleration_mm_s2 + line.own).abs() / line.available;
        self.lines(direction, speed_mm_s).map(kept).fold(1.0, f64::min)
    }

    /// Maximum acceleration in mm/s^2 at a speed with which every motor keeps this part of its torque, if there is one.
    #[must_use]
    pub fn acceleration_mm_s2(&self, direction: [f64; 3], speed_mm_s: f64, margin: f64) -> Option<f64> {
        let most = |line: Line| {
            let [slope, own] = if line.slope < 0.0 { [-line.slope, -line.own] } else { [line.slope, line.own] };
            ((1.0 - margin) * line.available - own) / slope.max(f64::MIN_POSITIVE)
        };
        let least = self.lines(direction, speed_mm_s).map(most).fold(f64::INFINITY, f64::min);
        (least > 0.0).then_some(least)
    }

    /// Maximum speed in mm/s at which every motor keeps this part of its torque with this acceleration, if there is
    /// one.
    #[must_use]
    pub fn speed_mm_s(&self, direction: [f64; 3], acceleration_mm_s2: f64, margin: f64) -> Option<f64> {
        if self.margin(direction, 0.0, acceleration_mm_s2) < margin {
            return None;
        }
        let [mut low, mut high] = [0.0, FASTEST_MM_S];
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if self.margin(direction, middle, acceleration_mm_s2) >= margin {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }

    /// The direction (of length 1) with the smallest remaining acceleration at this belt speed, and that acceleration;
    /// none if a direction has none left.
    #[must_use]
    pub fn worst(&self, belt_mm_s: f64, margin: f64) -> Option<([f64; 3], f64)> {
        let all = self.directions().into_iter().map(|direction| {
            self.acceleration_mm_s2(direction, belt_mm_s / self.belt_per_mm(direction), margin).map(|a| (direction, a))
        });
        let least = |worst: ([f64; 3], f64), one: ([f64; 3], f64)| if one.1 < worst.1 { one } else { worst };
        all.collect::<Option<Vec<_>>>()?.into_iter().reduce(least)
    }

    /// Directions all round, one of each two opposites: a degree apart, or five where belts lift the tool.
    fn directions(&self) -> Vec<[f64; 3]> {
        let (degrees, around, up) = if self.machine.lifts() { (5, 360, 90) } else { (1, 180, 0) };
        let turns = || (0..around).step_by(degrees).map(|angle| f64::from(angle).to_radians());
        let rises = (0..=up).step_by(degrees).map(|rise: i32| f64::from(rise).to_radians());
        rises
            .flat_map(|rise| turns().map(move |angle| [cos(angle) * cos(rise), sin(angle) * cos(rise), sin(rise)]))
            .collect()
    }

    /// Travel of the fastest belt per millimetre of the tool.
    #[must_use]
    pub fn belt_per_mm(&self, direction: [f64; 3]) -> f64 {
        self.ways.rows.iter().map(|row| dot(row, &direction).abs()).fold(0.0, f64::max)
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    fn demand() -> Demand {
        Demand::new(Machine::CoreHBot, &Params::default().undamped()).unwrap()
    }

    /// Torque of each motor in mN m at 10 m/s^2 in the middle of the reach.
    fn in_the_middle([x, y]: [f64; 2]) -> Vec<f64> {
        let demand = demand();
        let motors = demand.ways.motors.len();
        let middle = motors * (GRID * GRID / 2);
        let lines = demand.lines([x, y, 0.0], 0.0).skip(middle).take(motors);
        lines.map(|line| (1e4 * line.slope + line.own) * 1000.0).collect()
    }

    /// By r m a / 4 + J a / r an independent computation has 18.03 and 37.08 mN m.
    #[test]
    fn motors_bear_the_mass_that_moves_and_their_rotors() {
        for (direction, torque) in [([1.0, 0.0], 18.03), ([0.0, 1.0], 37.08)] {
            let found = in_the_middle(direction);
            assert!(found.iter().all(|nm| (nm.abs() / torque - 1.0).abs() < 1e-3), "{found:?}");
        }
    }

    /// On a diagonal one pair turns and bears both axes; the resting pair bears their difference.
    #[test]
    fn one_pair_alone_drives_a_diagonal() {
        let found = in_the_middle([FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
        let (r, root) = (6.35, FRAC_1_SQRT_2);
        let rotor = 1000.0 * 5.4e-6 * 1e4 * 2.0 * root / r;
        let turning = r * 10.0 * root * (0.6 + 1.8) / 4.0 + rotor;
        let standing = r * 10.0 * root * (1.8 - 0.6) / 4.0;
        for (motor, torque) in [turning, standing].into_iter().cycle().skip(1).take(4).enumerate() {
            assert!((found[motor].abs() / torque - 1.0).abs() < 1e-3, "{motor}: {found:?} {torque}");
        }
    }

    #[test]
    fn limits_leave_just_the_margin() {
        let demand = Demand::new(Machine::CoreHBot, &Params::default()).unwrap();
        for [x, y] in [[1.0, 0.0], [0.0, -1.0], [FRAC_1_SQRT_2, -FRAC_1_SQRT_2], [0.6, 0.8]] {
            let direction = [x, y, 0.0];
            for speed in [0.0, 150.0, 400.0] {
                let a = demand.acceleration_mm_s2(direction, speed, 0.5).unwrap();
                assert!((demand.margin(direction, speed, a) - 0.5).abs() < 1e-9);
            }
            let v = demand.speed_mm_s(direction, 20_000.0, 0.5).unwrap();
            assert!((demand.margin(direction, v, 20_000.0) - 0.5).abs() < 1e-6);
        }
        let (worst, a) = demand.worst(300.0, 0.5).unwrap();
        let speed = 300.0 / demand.belt_per_mm(worst);
        assert!((demand.margin(worst, speed, a) - 0.5).abs() < 1e-9);
        // With half the supply the same limits leave less.
        let series = Params { supply_v: 12.0, ..Params::default() };
        assert!(Demand::new(Machine::CoreHBot, &series).unwrap().worst(300.0, 0.5).unwrap().1 < 0.6 * a);
        // Where drag and friction take more than the margin leaves, there is no acceleration.
        assert_eq!(demand.worst(2000.0, 0.5), None);
        assert_eq!(demand.speed_mm_s([1.0, 0.0, 0.0], 1e6, 0.5), None);
    }
}
