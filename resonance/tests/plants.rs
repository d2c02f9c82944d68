//! Plants with known modes: found modes, Klipper's choice, and the ranking by what the tool does.

use crate::plant::{Mode, recording, through_text};
use corehbot_resonance::axis::{Axis, Named, Question, judge, measure};
use corehbot_resonance::label;
use corehbot_resonance::modes::{Modes, Unfitted, fit};
use corehbot_resonance::sweep::Sweep;
use corehbot_twin::shaping::shaper::residual;

const RATE: f64 = 3200.0;

fn found(modes: &[Mode], noise: f64, sweep: &Sweep) -> Modes {
    let found = fit(&recording(modes, sweep, RATE, noise, 7), Some(label::Axis::X), sweep);
    assert!(found.is_ok(), "{modes:?}: {found:?}");
    found.unwrap()
}

fn are(found: &Modes, known: &[Mode], hz: f64, damping: f64) {
    assert_eq!(found.modes.len(), known.len(), "{:?}", found.modes);
    for (f, z, part) in known {
        let near = found.modes.iter().min_by(|a, b| (a.frequency_hz - f).abs().total_cmp(&(b.frequency_hz - f).abs()));
        let near = near.unwrap();
        assert!((near.frequency_hz / f - 1.0).abs() < hz, "{near:?} for {f}");
        assert!((near.damping_ratio / z - 1.0).abs() < damping, "{near:?} for {z}");
        assert!((near.part - part).abs() < 0.05, "{near:?} for {part}");
    }
}

/// With a noise of 100 mm/s^2: frequency within 0.5 %, damping within 10 %.
#[test]
fn four_plants_are_found_again() {
    let sweep = Sweep::default();
    for known in
        [&[(48.6, 0.06, 1.0)][..], &[(81.0, 0.10, 1.0)], &[(33.0, 0.03, 1.0)], &[(42.0, 0.05, 0.7), (88.0, 0.08, 0.3)]]
    {
        are(&found(known, 100.0, &sweep), known, 0.005, 0.1);
    }
}

#[test]
fn a_weak_sweep_and_another_rate_are_enough() {
    let weak = Sweep { accel_per_hz: 34.0, swing_accel: 200.0, ..Sweep::default() };
    let known = [(48.6, 0.06, 1.0)];
    are(&found(&known, 300.0, &weak), &known, 0.005, 0.1);
    // A sweep of another amplitude, and a sensor of 1344 Hz, judged with the defaults.
    let slow = recording(&known, &weak, 1344.0, 100.0, 3);
    are(&fit(&slow, None, &Sweep::default()).unwrap(), &known, 0.005, 0.1);
}

/// A file in g under Klipper's header: the modes are the same, and the unit is remarked.
#[test]
fn another_unit_changes_no_mode() {
    let known = [(48.6, 0.06, 1.0)];
    let mut wrong = recording(&known, &Sweep::default(), RATE, 100.0, 7);
    let right = fit(&wrong, None, &Sweep::default()).unwrap().modes;
    wrong.axes.iter_mut().flatten().for_each(|value| *value /= 9806.65);
    let read = through_text(&wrong);
    assert!(read.remarks.len() == 1 && read.remarks[0].contains("in g and not in mm/s^2"), "{:?}", read.remarks);
    let found = fit(&wrong, None, &Sweep::default()).unwrap();
    are(&found, &known, 0.005, 0.1);
    assert!((found.modes[0].frequency_hz - right[0].frequency_hz).abs() < 1e-6, "{:?} {right:?}", found.modes);
}

#[test]
fn two_modes_within_twelve_hertz_are_both_found() {
    let known = [(50.0, 0.04, 0.6), (61.0, 0.05, 0.4)];
    are(&found(&known, 100.0, &Sweep::default()), &known, 0.01, 0.15);
}

#[test]
fn a_rigid_machine_has_no_mode() {
    let sweep = Sweep::default();
    let rigid = recording(&[(2000.0, 0.7, 1.0)], &sweep, RATE, 100.0, 5);
    assert_eq!(fit(&rigid, None, &sweep), Err(Unfitted::Flat));
    let measured = measure(Named { file: "raw_data_x.csv", recording: &rigid }, Some(label::Axis::X), &sweep).unwrap();
    let axis = judge(Some(label::Axis::X), vec![measured], &Question::default());
    assert!(axis.suggestion.is_none() && axis.tool.is_none(), "{:?}", axis.suggestion);
}

