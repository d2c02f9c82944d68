//! Tests of check.

use super::*;

#[test]
fn the_prototype_is_legal() {
    assert_eq!(Settings::prototype().check_machine(), Ok(()));
}

#[test]
fn drivers_have_limits_too() {
    let mut s = Settings::prototype();
    s.drivers.z.microsteps = 24;
    assert_eq!(s.check(), Err(SettingsError::NoSuchMicrosteps("drivers.z")));
    s.drivers.belt.current_ma = 1701;
    assert_eq!(s.check(), Err(SettingsError::OutOfRange("drivers.belt")));
}

#[test]
fn shaping_has_limits() {
    let error = |change: fn(&mut Settings)| {
        let mut s = Settings::prototype();
        change(&mut s);
        s.check()
    };
    let illegal = |what| Err(SettingsError::OutOfRange(what));
    assert_eq!(error(|s| s.shapers.x.frequency = Hertz::lit("9.9")), illegal("shaper.x"));
    assert_eq!(error(|s| s.shapers.y.damping = Ratio::lit("0.51")), illegal("shaper.y"));
    assert_eq!(error(|s| s.advance.time = Seconds::lit("4.1")), illegal("advance.time"));
    assert_eq!(error(|s| s.advance.window = Seconds::ZERO), illegal("advance.window"));
    assert_eq!(error(|s| s.advance.time = Seconds::lit("4")), Ok(()));
    assert_eq!(error(|s| s.minimum_cruise_ratio = Ratio::lit("0.91")), illegal("minimum_cruise_ratio"));
    assert_eq!(error(|s| s.lookahead_time = Seconds::lit("0.49")), illegal("lookahead_time"));
    assert_eq!(error(|s| s.lookahead_time = Seconds::const_from_int(61)), illegal("lookahead_time"));
}

#[test]
fn a_resolution_that_shared_motors_cannot_have_is_named() {
    let mut s = Settings::prototype();
    s.axes.y.steps_per_mm = StepsPerMm::const_from_int(160);
    assert_eq!(s.check(), Err(SettingsError::ResolutionsDiffer("x and y")));
    s.axes.y.steps_per_mm = StepsPerMm::const_from_int(25_600);
    assert_eq!(s.check(), Err(SettingsError::TooManySteps("axes.y")));
}
