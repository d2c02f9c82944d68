//! Octaves: a plucked belt that was heard at twice or half its pitch.
//!
//! Where one pluck alone tells a tension, no other measurement contradicts it. So the pitch is compared with the other
//! plucks of its belt and, if there are fewer than two, with the tension that the machine has so far.

use corehbot_twin::calibration::{Figure, Measurement, span_tension_n};
use corehbot_twin::params::Params;

/// Four times the tension sounds an octave higher. Tensions within this band about it count as an octave off.
const FOURFOLD: [f64; 2] = [3.2, 5.0];

/// Each measurement's octave, if it is a pluck that seems to be one off.
pub(super) fn octaves(measurements: &[Measurement], was: &Params) -> Vec<Option<&'static str>> {
    let tension = |measurement: &Measurement| match measurement.figure {
        Figure::Pluck { length_mm, belt } => {
            Some((belt, span_tension_n(length_mm, was.belt_kg_per_m.of(belt), measurement.measured)))
        }
        _ => None,
    };
    let all: Vec<_> = measurements.iter().map(tension).collect();
    let octave = |(place, told): (usize, &Option<(usize, f64)>)| {
        let (belt, own) = (*told)?;
        let others = all.iter().enumerate().filter(|(other, _)| *other != place).filter_map(|(_, told)| *told);
        let mut others: Vec<f64> = others.filter(|(of, _)| *of == belt).map(|(_, tension)| tension).collect();
        if others.len() < 2 {
            others.push(was.preload_n.of(belt));
        }
        let is_most =
            |is_off: fn(f64) -> bool| 2 * others.iter().filter(|other| is_off(own / **other)).count() > others.len();
        if is_most(|ratio| (FOURFOLD[0]..=FOURFOLD[1]).contains(&ratio)) {
            Some("an octave high: is it a harmonic?")
        } else if is_most(|ratio| (FOURFOLD[0]..=FOURFOLD[1]).contains(&(1.0 / ratio))) {
            Some("an octave low: was half of the pitch read?")
        } else {
            None
        }
    };
    all.iter().enumerate().map(octave).collect()
}