fn judged(modes: &[Mode], question: &Question) -> Axis {
    let recording = through_text(&recording(modes, &question.sweep, RATE, 100.0, 11));
    let measured =
        measure(Named { file: "raw_data_x.csv", recording: &recording }, Some(label::Axis::X), &question.sweep)
            .unwrap();
    judge(Some(label::Axis::X), vec![measured], question)
}

/// Shaper, frequency, suggested acceleration if it is known, as Klipper's own module gave them for such plants.
type Known = (&'static str, f64, Option<f64>);

/// Names equal, frequencies within 0.4 Hz, accelerations within 3 %.
#[test]
fn klippers_choice_is_klippers() {
    let plants: [(&[Mode], &[Known], &str); 3] = [
        (
            &[(48.6, 0.06, 1.0)],
            &[
                ("ZV", 48.8, Some(9281.0)),
                ("MZV", 50.2, Some(7424.0)),
                ("EI", 61.6, None),
                ("2HUMP_EI", 79.0, None),
                ("3HUMP_EI", 99.2, None),
            ],
            "MZV",
        ),
        (
            &[(81.0, 0.10, 1.0)],
            &[
                ("ZV", 81.4, None),
                ("MZV", 81.2, Some(19_424.0)),
                ("EI", 100.0, None),
                ("2HUMP_EI", 129.0, None),
                ("3HUMP_EI", 149.8, None),
            ],
            "MZV",
        ),
        (
            &[(42.0, 0.05, 0.7), (88.0, 0.08, 0.3)],
            &[
                ("ZV", 41.6, None),
                ("MZV", 44.4, Some(5807.0)),
                ("EI", 35.2, None),
                ("2HUMP_EI", 68.0, None),
                ("3HUMP_EI", 85.4, None),
            ],
            "MZV",
        ),
    ];
    for (modes, known, best) in plants {
        let choice = judged(modes, &Question::default()).klipper;
        assert_eq!(choice.suggestion.unwrap().shaper.name(), best);
        for (name, hz, acceleration) in known {
            let rated = choice.shapers.iter().find(|s| s.shaper.name() == *name).unwrap();
            assert!((rated.frequency_hz - hz).abs() <= 0.41, "{name} {} for {hz}", rated.frequency_hz);
            if let Some(known) = acceleration {
                let found = rated.suggested_acceleration_mm_s2;
                assert!((found / known - 1.0).abs() < 0.03, "{name} {found} for {known}");
            }
        }
    }
}

/// A mode at 62.6 Hz and 10 m/s^2. On walls of whole prints the twin of the belt machine says 4.3 um for ZV and 9.2 um
/// for MZV, RMS; 13 % off, 9.6 um and 11.7 um at the worst.
#[test]
fn the_tool_is_nearer_to_the_wall_with_the_shorter_shaper() {
    let mut question = Question { uncertainty: Some(0.0), ..Question::default() };
    question.print.acceleration_mm_s2 = 10_000.0;
    let axis = judged(&[(62.6, 0.05, 1.0)], &question);
    let tool = axis.tool.unwrap();
    assert_eq!(axis.klipper.suggestion.unwrap().shaper.name(), "MZV");
    assert_eq!(tool.nearest.rated.shaper.name(), "ZV", "{:?}", tool.nearest);
    let of = |name: &str| *tool.shapers.iter().find(|s| s.rated.shaper.name() == name).unwrap();
    assert!(
        of("ZV").worst_wall.rms_um < of("MZV").worst_wall.rms_um
            && of("MZV").worst_wall.rms_um < of("EI").worst_wall.rms_um
    );
    assert!(tool.unshaped_wall.rms_um > 3.0 * tool.nearest.wall.rms_um, "{:?}", tool.unshaped_wall);
    // Vibration that is left at the found frequency, against the one without a shaper.
    for s in &tool.shapers {
        let left = residual(&s.rated.shaper.impulses(s.rated.frequency_hz, s.damping_ratio), 62.6, 0.05);
        assert!(left <= 0.055, "{}: {left}", s.rated.shaper.name());
    }
    // It is told and not suggested: it leaves more of the measured vibration.
    let suggestion = axis.suggestion.unwrap();
    assert!(tool.nearest.rated.remaining_vibration > suggestion.rated.remaining_vibration, "{tool:?}");
    assert!(suggestion.why.contains("By the fitted modes ZV at"), "{}", suggestion.why);
    let line = suggestion.line.unwrap();
    assert!(line.starts_with("M593 X F6") && line.ends_with(" D0.100 T2"), "{line}");
    let ratio = of("ZV").wall.rms_um / of("MZV").wall.rms_um;
    assert!((ratio / (4.3 / 9.2) - 1.0).abs() < 0.15, "{ratio}");
    // The frequency 13 % off costs the shorter one more, and it is better all the same.
    let wide = judged(&[(62.6, 0.05, 1.0)], &Question { uncertainty: Some(0.13), ..question }).tool.unwrap();
    let of = |name: &str| wide.shapers.iter().find(|s| s.rated.shaper.name() == name).unwrap().worst_wall.rms_um;
    assert!((of("ZV") / of("MZV") / (9.6 / 11.7) - 1.0).abs() < 0.15, "{} {}", of("ZV"), of("MZV"));
    assert!(wide.nearest.rated.shaper.name() == "ZV" && wide.uncertainty == 0.13, "{:?}", wide.nearest);
    // Less knowledge is never better.
    let lost = judged(&[(62.6, 0.05, 1.0)], &Question { uncertainty: Some(0.4), ..question }).tool.unwrap();
    assert!(lost.nearest.worst_wall.rms_um > 2.0 * wide.nearest.worst_wall.rms_um, "{:?}", lost.nearest);
}

/// An axis that rings from 40 to 130 Hz, place by place: Klipper's law takes three humps for it, which this firmware
/// does not have, and the suggestion is one that it has.
#[test]
fn a_shaper_that_the_firmware_lacks_is_never_suggested() {
    let question = Question::default();
    let places = [40.0, 60.0, 90.0, 130.0].map(|hz| {
        let recording = recording(&[(hz, 0.05, 1.0)], &question.sweep, RATE, 100.0, hz as u64);
        measure(Named { file: "raw_data_y.csv", recording: &recording }, None, &question.sweep).unwrap()
    });
    let axis = judge(Some(label::Axis::Y), places.to_vec(), &question);
    assert_eq!(axis.klipper.suggestion.map(|rated| rated.shaper.name()), Some("3HUMP_EI"), "{:?}", axis.klipper);
    let (tool, suggestion) = (axis.tool.unwrap(), axis.suggestion.unwrap());
    assert!(suggestion.rated.in_firmware && tool.shapers.iter().all(|s| s.rated.in_firmware), "{suggestion:?}");
    assert!(suggestion.why.contains("Klipper would take 3HUMP_EI"), "{}", suggestion.why);
    let kind = suggestion.line.as_deref().and_then(|line| line.rsplit_once(" T")).map(|(_, kind)| kind.parse::<u8>());
    assert!(matches!(kind, Some(Ok(0..=4))), "{:?}", suggestion.line);
}

#[test]
fn belts_are_compared_and_the_looser_one_is_named() {
    use corehbot_resonance::belts::compare;
    let sweep = Sweep::default();
    let measured = |file: &str, modes: &[Mode], seed: u64| {
        let recording = recording(modes, &sweep, RATE, 100.0, seed);
        measure(Named { file, recording: &recording }, None, &sweep).unwrap()
    };
    let a = measured("a", &[(60.0, 0.05, 1.0)], 1);
    let same = compare(&a, &measured("b", &[(60.3, 0.05, 1.0)], 2));
    assert!(same.similarity_percent > 97.0 && same.alone == [vec![], vec![]] && same.pairs.len() == 1, "{same:?}");
    assert_eq!(same.verdict, "Both paths respond alike.");
    let tight = compare(&a, &measured("b", &[(66.0, 0.05, 1.0)], 3));
    assert!(
        tight.similarity_percent < same.similarity_percent - 10.0 && tight.verdict.starts_with("Path A rings 9."),
        "{}",
        tight.verdict
    );
    assert!((tight.frequency_difference_percent.unwrap() + 9.1).abs() < 0.5, "{tight:?}");
    assert!((tight.stiffness_difference_percent.unwrap() + 17.4).abs() < 1.0, "{tight:?}");
    let two = compare(&a, &measured("b", &[(60.0, 0.05, 0.7), (100.0, 0.04, 0.3)], 4));
    assert!(two.alone[0].is_empty() && two.alone[1].len() == 1 && two.verdict.contains("Only path B"), "{two:?}");
}

/// The same plant under plain moves of whole steps.
#[test]
fn a_sweep_of_moves_is_as_good() {
    let moves = Sweep { accel_per_hz: 34.0, swing_accel: 0.0, resolution_mm: 0.0125, ..Sweep::default() };
    for known in [(48.6, 0.06, 1.0), (81.0, 0.10, 1.0)] {
        are(&found(&[known], 100.0, &moves), &[known], 0.005, 0.1);
    }
}
