//! Refused cases and their messages.

use super::super::*;

#[test]
fn speeds_and_factors_out_of_range_are_refused_by_name() {
    for speed in [0.0, -0.02, 1.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(run(&Case::at(speed)), Err(Error::Speed(_))), "{speed}");
    }
    let at = Case::at(0.05);
    for factor in [-1.0, 0.01, 21.0, f64::NAN] {
        assert!(matches!(run(&Case { friction: factor, ..at }), Err(Error::Factor("friction", _))));
        assert!(matches!(run(&Case { stiffness: factor, ..at }), Err(Error::Factor("stiffness", _))));
        assert!(matches!(run(&Case { mass: factor, ..at }), Err(Error::Factor("mass", _))));
    }
    assert!(matches!(run(&Case { stiffness: 0.0, ..at }), Err(Error::Factor("stiffness", _))));
    assert!(run(&Case { friction: 0.0, ..at }).is_ok());
}

#[test]
fn a_rig_that_is_no_machine_is_refused() {
    let slack = Parameters { stiffness: [8000.0, 0.0, 3000.0, 3000.0, 6000.0], ..NOMINAL };
    assert_eq!(run_on(&slack, &Case::at(0.05)), Err(Error::Parameter("stiffness")));
    let weightless = Parameters { pulley_inertia: 0.0, ..NOMINAL };
    assert_eq!(run_on(&weightless, &Case::at(0.05)), Err(Error::Parameter("mass")));
    let pushed = Parameters { guide_viscous: [-1.0, 75.0], ..NOMINAL };
    assert_eq!(run_on(&pushed, &Case::at(0.05)), Err(Error::Parameter("friction")));
}

#[test]
fn a_tool_that_lags_more_than_a_side_never_turns() {
    let error = run(&Case { friction: 10.0, stiffness: 0.2, ..Case::at(0.2) }).unwrap_err();
    assert_eq!(error, Error::NotTurned(1));
    assert!(error.to_string().contains("corner 1"), "{error}");
}

#[test]
fn a_case_of_too_many_steps_is_refused_before_it_is_computed() {
    let error = run(&Case { friction: 20.0, mass: 0.05, ..Case::at(0.01) }).unwrap_err();
    assert!(matches!(error, Error::TooManySteps(_)), "{error}");
}

#[test]
fn absurd_numbers_of_a_rig_are_refused_without_a_panic() {
    for k in [1e300, f64::MAX / 4.0, f64::MAX] {
        let rig = Parameters { stiffness: [k; 5], ..NOMINAL };
        for drive in [Drive::Stepper, Drive::Dc(100.0)] {
            assert!(matches!(run_on(&rig, &Case { drive, ..Case::at(0.05) }), Err(Error::TooManySteps(_))), "{k}");
            assert!(trajectory(&rig, &Case { drive, ..Case::at(0.05) }).is_err(), "{k}");
        }
    }
    // A factor that makes a number infinite.
    let rig = Parameters { stiffness: [f64::MAX; 5], ..NOMINAL };
    assert_eq!(run_on(&rig, &Case { stiffness: 2.0, ..Case::at(0.05) }), Err(Error::Parameter("stiffness")));
    let rig = Parameters { guide_viscous: [1e300; 2], ..NOMINAL };
    assert!(matches!(run_on(&rig, &Case::at(0.05)), Err(Error::TooManySteps(_))));
}

#[test]
fn factors_are_refused_without_a_speed_too() {
    let without = Case::at(0.0);
    assert_eq!(scaled(&NOMINAL, &without), Ok(NOMINAL));
    assert_eq!(scaled(&NOMINAL, &Case { friction: 1000.0, ..without }), Err(Error::Factor("friction", 1000.0)));
}
