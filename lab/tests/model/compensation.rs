//! Compensated steps keep the tool on the line that was meant, also if the machine is not quite as stiff as believed.

use corehbot_lab::compensation::{CompensationError, compensate};
use corehbot_twin::dynamics::plant::Detail;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::Run;
use corehbot_twin::steps::{Column, StepTrace};

const START: Place = Place::flat(220.0, 220.0);
const STEP_MM: f64 = 0.0125;

/// Columns of a CoreH-bot, and one that has no part in x and y.
const ROWS: [[i8; 2]; 5] = [[-1, 1], [-1, -1], [1, -1], [1, 1], [0, 0]];

/// How far a move from rest to rest is after a time, in mm, and whether it is over.
fn ramp(length: f64, speed: f64, acceleration: f64, time: f64) -> (f64, bool) {
    let rise = speed / acceleration;
    let cruise = length / speed - rise;
    let left = 2.0 * rise + cruise - time;
    match time {
        t if t < rise => (acceleration * t * t / 2.0, false),
        t if t < rise + cruise => (speed * (t - rise / 2.0), false),
        _ if left > 0.0 => (length - acceleration * left * left / 2.0, false),
        _ => (length, true),
    }
}

/// A square of 20 mm, each side at 200 mm/s by 20 m/s^2, looked at each 10 us; the fifth motor steps at each corner.
fn square() -> StepTrace {
    let columns = ROWS.map(|[x, y]| Column { name: String::new(), row: [x, y, 0], axis_step: 1.0 }).to_vec();
    let mut trace = StepTrace::new(columns, STEP_MM);
    let mut counts = [0_i64; 4];
    let mut tick = 0;
    for (corner, along) in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].into_iter().enumerate() {
        let from = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]][corner];
        trace.add(tick, 16, 16);
        for look in 0.. {
            tick += 100;
            let (way, is_over) = ramp(20.0, 200.0, 20_000.0, f64::from(look) * 1e-5);
            let at = [0, 1].map(|i| (from[i] + way * along[i]) / STEP_MM);
            let (mut steps, mut forward) = (0, 0);
            for (motor, (count, row)) in counts.iter_mut().zip(ROWS).enumerate() {
                let away = f64::from(row[0]) * at[0] + f64::from(row[1]) * at[1] - *count as f64;
                if away.abs() > 0.5 {
                    *count += away.signum() as i64;
                    steps |= 1 << motor;
                    forward |= u8::from(away > 0.0) << motor;
                }
            }
            if steps != 0 {
                trace.add(tick, steps, forward);
            }
            if is_over && steps == 0 {
                break;
            }
        }
    }
    trace
}

const ROTORS: Detail = Detail { idlers: false, rotors: true };

/// RMS of the error in um, on the nominal machine with rotors.
fn rms_um(steps: &StepTrace, meant: &StepTrace, params: &Params) -> f64 {
    rms_um_of(ROTORS, steps, meant, params)
}

fn rms_um_of(detail: Detail, steps: &StepTrace, meant: &StepTrace, params: &Params) -> f64 {
    let run = Run::new(Machine::CoreHBot, params, START, detail, steps).unwrap().against(meant).unwrap();
    1000.0 * run.play(|_| true).unwrap().contour.rms_mm()
}

fn believed(stiffness: f64) -> Params {
    let nominal = Params::default();
    Params {
        belt_ea_n: nominal.belt_ea_n.times(stiffness),
        holding_torque_nm: stiffness * nominal.holding_torque_nm,
        ..nominal
    }
}

fn last(trace: &StepTrace) -> [i64; 8] {
    trace.counted().last().unwrap().1
}

#[test]
fn the_error_of_a_square_becomes_a_third_and_with_wrong_stiffness_a_half() {
    let meant = square();
    let before = rms_um(&meant, &meant, &Params::default());
    let after = [1.0, 0.8, 1.2].map(|stiffness| {
        let bent = compensate(Machine::CoreHBot, &believed(stiffness), START, &meant, 0.001).unwrap();
        assert_eq!(last(&bent.steps), last(&meant), "all motors end where they were meant to");
        rms_um(&bent.steps, &meant, &Params::default())
    });
    assert!(before > 5.0, "{before}");
    assert!(after[0] < before / 3.0 && after[1] < before / 2.0 && after[2] < before / 2.0, "{before} {after:?}");
}

