//! Machines far from the nominal one, and searches past the nearest minimum.

use super::{BAR, CENTRE, HEAD, SLIP, measured, push, ring, told};
use corehbot_twin::calibration::{CalibrateError, Direction, Figure, Measurement, Parameter, calibrate};
use corehbot_twin::params::{Each, Params};
use corehbot_twin::routing::{Machine, Place};

/// Deflections and dampings that guesses explain only together, far from the start: whole Gauss-Newton steps jump to
/// and fro over the minimum there.
#[test]
fn the_search_converges_far_from_the_start() {
    for machine in [Machine::HBot, Machine::CoreHBot, Machine::CoreXy] {
        for (figure, measured) in [
            (push(Direction::X), 0.1),
            (push(Direction::X), 0.15),
            (push(Direction::X), 0.2),
            (ring(CENTRE, Direction::X), 60.0),
            (ring(CENTRE, Direction::X), 75.0),
            (Figure::Damping { at: CENTRE, along: Direction::X }, 0.1),
            (Figure::Damping { at: CENTRE, along: Direction::Y }, 0.04),
        ] {
            let one = Measurement { figure, measured, uncertainty: figure.usual_uncertainty() };
            let weight = Measurement { figure: HEAD, measured: 0.6, uncertainty: 0.01 };
            let answer = calibrate(machine, &Params::default(), &[weight, one], &[]);
            let Ok(found) = answer else { panic!("{machine:?} {figure:?} {measured}: {answer:?}") };
            assert!(found.misfits.iter().all(|m| m.uncertainties.abs() < 3.0), "{machine:?} {figure:?}: {found:?}");
        }
    }
}

/// With equal tensions nothing depends on the stiffness of the yaw, at the start. With the plucked tensions the skew
/// depends on it. Tensions of 60 and 40 N of a CoreXY: 9.4 N m turn guides of 3,000 N m/rad by 3.13 mrad.
#[test]
fn a_number_that_matters_only_away_from_the_start_is_found() {
    let sign = {
        let unlike = Params { preload_n: Each::listed(&[60.0, 40.0]).unwrap(), ..Params::default() };
        Figure::Skew { at: CENTRE }.predict(Machine::CoreXy, &unlike).unwrap().signum()
    };
    // T = 4 m L^2 f^2
    let pluck = |belt: usize, tension: f64| Measurement {
        figure: Figure::Pluck { length_mm: 380.0, belt },
        measured: (tension / (4.0 * 0.0125)).sqrt() / 0.38,
        uncertainty: 0.001,
    };
    let mass = Measurement { figure: Figure::BeltMass, measured: 0.0125, uncertainty: 0.001 };
    let skew = Measurement { figure: Figure::Skew { at: CENTRE }, measured: sign * 9.4 / 3.0, uncertainty: 0.02 };
    let all = [mass, pluck(0, 60.0), pluck(1, 40.0), skew];
    let found = calibrate(Machine::CoreXy, &Params::default(), &all, &[]).unwrap();
    assert!((found.params.bar_yaw_stiffness_nm_per_rad / 3000.0 - 1.0).abs() < 0.01, "{found:?}");
    assert!(told(&found.estimates).contains(&Parameter::YawStiffness), "{found:?}");
}

/// Fifteen times stiffer guides lift the bar's yaw over both axes' frequencies.
#[test]
fn guides_far_stiffer_than_the_nominal_ones_are_found() {
    let stiff = Params { bar_yaw_stiffness_nm_per_rad: 30_000.0, ..Params::default() };
    let side = Place::flat(60.0, 235.0);
    let figures = [
        HEAD,
        BAR,
        SLIP,
        push(Direction::X),
        push(Direction::Y),
        ring(CENTRE, Direction::X),
        ring(side, Direction::Y),
        Figure::YawRing { at: side },
        Figure::Deflection { at: side, along: Direction::Y, force_n: 20.0 },
    ];
    let one = |figure: Figure| Measurement {
        figure,
        measured: figure.predict(Machine::CoreHBot, &stiff).unwrap(),
        uncertainty: 0.002,
    };
    let found = calibrate(Machine::CoreHBot, &Params::default(), &figures.map(one), &[]).unwrap();
    assert!((found.params.bar_yaw_stiffness_nm_per_rad / 30_000.0 - 1.0).abs() < 0.05, "{found:?}");
}

/// A force in the wrong unit leaves no machine in reach; the others fit, and say what it should be.
#[test]
fn a_measurement_out_of_all_reach_is_named() {
    let mut all = measured(&[HEAD, BAR, SLIP], 0.01, || 1.0);
    all[2].measured *= 1e6;
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &all, &[]);
    let Err(CalibrateError::Unlike(misfits)) = answer else { panic!("{answer:?}") };
    assert!(misfits[2].is_suspect && misfits.iter().filter(|m| m.is_suspect).count() == 1, "{misfits:?}");
    assert!(misfits[..2].iter().all(|m| m.uncertainties.abs() < 0.1), "{misfits:?}");
    // The lever's nominal torque.
    assert!((misfits[2].model / 4.0 - 1.0).abs() < 1e-6, "{misfits:?}");
}

/// Two frequencies along y of stiff guides: the search from the nominal stiffness alone ends in another minimum.
#[test]
fn stiff_guides_are_found_past_the_nearest_minimum() {
    let stiff = Params { bar_yaw_stiffness_nm_per_rad: 30_000.0, ..Params::default() };
    let side = Place::flat(60.0, 235.0);
    let one = |figure: Figure| Measurement {
        figure,
        measured: figure.predict(Machine::CoreHBot, &stiff).unwrap(),
        uncertainty: 0.002,
    };
    let measurements = [HEAD, BAR, ring(side, Direction::Y), ring(CENTRE, Direction::Y)].map(one);
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &measurements, &[]);
    let Ok(found) = answer else { panic!("{answer:?}") };
    assert!(found.misfits.iter().all(|m| m.uncertainties.abs() < 3.0), "{:?}", found.misfits);
    assert!(found.params.bar_yaw_stiffness_nm_per_rad > 5000.0, "{:?}", found.params);
}
