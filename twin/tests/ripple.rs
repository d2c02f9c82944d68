//! Ripple against closed forms of a CoreH-bot in the middle, and pitches of its belts.

use corehbot_twin::geometry::workspace;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::params::{Each, Params};
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::ripple::{Question, Ripple, RippleError};
use corehbot_twin::queries::tension::{Tension, TensionError};
use corehbot_twin::ripple::response::{Response, Shaken};
use corehbot_twin::ripple::source::{Amounts, RippleKind};
use corehbot_twin::routing::{Machine, Place};
use std::f64::consts::{FRAC_PI_4, TAU};

const MIDDLE: Place = Place::flat(235.0, 235.0);

/// Idlers without inertia, as in the closed forms.
fn light() -> Params {
    Params { idler_inertia_kg_m2: 1e-13, detent_torque_nm: Some(0.02), ..Params::default() }
}

/// Root of the sum of squares across the path of one kind.
fn across(response: &Response, angle: f64, speed: f64, kind: RippleKind) -> f64 {
    let own = response.at(angle, speed, f64::INFINITY).filter(|s| s.kind == kind);
    own.map(|s| s.across_um * s.across_um).sum::<f64>().sqrt()
}

fn response(params: &Params) -> Response {
    Response::new(Machine::CoreHBot, params, MIDDLE, &Amounts::of(params), false).unwrap()
}

/// y of the bar by a force F on one rotor. In the middle y couples only with the rotors' pattern (+, -, -, +) of
/// amplitude a, and F does the work F a on it. Spans of y have L = 862.2 mm, so with k = EA / L:
///
/// ```text
/// M y'' + 8 k (y - a) = 0,   4 (J/r^2) a'' + 4 k_m a - 8 k (y - a) = F
/// ```
///
/// with the belt's damper beside k, guides on y and drag on the rotors.
fn bar_um(params: &Params, force_n: f64, hz: f64) -> f64 {
    type C = (f64, f64);
    let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let w = TAU * hz;
    let r = 6.35e-3;
    let k = 30_000.0 / 0.8622;
    let belt = (8.0 * k, 8.0 * k * 2e-4 * w);
    let bar = (belt.0 - 1.8 * w * w, belt.1 + 4.0 * w);
    let field = 0.4 * 50.0 / (r * r);
    let rotors =
        (belt.0 + 4.0 * field - 4.0 * 5.4e-6 / (r * r) * w * w, belt.1 + 4.0 * params.rotor_damping_nm_s / (r * r) * w);
    let (square, both) = (mul(bar, rotors), mul(belt, belt));
    let determinant = (square.0 - both.0, square.1 - both.1);
    1e6 * force_n * belt.0.hypot(belt.1) / determinant.0.hypot(determinant.1)
}

/// Along x all four motors turn by the path, and y is across. One detent a full step of 0.1995 mm.
#[test]
fn the_detent_shakes_the_bar_by_the_closed_form() {
    let params = light();
    let found = response(&params);
    let step_mm = TAU * 6.35 / 200.0;
    for speed in [2.0, 8.0, 11.5, 15.0, 60.0] {
        let known = 2.0 * bar_um(&params, 0.02 / 6.35e-3, speed / step_mm);
        let own = across(&found, 0.0, speed, RippleKind::Detent);
        assert!((own / known - 1.0).abs() < 0.01, "{speed} mm/s: {own} um, {known}");
    }
    // 2 % of a full step, once a full step, twice and once an electrical turn: the same force at two and four times the
    // speed.
    let force = 0.4 * 50.0 / 6.35e-3 * (0.02 * step_mm / 6.35);
    for (kind, speed) in
        [(RippleKind::FullStep, 11.5), (RippleKind::HalfTurn, 23.0), (RippleKind::ElectricalTurn, 46.0)]
    {
        let known = 2.0 * bar_um(&params, force, 11.5 / step_mm);
        let own = across(&found, 0.0, speed, kind);
        assert!((own / known - 1.0).abs() < 0.01, "{kind:?}: {own} um, {known}");
    }
}