/// The lead knows nothing of the idlers' inertia.
#[test]
fn idlers_with_mass_leave_the_error_of_a_square_at_a_third() {
    let meant = square();
    let bent = compensate(Machine::CoreHBot, &believed(1.0), START, &meant, 0.001).unwrap();
    let full = Detail { idlers: true, ..ROTORS };
    let [before, after] = [&meant, &bent.steps].map(|steps| rms_um_of(full, steps, &meant, &Params::default()));
    assert!(after < before / 3.0, "{before} {after}");
}

/// M a / K in the middle of the reach: 0.6 kg and 1.8 kg by 20 m/s^2 on 251.2 and 244.1 N/mm (docs/research/twin.md),
/// without friction.
#[test]
fn the_tool_is_sent_ahead_by_what_inertia_takes() {
    let smooth = believed(1.0).undamped();
    let bent = compensate(Machine::CoreHBot, &smooth, START, &square(), 0.001).unwrap();
    for (ahead, expected) in bent.ahead_mm.into_iter().zip([0.6 * 20.0 / 251.2, 1.8 * 20.0 / 244.1]) {
        // Between two sides braking and setting off do not add up; smoothing leaves 1 % of ripple.
        assert!((ahead / expected - 1.0).abs() < 0.08, "{ahead} {expected}");
    }
}

/// On a machine that gives way fifty times less there is next to nothing to add, and the steps are those that were.
#[test]
fn a_rigid_machine_is_left_alone() {
    let meant = square();
    let rigid = believed(50.0);
    let bent = compensate(Machine::CoreHBot, &rigid, START, &meant, 0.001).unwrap();
    assert!(bent.ahead_mm.iter().all(|mm| *mm < 0.004), "{:?}", bent.ahead_mm);
    let (before, after) = (rms_um(&meant, &meant, &rigid), rms_um(&bent.steps, &meant, &rigid));
    assert!((after - before).abs() < 0.3, "{before} {after}");
}

/// Motors at 125,000 steps/s, a trace of more than an hour, and one that leaves the reach: told, and nothing is made.
#[test]
fn what_cannot_be_compensated_is_refused() {
    let compensated = |trace: &StepTrace, start| compensate(Machine::CoreHBot, &believed(1.0), start, trace, 0.001);
    let mut fast = StepTrace::new(square().columns, square().step_mm);
    (0..4000).for_each(|i| fast.add(1_000_000 + 80 * i, 0b1, 0b1));
    assert!(matches!(compensated(&fast, START), Err(CompensationError::TooFast(s)) if (0.09..0.2).contains(&s)));
    let mut long = StepTrace::new(square().columns, square().step_mm);
    long.add(36_001 * 1_000_000, 0b1, 0b1);
    assert_eq!(compensated(&long, START), Err(CompensationError::TooLong(3600.1)));
    let beyond = compensated(&square(), Place { x: 425.0, ..START });
    assert!(matches!(beyond, Err(CompensationError::OutOfReach { .. })), "{beyond:?}");
}

/// The bar's yaw at the left end of the reach, at 10 m/s^2 along y: the whole of it, and the rest after a compensation
/// by a stiffness that is 20 % off. The exact inverse would ring for ever at one frequency, as the guides hardly damp
/// it. With the tool held on its line y is -arm psi, so the equation of psi becomes
/// `(M_pp - arm M_py) psi'' + k psi = 0`.
#[test]
fn yaw_can_be_met_at_rest_but_not_faster_than_the_bar_yaws_by_itself() {
    let params = Params::default();
    let at = Place::flat(40.0, 235.0);
    let arm = at.x - params.width_mm / 2.0;
    let elastic = Elastic::new(Machine::CoreHBot, &params, at, Freedom { yaw: true, ..Freedom::default() });
    let [y, yaw] = [Coordinate::Y, Coordinate::Yaw].map(|c| elastic.links.index(c).unwrap());
    let stiffness = params.bar_yaw_stiffness_nm_per_rad * 1000.0;
    // kg mm/s^2 are mN.
    let error_mm = 10_000.0 * elastic.mass[(y, yaw)] / 1000.0 / stiffness * arm;
    assert!((error_mm - 0.114_08).abs() < 1e-4, "{error_mm}");
    let left = [0.8, 1.2].map(|believed| (error_mm - error_mm / believed).abs());
    assert!((left[0] - 0.028_52).abs() < 1e-4 && (left[1] - 0.019_01).abs() < 1e-4, "{left:?}");
    let inertia = elastic.mass[(yaw, yaw)] - arm * elastic.mass[(y, yaw)];
    let hz = (stiffness * 1000.0 / inertia).sqrt() / std::f64::consts::TAU;
    assert!((hz - 47.89).abs() < 0.01, "{hz}");
}
