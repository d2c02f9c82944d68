//! State: positions, speeds and commanded motor positions.
//!
//! Motor steps are exact: time is cut at each. In between, the classical fourth-order Runge-Kutta method uses steps of
//! at most 36 us, 8 us with idlers, and 100 us in a [live](crate::stepped_machine) machine. Steps are shorter where a
//! short segment is stiff.

use super::external_forces::Outside;
use super::plant::Plant;

/// A machine in motion.
#[derive(Clone, Debug)]
pub struct State {
    /// Changes of all coordinates since the start, in mm.
    pub at: Vec<f64>,
    /// Speeds of the moving ones, in mm/s.
    pub speeds: Vec<f64>,
    /// Commanded position of each motor, in mm of belt since the start.
    pub sent_mm: Vec<f64>,
    /// Outside actions.
    pub outside: Outside,
    /// Factor by which integration steps are shorter than the plant's.
    pub refinement: f64,
    scratch: Scratch,
}

/// Positions, speeds and accelerations of the four stages, kept to avoid allocation.
#[derive(Clone, Debug, Default)]
struct Scratch {
    at: Vec<f64>,
    speeds: Vec<f64>,
    slope: Vec<f64>,
    sum_speeds: Vec<f64>,
    sum_slopes: Vec<f64>,
}

impl State {
    /// Everything at rest.
    #[must_use]
    pub fn at_rest(plant: &Plant) -> Self {
        let (count, moving) = (plant.count(), plant.moving());
        let zeros = || vec![0.0; moving];
        let scratch =
            Scratch { at: vec![0.0; count], speeds: zeros(), slope: zeros(), sum_speeds: zeros(), sum_slopes: zeros() };
        let sent_mm = vec![0.0; plant.ways.motors.len()];
        let outside = Outside::default();
        Self { at: vec![0.0; count], speeds: zeros(), sent_mm, outside, refinement: 1.0, scratch }
    }

    /// Moves a motor (by its index) at once to this much belt from the start. Returns whether it was elsewhere.
    pub fn step(&mut self, plant: &Plant, motor: usize, to_mm: f64) -> bool {
        let Some(sent) = self.sent_mm.get_mut(motor).filter(|sent| **sent != to_mm) else { return false };
        let way = to_mm - *sent;
        *sent = to_mm;
        if !plant.are_rotors() {
            let coordinate = plant.first_motor() + motor;
            if let Some(at) = self.at.get_mut(coordinate) {
                *at = to_mm;
            }
            plant.strike(coordinate, way, &self.at, &mut self.speeds);
        }
        true
    }

    /// Advances by a time without steps.
    pub fn advance(&mut self, plant: &Plant, seconds: f64) {
        if seconds <= 0.0 {
            return;
        }
        let steps = (seconds * self.refinement / plant.longest_step_s()).ceil().max(1.0);
        let step = seconds / steps;
        for _ in 0..steps as u64 {
            self.runge_kutta(plant, step);
        }
    }

    /// Whether all positions are finite numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.at.iter().all(|at| at.is_finite())
    }

    /// Accelerations now, in mm/s^2.
    pub fn accelerations(&mut self, plant: &Plant) -> &[f64] {
        plant.accelerate(&self.at, &self.speeds, &self.sent_mm, &self.outside, &mut self.scratch.slope);
        &self.scratch.slope
    }

    fn runge_kutta(&mut self, plant: &Plant, h: f64) {
        let Self { at, speeds, sent_mm, outside, scratch: s, .. } = self;
        s.at.copy_from_slice(at);
        s.speeds.copy_from_slice(speeds);
        s.sum_speeds.fill(0.0);
        s.sum_slopes.fill(0.0);
        for (weight, ahead) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
            plant.accelerate(&s.at, &s.speeds, sent_mm, outside, &mut s.slope);
            for (sum, v) in s.sum_speeds.iter_mut().zip(&s.speeds) {
                *sum += weight * v;
            }
            for (sum, a) in s.sum_slopes.iter_mut().zip(&s.slope) {
                *sum += weight * a;
            }
            if ahead == 0.0 {
                break;
            }
            // The next stage starts from here by this stage's slopes.
            for (stage, (q, v)) in s.at.iter_mut().zip(at.iter().zip(&s.speeds)) {
                *stage = q + ahead * h * v;
            }
            for (stage, (v, a)) in s.speeds.iter_mut().zip(speeds.iter().zip(&s.slope)) {
                *stage = v + ahead * h * a;
            }
        }
        for (q, sum) in at.iter_mut().zip(&s.sum_speeds) {
            *q += h / 6.0 * sum;
        }
        for (v, sum) in speeds.iter_mut().zip(&s.sum_slopes) {
            *v += h / 6.0 * sum;
        }
    }
}
