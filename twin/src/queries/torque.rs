//! Torque limits: acceleration and speed in each direction that leave the motors a part of their torque.
//!
//! On machines of the CoreXY kind, one pair of motors alone moves the tool along a diagonal, and its belt runs 1.41
//! times as fast as the tool. So the remaining torque depends on the direction. The firmware's limits know belt speeds
//! (`motor_max_speed`), but not that y weighs more than x, so its acceleration is the one of the worst direction.

use super::shown;
use crate::math::{asin, atan2};
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use crate::torque::demand::Demand;
use crate::torque::pull_out::pull_out_torque_at_belt_nm;
use serde::Serialize;
use std::f64::consts::FRAC_1_SQRT_2;

/// Directions and their names.
const DIRECTIONS: [(&str, [f64; 3]); 4] = [
    ("x", [1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("x+y", [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0]),
    ("x-y", [FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0]),
];

/// More of them where belts lift the tool.
const UP: [(&str, [f64; 3]); 4] = [
    ("z", [0.0, 0.0, 1.0]),
    ("x+z", [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]),
    ("y+z", [0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]),
    ("x+y+z", [0.577_350_269_189_625_8; 3]),
];

/// Speeds of the tool for which accelerations are given, in mm/s.
const SPEEDS: [f64; 6] = [0.0, 100.0, 200.0, 300.0, 400.0, 500.0];

/// Accelerations of the tool for which speeds are given, in mm/s^2.
const ACCELERATIONS: [f64; 6] = [1000.0, 3000.0, 5000.0, 10_000.0, 20_000.0, 40_000.0];

/// Settings are whole multiples of this acceleration in mm/s^2.
const WHOLE: f64 = 10.0;

/// Limits that leave a part of the torque.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TorqueLimits {
    /// Remaining part of the torque at each speed, of 1.
    pub margin: f64,
    /// Speeds of belt or tool.
    pub speeds_mm_s: Vec<f64>,
    /// Pull-out torque of a motor at these speeds of its belt.
    #[serde(rename = "pull_out_torque_mNm")]
    pub pull_out_torque_mnm: Vec<f64>,
    /// Accelerations of the tool.
    pub accelerations_mm_s2: Vec<f64>,
    /// Limits of each direction.
    pub directions: Vec<DirectionLimits>,
    /// Recommended settings; none if no acceleration keeps the margin at the belt speed.
    pub settings: Option<TorqueSettings>,
}

/// A direction of the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DirectionLimits {
    /// Its name.
    pub direction: &'static str,
    /// Maximum acceleration at each of the speeds; none where friction alone takes more.
    pub acceleration_mm_s2: Vec<Option<f64>>,
    /// Maximum speed at each of the accelerations; none where it takes too much at rest already.
    pub speed_mm_s: Vec<Option<f64>>,
}

/// Limits of the firmware that keep the margin in every direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TorqueSettings {
    /// Maximum speed of a belt, and of the tool along an axis.
    pub belt_speed_mm_s: f64,
    /// Maximum acceleration of the tool in any direction.
    pub acceleration_mm_s2: f64,
    /// The direction that limits it, from x towards y.
    pub worst_direction_deg: f64,
    /// Its rise above the plane of x and y; none where no belts lift the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_rise_deg: Option<f64>,
    /// The corresponding acceleration of a belt.
    pub belt_acceleration_mm_s2: f64,
}

