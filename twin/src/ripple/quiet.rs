//! Quiet: speeds with less vibration than others, and speeds to avoid.

/// A speed is quiet if its vibration is at most this part of the median, and loud from the other part on.
const QUIET: f64 = 0.75;
const LOUD: f64 = 1.5;

/// Ranges of quiet speeds, and loud speeds, of speeds with the vibration of their loudest angle. Speeds ascend.
#[must_use]
pub fn quiet_and_loud(speeds: &[(f64, f64)]) -> (Vec<[f64; 2]>, Vec<f64>) {
    let mut order: Vec<f64> = speeds.iter().map(|(_, loudest)| *loudest).collect();
    order.sort_by(f64::total_cmp);
    let median = order.get(order.len() / 2).copied().unwrap_or(0.0);
    let mut quiet: Vec<[f64; 2]> = Vec::new();
    let mut is_open = false;
    for (speed, loudest) in speeds {
        let is_quiet = *loudest <= QUIET * median;
        match quiet.last_mut().filter(|_| is_open) {
            Some(range) if is_quiet => range[1] = *speed,
            _ if is_quiet => quiet.push([*speed; 2]),
            _ => {}
        }
        is_open = is_quiet;
    }
    let loud = speeds.iter().filter(|(_, loudest)| *loudest >= LOUD * median).map(|(speed, _)| *speed).collect();
    (quiet, loud)
}