/// The torques of two phases are (1 + d) sin and (1 - d) cos of the rotor's electrical angle. Where they cancel, the
/// rotor is off. If they differ by 6.3 %, it is off by 2 % of a full step, twice an electrical turn.
#[test]
fn phases_that_differ_by_six_percent_are_the_assumed_error_of_a_half_turn() {
    let d = 0.063 / 2.0;
    let off = |sent: f64| {
        let torque = |at: f64| (1.0 - d) * sent.sin() * at.cos() - (1.0 + d) * sent.cos() * at.sin();
        let (mut low, mut high) = (sent - 0.2, sent + 0.2);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            *(if torque(middle) > 0.0 { &mut low } else { &mut high }) = middle;
        }
        100.0 * (low - sent) / (TAU / 4.0)
    };
    let turn: Vec<f64> = (0..360).map(|deg| off(f64::from(deg).to_radians())).collect();
    let most = turn.iter().copied().fold(0.0, f64::max);
    assert!((most / Params::default().half_turn_error_percent - 1.0).abs() < 0.01, "{most}");
    assert!(turn.iter().zip(&turn[180..]).all(|(a, b)| (a - b).abs() < 1e-9));
    assert!((turn[45] + most).abs() < 1e-3 && (turn[135] - most).abs() < 1e-3, "{} {}", turn[45], turn[135]);
}

#[test]
fn a_yaw_that_nothing_damps_is_refused() {
    let params = Params { guide_y_n_s_per_m: 0.0, ..Params::default() };
    let setup = |machine, yaw| Setup {
        params: params.clone(),
        freedom: Freedom { yaw, ..Freedom::default() },
        ..Setup::nominal(machine, 235.0, 235.0)
    };
    let question = Question { step_mm_s: 50.0, angle_step_deg: 45.0, ..Question::default() };
    let refused = Ripple::new(&setup(Machine::CoreHBot, true), &question).unwrap_err();
    assert_eq!(refused, RippleError::Undamped);
    assert!(refused.to_string().contains("guide_y_N_s_per_m is 0"), "{refused}");
    // The belts damp all other modes.
    assert!(Ripple::new(&setup(Machine::CoreHBot, false), &question).is_ok());
}

/// On a diagonal two motors stand and the others turn 1.414 times as fast; along y, x is across.
#[test]
fn a_motor_at_rest_does_not_shake() {
    let found = response(&light());
    let turning = |angle: f64| {
        let all = found.at(angle, 30.0, f64::INFINITY).filter(|s| s.kind == RippleKind::Detent);
        all.collect::<Vec<Shaken>>()
    };
    assert_eq!(turning(0.0).len(), 4);
    let diagonal = turning(FRAC_PI_4);
    assert_eq!(diagonal.iter().map(|s| s.pulley).collect::<Vec<_>>(), [4, 11]);
    assert!(diagonal.iter().all(|s| (s.wave_mm * 2.0_f64.sqrt() / 0.199_49 - 1.0).abs() < 1e-3), "{diagonal:?}");
}

/// With stiff fields and hardly any speed, a pulley off by c stretches the spans on both sides as it turns. A motor
/// moves the tool by c/4 in x and in y; an idler between two spans' segments at a right angle moves one axis by
/// sqrt 2 c/4. Along x four motors and pulleys 2, 3, 9 and 10 move y: c sqrt(4/16 + 8/16). An error of teeth moves each
/// axis by a quarter, with four motors by a half.
#[test]
fn slow_pulleys_and_teeth_move_the_tool_by_their_share() {
    let params = Params { holding_torque_nm: 1e5, ..light() };
    let found = response(&params);
    let pulleys = across(&found, 0.0, 1e-3, RippleKind::Pulley);
    assert!((pulleys / (15.0 * 0.75_f64.sqrt()) - 1.0).abs() < 1e-3, "{pulleys}");
    let teeth = across(&found, 0.0, 1e-3, RippleKind::Tooth);
    assert!((teeth / (2.0 * 0.5) - 1.0).abs() < 1e-3, "{teeth}");
    // Pulleys 6 and 13 on the head turn only as y moves.
    let along_x: Vec<u8> =
        found.at(0.0, 1.0, f64::INFINITY).filter(|s| s.kind == RippleKind::Pulley).map(|s| s.pulley).collect();
    assert!(along_x.len() == 12 && !along_x.contains(&6) && !along_x.contains(&13), "{along_x:?}");
    // Idlers beside the bar's ends turn twice as fast when y moves: 20 mm of the path a turn.
    let fastest = found.at(2.0 * FRAC_PI_4, 1.0, f64::INFINITY).filter(|s| s.pulley == 5).map(|s| s.wave_mm).next();
    assert!(fastest.is_some_and(|mm| (mm / (TAU * 6.35 / 2.0) - 1.0).abs() < 1e-6), "{fastest:?}");
}

