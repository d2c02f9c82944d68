//! Phase: where the magnetic zero of a motor lies when it gets power.
//!
//! A rotor stands anywhere against its field at power-up, so the nearest place that the field has for it is up to two full
//! steps away, to either side. Any of them is as likely: nobody has turned the rotor with the field in mind.

use crate::params::Params;
use crate::sampling::random::Random;

/// Full steps to each side.
const MOST_FULL_STEPS: f64 = 2.0;

/// The stream of a seed from which phases are drawn.
const STREAM: u64 = 0x7068_6173; // "phas"

/// A phase in mm of belt for each of so many motors, within two full steps of 0; of one seed always the same.
#[must_use]
pub fn phases_mm(seed: u64, motors: usize, params: &Params) -> Vec<f64> {
    let mut random = Random::new(seed, STREAM);
    let most = MOST_FULL_STEPS * params.full_step_mm();
    (0..motors).map(|_| (2.0 * random.unit() - 1.0) * most).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_fill_four_full_steps_evenly() {
        let params = Params::default();
        let phases: Vec<f64> = (0..1000).flat_map(|seed| phases_mm(seed, 4, &params)).collect();
        let most = 2.0 * params.full_step_mm();
        assert!(phases.iter().all(|phase| phase.abs() <= most));
        let rms = (phases.iter().map(|phase| phase * phase).sum::<f64>() / phases.len() as f64).sqrt();
        // A rectangle's is its half width over the root of three: 0.2303 mm. 4,000 of them tell it to 1.5 % or so.
        assert!((rms / (most / 3.0_f64.sqrt()) - 1.0).abs() < 0.04, "{rms}");
        assert_eq!(phases_mm(7, 4, &params), phases_mm(7, 4, &params));
    }
}
