//! Dampers between motor and tool, and between tool and frame; vibration across the swept axis; spectra in files.

use crate::extent::is_all;
use crate::plant::{Plant, recording, shaken};
use corehbot_resonance::axis::{Named, Question, judge, measure, measure_density};
use corehbot_resonance::density;
use corehbot_resonance::label::Axis;
use corehbot_resonance::modes::{Modes, fit};
use corehbot_resonance::sweep::Sweep;
use std::fmt::Write as _;

const RATE: f64 = 1600.0;

fn found(plant: &Plant) -> Modes {
    let sweep = Sweep { hz_per_s: 2.0, ..Sweep::default() };
    fit(&shaken(plant, &sweep, RATE, 100.0, 5), Some(Axis::X), &sweep).unwrap()
}

/// From 15 to 130 Hz, 0.01 to 0.2: the frequency within 1 %, the damping within 10 %, and one mode.
#[test]
fn a_damper_is_found_wherever_it_acts() {
    for (hz, damping) in
        [(15.0, 0.01), (15.0, 0.2), (18.0, 0.08), (26.0, 0.13), (60.0, 0.18), (130.0, 0.04), (130.0, 0.2)]
    {
        for belt in [0.0, 1.0] {
            let found = found(&Plant { modes: &[(hz, damping, 1.0)], belt, ..Plant::default() });
            let [mode] = found.modes[..] else { panic!("{hz} Hz, {damping}, {belt}: {:?}", found.modes) };
            assert!((mode.frequency_hz / hz - 1.0).abs() < 0.01, "{hz} Hz, {damping}, {belt}: {mode:?}");
            assert!((mode.damping_ratio / damping - 1.0).abs() < 0.1, "{hz} Hz, {damping}, {belt}: {mode:?}");
        }
    }
}

#[test]
fn the_share_of_the_belt_is_told() {
    // It counts by its square, so a small one is coarse.
    for (belt, off) in [(0.0, 0.15), (0.5, 0.05), (1.0, 0.03)] {
        let found = found(&Plant { modes: &[(60.0, 0.12, 1.0)], belt, ..Plant::default() });
        assert!((found.belt_damping_share - belt).abs() < off, "{belt}: {}", found.belt_damping_share);
        assert!((found.modes[0].damping_ratio / 0.12 - 1.0).abs() < 0.03, "{belt}: {:?}", found.modes);
    }
}

#[test]
fn vibration_across_the_axis_moves_no_frequency() {
    let found = found(&Plant { modes: &[(70.0, 0.06, 1.0)], across: &[(43.0, 0.05, 0.5)], belt: 0.0 });
    let [mode] = found.modes[..] else { panic!("{:?}", found.modes) };
    assert!((mode.frequency_hz / 70.0 - 1.0).abs() < 0.002, "{mode:?}");
}

/// A sensor that was mounted with other axes: its own direction is taken, and a remark says so.
#[test]
fn a_sensor_along_another_axis_is_found_and_told() {
    let sweep = Sweep { hz_per_s: 4.0, ..Sweep::default() };
    let mut turned = recording(&[(60.0, 0.06, 1.0)], &sweep, RATE, 100.0, 4);
    turned.axes.swap(0, 1);
    let measured = measure(Named { file: "x", recording: &turned }, Some(Axis::X), &sweep).unwrap();
    let mode = measured.fit.unwrap().modes[0];
    assert!((mode.frequency_hz / 60.0 - 1.0).abs() < 0.005, "{mode:?}");
    assert!(measured.remarks.iter().any(|remark| remark.contains("most along its own y")), "{:?}", measured.remarks);
}

/// The file that Klipper writes for a recording leads to the same shaper, and to nearly the same modes.
#[test]
fn a_spectrum_in_a_file_serves_like_its_recording() {
    let sweep = Sweep { hz_per_s: 2.0, ..Sweep::default() };
    let known = [(42.0, 0.06, 0.6), (88.0, 0.08, 0.4)];
    let recording = recording(&known, &sweep, 3200.0, 100.0, 4);
    let raw = measure(Named { file: "x", recording: &recording }, Some(Axis::X), &sweep).unwrap();
    let measured = |header: &str| {
        let is_normalised = header.contains("shapers");
        let mut text = format!("{header}\n");
        for (i, sum) in raw.spectrum.sum.iter().enumerate() {
            let by = if is_normalised { raw.normalised[i] / sum } else { 1.0 };
            let [x, y, z] = raw.spectrum.axes.each_ref().map(|axis| by * axis[i]);
            let hz = i as f64 * raw.spectrum.step_hz;
            writeln!(
                text,
                "{hz:.1},{x:.3e},{y:.3e},{z:.3e},{:.3e}{}",
                by * sum,
                if is_normalised { ",,1" } else { "" }
            )
            .unwrap();
        }
        let all = density::read(&text).unwrap();
        measure_density("x", &all[0].1, Some(Axis::X), &sweep)
    };
    let question = Question { sweep, ..Question::default() };
    let line = |measured| judge(Some(Axis::X), vec![measured], &question).suggestion.unwrap().line;
    let of_recording = line(raw.clone());
    for header in ["freq,psd_x,psd_y,psd_z,psd_xyz", "freq,psd_x,psd_y,psd_z,psd_xyz,shapers:,zv(41.0)"] {
        let measured = measured(header);
        assert_eq!(line(measured.clone()), of_recording, "{header}");
        let fit = measured.fit.unwrap();
        assert_eq!(fit.modes.len(), 2, "{header}: {fit:?}");
        for (hz, damping, _) in known {
            let near = |mode: &&corehbot_resonance::modes::Mode| (mode.frequency_hz / hz - 1.0).abs() < 0.01;
            let found = fit.modes.iter().find(near).unwrap();
            assert!((found.damping_ratio / damping - 1.0).abs() < 0.15, "{header}: {found:?}");
        }
    }
}