#[test]
fn the_loudest_speeds_are_the_resonant_ones_and_less_detent_is_calmer() {
    let setup = Setup { params: light(), ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let question = Question { angle_step_deg: 15.0, ..Question::default() };
    let found = Ripple::new(&setup, &question).unwrap();
    assert_eq!((found.angles_deg.len(), found.speeds_mm_s.len()), (12, 141));
    // Electrical turns meet y (57.6 Hz) along x, teeth at 2.5 times the speed.
    let turns = found.sources.iter().find(|s| s.kind == RippleKind::ElectricalTurn).unwrap();
    assert!((turns.frequency_hz / 57.64 - 1.0).abs() < 0.03 && turns.across_um > 1.0, "{turns:?}");
    let teeth = found.sources.iter().find(|s| s.kind == RippleKind::Tooth).unwrap();
    assert!((teeth.frequency_hz / 57.64 - 1.0).abs() < 0.03 && teeth.speed_mm_s > 100.0, "{teeth:?}");
    let worst = found.worst.iter().map(|w| w.across_um).fold(0.0, f64::max);
    // At every speed a motor meets y in some direction close to a diagonal; along x and y there are calm speeds.
    assert!(found.best.across_um < worst && found.best.across_um > 0.5 * worst, "{:?}", found.best);
    assert!(found.best_along_x_and_y.across_um < 0.2 * worst, "{:?}", found.best_along_x_and_y);
    assert!(found.loud_mm_s.iter().all(|loud| *loud != found.best.speed_mm_s), "{:?}", found.loud_mm_s);
    // All phases together are at most the root of the number of sources as much.
    assert!(found.worst.iter().all(|w| w.aligned_um >= w.across_um && w.aligned_um <= 34.0_f64.sqrt() * w.across_um));
    // More current: stiffer fields against the same detent. An error of fields grows with them.
    assert!(found.currents.windows(2).all(|pair| pair[0].holding_torque_nm < pair[1].holding_torque_nm));
    let text = found.to_string();
    assert!(text.contains("Best speeds for outer walls") && text.contains("M593 changes nothing"), "{text}");
    // Nothing repeats on a machine without errors.
    let perfect = Params {
        full_step_error_percent: 0.0,
        half_turn_error_percent: 0.0,
        electrical_turn_error_percent: 0.0,
        tooth_error_um: 0.0,
        pulley_eccentricity_um: 0.0,
        detent_torque_nm: Some(0.0),
        ..Params::default()
    };
    let calm = Ripple::new(&Setup { params: perfect, ..setup }, &question).unwrap();
    assert!(calm.worst.iter().all(|w| w.across_um == 0.0), "{:?}", calm.best);
    assert!(!calm.to_string().contains("assumed") && Amounts::of(&Params::default()).is_detent_assumed, "{calm}");
}

/// Slow motors close to a diagonal meet a mode within a tenth of a degree, which even distances pass over.
#[test]
fn the_worst_direction_does_not_depend_on_the_distance_of_the_angles() {
    let setup = Setup { params: light(), ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let by = |angle_step_deg: f64| {
        let question = Question { speeds_mm_s: [40.0, 280.0], step_mm_s: 30.0, angle_step_deg, ..Question::default() };
        Ripple::new(&setup, &question).unwrap()
    };
    let (coarse, fine) = (by(5.0), by(1.0));
    for (coarse, fine) in coarse.worst.iter().zip(&fine.worst) {
        assert!((coarse.across_um / fine.across_um - 1.0).abs() < 0.03, "{coarse:?}, {fine:?}");
    }
    for (coarse, fine) in coarse.sources.iter().zip(&fine.sources) {
        assert!((coarse.across_um / fine.across_um - 1.0).abs() < 0.03, "{coarse:?}, {fine:?}");
    }
    assert!((coarse.best.across_um / fine.best.across_um - 1.0).abs() < 0.03, "{:?}, {:?}", coarse.best, fine.best);
    // Two motors that turn by sqrt 2 sin(d) of the path, d from the diagonal, meet y (57.64 Hz) by their full steps.
    let found = response(&light());
    let aside = (57.64 * TAU * 6.35 / 200.0 / (160.0 * 2.0_f64.sqrt())).asin();
    let met = across(&found, FRAC_PI_4 - aside, 160.0, RippleKind::FullStep);
    assert!(met > 3.0 * across(&found, FRAC_PI_4 - 1.5 * aside, 160.0, RippleKind::FullStep), "{met}");
    let at = coarse.speeds_mm_s.iter().position(|speed| *speed == 160.0).unwrap();
    assert!(coarse.worst[at].across_um >= met, "{:?}, {met}", coarse.worst[at]);
}

#[test]
fn every_routing_ripples() {
    let question = Question { step_mm_s: 20.0, angle_step_deg: 45.0, ..Question::default() };
    for machine in Machine::ALL {
        let params = Params::default();
        let tool = workspace(machine, &params).centre();
        let setup = Setup { machine, params, tool, freedom: Freedom { yaw: true, ..Freedom::default() } };
        let found = Ripple::new(&setup, &question).unwrap();
        let all = found.across_um.iter().flatten();
        assert!(all.clone().all(|um| um.is_finite() && *um < 500.0) && all.clone().any(|um| *um > 0.01), "{machine:?}");
    }
}

/// `f = sqrt(T / m) / (2 L)`: the bar's front belt is free for W - 4 r = 444.6 mm, and sides for 235 - 26.2.
#[test]
fn pitches_of_the_belts_parts() {
    let setup = Setup::nominal(Machine::CoreHBot, 235.0, 235.0);
    let found = Tension::new(&setup, None, &[]).unwrap();
    assert_eq!(found.parts.len(), 14);
    let hz = |part: usize| found.parts[part - 1].pitch_hz.unwrap();
    let wave = (40.0_f64 / 0.0125).sqrt();
    assert!((hz(1) - wave / (2.0 * 0.2088)).abs() < 0.01 && (hz(2) - wave / (2.0 * 0.4446)).abs() < 0.01);
    assert!(found.parts[1].is_longest || found.parts[8].is_longest);
    // Four times the tension is an octave, and a pitch that was heard gives the tension back.
    let tight = Tension::new(&setup, Some(160.0), &[(2, hz(2)), (9, 1.1 * hz(9))]).unwrap();
    assert!((tight.parts[1].pitch_hz.unwrap() / hz(2) - 2.0).abs() < 1e-9);
    assert!((tight.parts[1].tension_n.unwrap() - 40.0).abs() < 1e-9);
    assert!((tight.parts[8].tension_n.unwrap() - 48.4).abs() < 1e-9);
    assert!((tight.heard[0].tension_n - 44.2).abs() < 1e-9 && tight.heard.len() == 1, "{:?}", tight.heard);
    assert!(tight.to_string().contains("-72 % of 160.0 N"), "{tight}");
    assert_eq!(Tension::new(&setup, None, &[(2, 60.0), (9, 60.0), (2, 70.0)]), Err(TensionError::Twice(2)));
    // A belt without a wanted tension has no part of it.
    let slack = Setup { params: Params { preload_n: Each::all(0.0), ..Params::default() }, ..setup.clone() };
    let text = Tension::new(&slack, None, &[(2, 60.0)]).unwrap().to_string();
    assert!(text.contains("belt 1:") && !text.contains("inf"), "{text}");
    assert_eq!(Tension::new(&setup, None, &[(15, 60.0)]), Err(TensionError::NoPart(15, 14)));
}

#[test]
fn each_belt_has_its_own_mass_and_tension() {
    let params = Params {
        belt_kg_per_m: Each::listed(&[0.0125, 0.05]).unwrap(),
        preload_n: Each::listed(&[40.0, 90.0]).unwrap(),
        ..Params::default()
    };
    let setup = Setup { params, ..Setup::nominal(Machine::CoreXy, 235.0, 235.0) };
    let found = Tension::new(&setup, None, &[]).unwrap();
    assert_eq!(found.parts.iter().map(|part| part.belt).max(), Some(2));
    for part in found.parts.iter().filter(|part| part.pitch_hz.is_some()) {
        let (mass, tension) = [(0.0125_f64, 40.0_f64), (0.05, 90.0)][part.belt - 1];
        let known = (tension / mass).sqrt() / (2.0 * part.length_mm / 1000.0);
        assert!((part.pitch_hz.unwrap() / known - 1.0).abs() < 1e-12, "{part:?}");
    }
    // At the end of the reach a part has no length, and no pitch.
    let corner = Setup::nominal(Machine::CoreHBot, 40.0, 26.2);
    let short = Tension::new(&corner, None, &[]).unwrap();
    assert!(short.parts.iter().any(|part| part.pitch_hz.is_none()));
}
