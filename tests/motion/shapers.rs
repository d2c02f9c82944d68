//! Shapers: impulses and the remaining vibration, against figures from the literature.

use corehbot::motion::taps;
use corehbot::settings::{Shaper, ShaperKind, Shapers};
use corehbot::units::{Hertz, Ratio, Seconds};
use std::f64::consts::PI;

/// The impulses of a shaper: times, in s, and weights.
fn impulses(kind: ShaperKind, frequency: f64, damping: f64) -> Vec<(f64, f64)> {
    let shaper = |kind| Shaper::new(kind, Hertz::from_num(frequency), Ratio::from_num(damping));
    let [x, ..] = taps(&Shapers { x: shaper(kind), y: shaper(ShaperKind::None) }, None);
    let first = x[0].delay;
    x.iter().map(|tap| (f64::from(tap.delay - first) / 256.0 / 1e7, f64::from(tap.weight))).collect()
}

/// At 60 Hz and a damping of 0.05: weights, and times, in ms.
const KNOWN: [(ShaperKind, &[f64], &[f64]); 5] = [
    (ShaperKind::Zv, &[0.53924, 0.46076], &[0.0, 8.3438]),
    (ShaperKind::Zvd, &[0.29078, 0.49692, 0.21230], &[0.0, 8.3438, 16.6875]),
    (ShaperKind::Mzv, &[0.32822, 0.41253, 0.25925], &[0.0, 6.2578, 12.5157]),
    (ShaperKind::Ei, &[0.30688, 0.46746, 0.22566], &[0.0, 8.3788, 16.6875]),
    (ShaperKind::TwoHumpEi, &[0.20430, 0.35523, 0.30830, 0.13217], &[0.0, 8.4408, 16.7289, 24.9013]),
];

#[test]
fn impulses_are_those_of_the_literature() {
    let known: Vec<_> = KNOWN.iter().map(|(kind, ..)| *kind).collect();
    assert_eq!(known, ShaperKind::all().filter(|kind| *kind != ShaperKind::None).collect::<Vec<_>>());
    for (kind, amplitudes, times) in KNOWN {
        let impulses = impulses(kind, 60.0, 0.05);
        assert_eq!(impulses.len(), amplitudes.len());
        for ((time, amplitude), (known, ms)) in impulses.iter().zip(amplitudes.iter().zip(times)) {
            println!("{kind:?}: {amplitude:.6} {known} at {:.5} {ms}", time * 1e3);
            assert!((amplitude - known).abs() <= 1e-5, "{kind:?}: {amplitude} {known}");
            assert!((time * 1e3 - ms).abs() <= 1e-4, "{kind:?}: {} {ms}", time * 1e3);
        }
    }
}

/// The vibration that an oscillator has when the last impulse is over, relative to that which the whole command at once
/// would have begun.
fn residue(impulses: &[(f64, f64)], frequency: f64, damping: f64) -> f64 {
    let decay = 2.0 * PI * frequency * damping;
    let omega = 2.0 * PI * frequency * (1.0 - damping * damping).sqrt();
    let (end, _) = impulses[impulses.len() - 1];
    let sum = |part: fn(f64) -> f64| -> f64 {
        impulses.iter().map(|(t, weight)| weight * (decay * (t - end)).exp() * part(omega * t)).sum()
    };
    sum(f64::cos).hypot(sum(f64::sin))
}

/// Shapers made for 66 Hz on an axis that rings at 62.587 Hz with a damping of 0.03933. The figures belong to shapers
/// that know the damping.
#[test]
fn a_shaper_that_is_off_by_5_percent_leaves_as_much_as_is_known() {
    for (kind, known) in [(ShaperKind::Zv, 0.07643), (ShaperKind::Mzv, 0.04883), (ShaperKind::Ei, 0.04427)] {
        let left = residue(&impulses(kind, 66.0, 0.03933), 62.587, 0.03933);
        println!("{kind:?}: {left:.5} {known}");
        assert!((left / known - 1.0).abs() < 0.01, "{kind:?}: {left} {known}");
    }
}

#[test]
fn a_shaper_that_fits_leaves_nothing() {
    for kind in [ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Mzv] {
        let left = residue(&impulses(kind, 62.587, 0.03933), 62.587, 0.03933);
        // MZV is exact without damping alone.
        let most = if kind == ShaperKind::Mzv { 0.01 } else { 1e-4 };
        assert!(left < most, "{kind:?}: {left}");
    }
}

/// The trajectory begins at once after a rest, and is taken back at the time of the first tap.
#[test]
fn one_tap_of_all_has_no_delay() {
    for (x, y) in ShaperKind::all().flat_map(|x| ShaperKind::all().map(move |y| (x, y))) {
        for (frequency, damping) in [(57.0, 0.0), (10.0, 0.3), (120.0, 0.5)] {
            let shaper =
                |kind, factor| Shaper::new(kind, Hertz::from_num(factor * frequency), Ratio::from_num(damping));
            let shapers = Shapers { x: shaper(x, 1.0), y: shaper(y, 0.8) };
            for window in [None, Some(0.005), Some(0.04), Some(0.2)] {
                let taps = taps(&shapers, window.map(Seconds::from_num));
                assert!(taps.iter().flatten().any(|tap| tap.delay == 0), "{shapers:?} {window:?}");
            }
        }
    }
}
