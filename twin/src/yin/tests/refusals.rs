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