/// A file ends below the frequencies that tell the noise, so the fit finds it. By default each mode is tried at one
/// place, and each place with a low and a high mode; `cargo xtask test --all` tries each mode at both.
#[test]
fn a_damper_is_found_in_a_spectrum_wherever_it_acts() {
    let sweep = Sweep { hz_per_s: 2.0, ..Sweep::default() };
    let modes = [(15.0, 0.2, 100.0), (25.0, 0.2, 0.0), (48.0, 0.1, 1000.0), (130.0, 0.2, 100.0)];
    for ((hz, damping, noise), usual) in modes.into_iter().zip([0.0, 1.0, 0.0, 1.0]) {
        for belt in [0.0, 1.0].into_iter().filter(|belt| is_all() || *belt == usual) {
            let plant = Plant { modes: &[(hz, damping, 1.0)], belt, ..Plant::default() };
            let recording = shaken(&plant, &sweep, RATE, noise, 4);
            let raw = measure(Named { file: "x", recording: &recording }, Some(Axis::X), &sweep).unwrap();
            let mut text = String::from("freq,psd_x,psd_y,psd_z,psd_xyz\n");
            for (i, sum) in raw.spectrum.sum.iter().enumerate() {
                let [x, y, z] = raw.spectrum.axes.each_ref().map(|axis| axis[i]);
                writeln!(text, "{:.1},{x:.3e},{y:.3e},{z:.3e},{sum:.3e}", i as f64 * raw.spectrum.step_hz).unwrap();
            }
            let density = &density::read(&text).unwrap()[0].1;
            let modes = measure_density("x", density, Some(Axis::X), &sweep).fit.unwrap().modes;
            let [mode] = modes[..] else { panic!("{hz} Hz, {damping}, {belt}: {modes:?}") };
            assert!((mode.frequency_hz / hz - 1.0).abs() < 0.005, "{hz} Hz, {damping}, {belt}: {mode:?}");
            assert!((mode.damping_ratio / damping - 1.0).abs() < 0.05, "{hz} Hz, {damping}, {belt}: {mode:?}");
        }
    }
}

/// Klipper writes several sensors on a grid of 0.2 Hz, finer than the windows that made the spectra.
#[test]
fn spectra_of_several_sensors_are_read_at_their_own_bins() {
    let sweep = Sweep { hz_per_s: 2.0, ..Sweep::default() };
    let known = [45.0, 56.0];
    let spectra = known.map(|hz| {
        let recording = recording(&[(hz, 0.05, 1.0)], &sweep, 3200.0, 100.0, 4);
        measure(Named { file: "x", recording: &recording }, Some(Axis::X), &sweep).unwrap()
    });
    for is_normalised in [false, true] {
        let mut text = format!("freq,one,two{}\n", if is_normalised { ",shapers:,zv(41.0)" } else { "" });
        for i in 0..1000 {
            let at = f64::from(i) * 0.2;
            let value = |spectrum: &corehbot_resonance::axis::Measured| {
                let all = if is_normalised { &spectrum.normalised } else { &spectrum.spectrum.sum };
                let (bin, part) = ((at / spectrum.spectrum.step_hz) as usize, (at / spectrum.spectrum.step_hz).fract());
                all[bin] * (1.0 - part) + all[bin + 1] * part
            };
            let end = if is_normalised { ",,1" } else { "" };
            writeln!(text, "{at:.1},{:.3e},{:.3e}{end}", value(&spectra[0]), value(&spectra[1])).unwrap();
        }
        let read = density::read(&text).unwrap();
        assert_eq!(read.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["one", "two"]);
        for ((_, density), hz) in read.iter().zip(known) {
            let modes = measure_density("x", density, Some(Axis::X), &sweep).fit.unwrap().modes;
            let [mode] = modes[..] else { panic!("{hz} Hz, {is_normalised}: {modes:?}") };
            assert!((mode.frequency_hz / hz - 1.0).abs() < 0.01, "{hz} Hz, {is_normalised}: {mode:?}");
            assert!((mode.damping_ratio / 0.05 - 1.0).abs() < 0.1, "{hz} Hz, {is_normalised}: {mode:?}");
        }
    }
}