impl TorqueLimits {
    /// For the part of its torque that every motor keeps anywhere in the reach, and the belt speed of the settings.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(machine: Machine, params: &Params, margin: f64, belt_speed_mm_s: f64) -> Result<Self, NotHeld> {
        let demand = Demand::new(machine, params)?;
        let known = || DIRECTIONS.into_iter().chain(UP.into_iter().filter(|_| machine.lifts()));
        let direction = |(name, along): (&'static str, [f64; 3])| DirectionLimits {
            direction: name,
            acceleration_mm_s2: SPEEDS.map(|speed| demand.acceleration_mm_s2(along, speed, margin)).to_vec(),
            speed_mm_s: ACCELERATIONS.map(|a| demand.speed_mm_s(along, a, margin)).to_vec(),
        };
        let directions = known().map(direction).collect();
        let diagonal = known().map(|(_, along)| demand.belt_per_mm(along)).fold(0.0, f64::max);
        let settings = demand.worst(belt_speed_mm_s, margin).and_then(|(worst, least)| {
            let acceleration_mm_s2 = (least / WHOLE).floor() * WHOLE;
            (acceleration_mm_s2 > 0.0).then(|| TorqueSettings {
                belt_speed_mm_s,
                acceleration_mm_s2,
                worst_direction_deg: atan2(worst[1], worst[0]).to_degrees(),
                worst_rise_deg: machine.lifts().then(|| asin(worst[2]).to_degrees()),
                belt_acceleration_mm_s2: (acceleration_mm_s2 * diagonal).ceil(),
            })
        });
        Ok(Self {
            margin,
            speeds_mm_s: SPEEDS.to_vec(),
            pull_out_torque_mnm: SPEEDS.map(|speed| 1000.0 * pull_out_torque_at_belt_nm(params, 0, speed)).to_vec(),
            accelerations_mm_s2: ACCELERATIONS.to_vec(),
            directions,
            settings,
        })
    }
}

impl std::fmt::Display for TorqueLimits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let row = |f: &mut std::fmt::Formatter<'_>, what: &str, figures: &[Option<f64>]| {
            let figure = |figure: &Option<f64>| figure.map_or_else(|| "-".to_owned(), |figure| shown(figure, 0));
            let figures: Vec<String> = figures.iter().map(|of| format!("{:>8}", figure(of))).collect();
            writeln!(f, "  {what:<46}{}", figures.concat())
        };
        let known = |figures: &[f64]| figures.iter().copied().map(Some).collect::<Vec<_>>();
        let left = shown(100.0 * self.margin, 0);
        writeln!(f, "Torque at speed, {left} % of it left, worst place of the reach")?;
        row(f, "speed, mm/s", &known(&self.speeds_mm_s))?;
        row(f, "torque of a motor at this belt speed, mN m", &known(&self.pull_out_torque_mnm))?;
        for limits in &self.directions {
            row(f, &format!("acceleration along {} at it, mm/s2", limits.direction), &limits.acceleration_mm_s2)?;
        }
        row(f, "acceleration, mm/s2", &known(&self.accelerations_mm_s2))?;
        for limits in &self.directions {
            row(f, &format!("highest speed along {} with it, mm/s", limits.direction), &limits.speed_mm_s)?;
        }
        let Some(settings) = self.settings else {
            return writeln!(f, "At the belt speed asked for, no acceleration leaves {left} % in every direction.");
        };
        let TorqueSettings { belt_speed_mm_s: v, acceleration_mm_s2: a, .. } = settings;
        let worst = shown(settings.worst_direction_deg, 0);
        let rise = settings.worst_rise_deg.map_or(String::new(), |rise| format!(", {} upward,", shown(rise, 0)));
        writeln!(f, "Settings that leave {left} % in every direction ({worst} degrees from x{rise} is the worst):")?;
        let all = |value: f64| {
            let up = if settings.worst_rise_deg.is_some() { format!(" Z{value}") } else { String::new() };
            format!("X{value} Y{value}{up}")
        };
        writeln!(f, "  M203 {}", all(v))?;
        writeln!(f, "  M201 {}", all(a))?;
        writeln!(f, "  M204 P{a} T{a}")?;
        writeln!(f, "and in a machine file, as no line sets them:")?;
        writeln!(f, "  motor_max_speed = {v}")?;
        writeln!(f, "  motor_max_acceleration = {}", settings.belt_acceleration_mm_s2)
    }
}
