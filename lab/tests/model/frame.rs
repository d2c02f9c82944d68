//! The frame: torque of the motors on it, and its vibration on the ground, against two masses on two springs by hand.

use corehbot_lab::queries::compare::Compare;
use corehbot_lab::queries::frame::FrameTorque;
use corehbot_twin::dynamics::plant::{Detail, Plant};
use corehbot_twin::dynamics::state::State;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::{Each, Params};
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::limits::Limits;
use corehbot_twin::queries::resonance::Resonance;
use corehbot_twin::queries::torque::TorqueLimits;
use corehbot_twin::routing::{Machine, Own, Place};
use corehbot_twin::run::Run;
use corehbot_twin::run::report::Report;
use corehbot_twin::steps::{Column, StepTrace};
use std::f64::consts::TAU;

const CENTRE: Place = Place::flat(235.0, 235.0);
const REDUCED: Detail = Detail { idlers: false, rotors: false };

/// Stiffness of the tool of a CoreH-bot in the middle along x and y, in N/mm, computed elsewhere.
const STIFFNESS: [f64; 2] = [287.563, 278.358];

/// Stiffness of the ground's hold on the frame, in N/mm.
const GROUND: [f64; 2] = [400.0, 900.0];

fn agree(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= part * expected.abs()
}

fn soft(frame_damping_ratio: f64) -> Params {
    let frame_stiffness_n_per_mm = Each::listed(&GROUND).unwrap();
    Params { frame_stiffness_n_per_mm, frame_damping_ratio, ..Params::default() }
}

/// The tool (mass m, place X) is on a belt k on the rest (mass M, place f) on the ground k_f. So m X'' = -k (X - f) and
/// M f'' = k (X - f) - k_f f. Of each mode its angular frequency and its part of X - f after a blow on X.
fn two_masses(axis: usize) -> [(f64, f64); 2] {
    let (k, ground) = (STIFFNESS[axis] * 1000.0, GROUND[axis] * 1000.0);
    let (m, big) = [(0.6, 10.0 + 1.2), (1.8, 10.0)][axis];
    let (a, b, c) = (m * big, k * (m + big) + ground * m, k * ground);
    let root = (b * b - 4.0 * a * c).sqrt();
    [b - root, b + root].map(|twice| {
        let square = twice / (2.0 * a);
        // With X - f = 1.
        let f = k / (ground - big * square);
        let part = m * (1.0 + f) / (m * (1.0 + f) * (1.0 + f) + big * f * f);
        (square.sqrt(), part)
    })
}

#[test]
fn a_blow_on_the_tool_rings_in_both_modes_of_two_masses() {
    for axis in [0, 1] {
        let modes = two_masses(axis);
        assert!(agree(modes[0].1 + modes[1].1, 1.0, 1e-9) && modes[0].1 > 0.002, "{modes:?}");
        let plant = Plant::new(Machine::CoreHBot, &soft(0.0).undamped(), CENTRE, REDUCED);
        let mut state = State::at_rest(&plant);
        state.speeds[axis] = 100.0;
        for ms in 1..300 {
            state.advance(&plant, 1e-3);
            let t = f64::from(ms) * 1e-3;
            let expected: f64 = modes.iter().map(|(omega, part)| part * 100.0 / omega * (omega * t).sin()).sum();
            assert!((state.at[axis] - expected).abs() < 1e-3, "axis {axis}, {ms} ms: {} {expected}", state.at[axis]);
        }
        assert!(plant.frame_mm(&state.at)[1 - axis] == 0.0 && plant.frame_mm(&state.at)[axis] != 0.0);
    }
}

#[test]
fn energy_is_kept_and_a_damped_frame_loses_it() {
    for (detail, part) in [(REDUCED, 1e-6), (Detail { idlers: true, rotors: true }, 1e-6)] {
        let at = Place::flat(150.0, 300.0);
        let mut plant = Plant::new(Machine::CoreHBot, &soft(0.0).undamped(), at, detail);
        let mut state = State::at_rest(&plant);
        (state.speeds[0], state.speeds[1]) = (100.0, -60.0);
        plant.send(&state.sent_mm);
        let energy = |state: &State| plant.energy_n_mm(&state.at, &state.speeds, &state.sent_mm);
        let begin = energy(&state);
        state.advance(&plant, 0.3);
        assert!(agree(energy(&state), begin, part), "{detail:?}: {begin} {}", energy(&state));
    }
    // A frame alone: k 400 N/mm, 11.8 kg, 184 rad/s; 10 periods at a ratio of 0.03 leave exp(-2 pi 0.3) of the
    // amplitude.
    let stiff = Params { belt_ea_n: Each::all(1e6), dry_friction_x_n: 0.0, guide_x_n_s_per_m: 0.0, ..soft(0.03) };
    let plant = Plant::new(Machine::CoreHBot, &stiff, CENTRE, REDUCED);
    let mut state = State::at_rest(&plant);
    state.at[2] = 1.0;
    state.advance(&plant, 10.0 * TAU / (400_000.0_f64 / 11.8).sqrt());
    assert!(agree(plant.frame_mm(&state.at)[0], (-TAU * 0.3_f64).exp(), 0.03), "{:?}", plant.frame_mm(&state.at));
}

/// A motor that steps at once pushes tool and frame apart through the belt's damper: their momentum stays 0.
#[test]
fn the_blow_of_a_step_moves_the_frame_back() {
    let mut plant = Plant::new(Machine::CoreHBot, &soft(0.03), CENTRE, REDUCED);
    let mut state = State::at_rest(&plant);
    plant.send(&state.sent_mm);
    state.step(&plant, 0, 0.5);
    let [x, y, frame_x, frame_y] = state.speeds[..4] else { panic!() };
    assert!(x < 0.0 && y > 0.0 && frame_x > 0.0 && frame_y < 0.0, "{:?}", state.speeds);
    assert!((0.6 * x + 11.8 * frame_x).abs() < 1e-12 && (1.8 * y + 11.8 * frame_y).abs() < 1e-12);
}

/// Virtual work: r F_x on an H-bot and a CoreXY, nothing on a closed belt; and J / r for each turn of a rotor.
#[test]
fn the_motors_turn_the_frame_by_the_force_along_x_and_not_on_a_closed_belt() {
    let params = Params::default();
    for tool in [CENTRE, Place::flat(120.0, 330.0)] {
        for (machine, belts, rotors) in
            [(Machine::CoreHBot, 0.0, 0.0), (Machine::HBot, 1.0, 2.0), (Machine::CoreXy, 1.0, 2.0)]
        {
            let [x, y] = FrameTorque::new(machine, &params, tool).unwrap();
            // 0.6 kg: 0.6 N at 6.35 mm.
            assert!((x.belts_mnm - belts * 3.81).abs() < 1e-9 && y.belts_mnm.abs() < 1e-9, "{machine:?} {x:?} {y:?}");
            let rotor = 5.4e-6 / 6.35e-3 * 1000.0;
            assert!((x.rotors_mnm - rotors * rotor).abs() < 1e-9 && y.rotors_mnm.abs() < 1e-9, "{x:?} {y:?}");
            // As printed after equation 38: 2 r dT of F = 2 dT, or 4 r dT of F = 4 dT.
            assert!((x.printed_mnm - 3.81).abs() < 1e-9 && y.printed_mnm == 0.0);
        }
    }
    // Four motors with pulleys of their own do turn it: only at one radius each tension cancels itself.
    let unlike = Params { motor_radius_mm: Each::listed(&[6.35, 5.08, 6.35, 5.08]).unwrap(), ..params };
    let [x, _] = FrameTorque::new(Machine::CoreHBot, &unlike, Place::flat(120.0, 235.0)).unwrap();
    assert!(x.belts_mnm.abs() > 0.01, "{x:?}");
}

/// A trace of a CoreXY's two motors: along x by 10 mm from rest to rest with 3 m/s2.
fn ramps() -> StepTrace {
    let columns = [[1, 1, 0], [1, -1, 0]].map(|row| Column { name: String::new(), row, axis_step: 1.0 });
    let mut trace = StepTrace::new(columns.to_vec(), 0.000_25);
    let ramp = |way: f64| (2.0 * way / 3e3).sqrt();
    for step in 0..40_000 {
        let passed = (f64::from(step) + 0.5) * trace.step_mm;
        let time = if passed < 5.0 { ramp(passed) } else { 2.0 * ramp(5.0) - ramp(10.0 - passed) };
        trace.add((time * 1e7).round() as u64, 0b11, 0b11);
    }
    trace
}

/// The report of a run has the torque, r F of 0.6 kg, where a damper of 0.7 of the critical one leaves little ringing.
#[test]
fn a_run_tells_torque_and_motion_of_the_frame() {
    let trace = ramps();
    let told = |machine: Machine, params: &Params| {
        let run = Run::new(machine, params, Place::flat(230.0, 235.0), REDUCED, &trace).unwrap();
        let watch = run.play(|_| true).unwrap();
        assert!(watch.series.bins.iter().any(|bin| bin.motors_torque_n_mm[1] > 0.0));
        Report::new(machine, "reduced", params, &watch, (trace.duration_s(), 1), 1.0)
    };
    let corexy = told(Machine::CoreXy, &Params { belt_damping_s: 2e-3, ..soft(0.0).undamped() });
    assert!(agree(corexy.frame_torque_nm, 6.35e-3 * 0.6 * 3.0, 0.2), "{corexy:?}");
    // 1.8 N on 400 N/mm are 4.5 um at rest.
    let [x, y] = corexy.frame_mm.unwrap();
    assert!((0.0045..0.02).contains(&x) && y < 0.2 * x, "{x} {y}");
    let rigid = told(Machine::CoreXy, &Params::default());
    assert_eq!(rigid.frame_mm, None);
    assert!(rigid.to_string().contains("torque of all motors on the frame"));
}

#[test]
fn ringing_of_the_frame_counts_in_limits_resonance_and_compare() {
    let setup = Setup { params: soft(0.03), ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let limits = Limits::new(&setup, 0.025, 0.5).unwrap();
    let rigid = Limits::new(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), 0.025, 0.5).unwrap();
    let resonance = Resonance::new(&setup, 3, 3).unwrap();
    let frame = resonance.frame.unwrap();
    let all = [(limits.x, rigid.x, frame[0]), (limits.y, rigid.y, frame[1])];
    for (axis, (found, rigid, frame)) in all.into_iter().enumerate() {
        let modes = two_masses(axis);
        let over = |power: i32| modes.iter().map(|(omega, part)| part / omega.powi(power)).sum::<f64>();
        assert!(agree(found.speed_jump_mm_s, 0.025 / over(1), 1e-3), "{found:?} {modes:?}");
        assert!(agree(found.ringing_acceleration_mm_s2, 0.0125 / over(2), 1e-3), "{found:?} {modes:?}");
        assert!(agree(found.torque_acceleration_mm_s2, rigid.torque_acceleration_mm_s2, 1e-9), "{found:?}");
        // Parts over the square of their frequency add up to m / k: the tool's lag does not know of the frame.
        assert!(agree(found.ringing_acceleration_mm_s2, rigid.ringing_acceleration_mm_s2, 1e-3));
        assert!(agree(frame.band_hz[0], modes[0].0 / TAU, 0.01) && agree(frame.part, modes[0].1, 0.02), "{frame:?}");
        // The ratio of the frame alone, 0.03, changes little by the belt.
        assert!((0.02..0.05).contains(&frame.damping_ratio), "{frame:?}");
        assert!(frame.left_by_shaper.is_some_and(|left| left > 0.2), "{frame:?}");
    }
    // 0.6 N on 400 N/mm, 1.8 N on 900 N/mm.
    let [x, y] = limits.frame_um_per_m_s2.unwrap();
    assert!(agree(x, 1.5, 1e-9) && agree(y, 2.0, 1e-9));
    let compared = Compare::new(&setup.params, setup.freedom, None, [3, 3], 5.0).unwrap();
    let [core, ..] = &compared.machines[..] else { panic!() };
    let [x, y] = core.frame_modes_hz.unwrap();
    assert!(agree(x, frame[0].band_hz[0], 0.02) && agree(y, frame[1].band_hz[0], 0.02), "{core:?}");
    assert!(core.first_mode_hz[0] < 30.0 && compared.to_string().contains("frame in x / y, Hz"));
    let text = [limits.to_string(), resonance.to_string()].concat();
    assert!(text.contains("the frame gives way by 1.5 um") && text.contains("frame in x"), "{text}");
}

/// Every routing has limits and frequencies of all axes that its belts move.
#[test]
fn limits_and_resonance_know_every_routing() {
    let own = |rows: &[[i8; 3]]| Machine::Own(Own::new(rows, false).unwrap());
    let cartesian = own(&[[1, 0, 0], [0, 1, 0]]);
    let corexz = own(&[[1, 0, 1], [1, 0, -1], [0, 1, 0]]);
    let others = [cartesian, own(&[[1, 0, 0], [0, 1, 0], [0, -1, 0]]), corexz];
    let params = Params::default();
    for machine in Machine::ALL.into_iter().chain(others) {
        let tool = workspace(machine, &params).centre();
        let setup = Setup { machine, params: params.clone(), tool, freedom: Default::default() };
        let limits = Limits::new(&setup, 0.025, 1.0).unwrap();
        let found = Resonance::new(&setup, 3, 3).unwrap();
        assert_eq!((limits.z.is_some(), found.z.is_some()), (machine.lifts(), machine.lifts()), "{machine:?}");
        let moving_bed = machine == corexz;
        assert_eq!((limits.yaw_error_um_per_m_s2.is_none(), found.yaw.is_none()), (moving_bed, moving_bed));
        for axis in [Some(limits.x), Some(limits.y), limits.z].into_iter().flatten() {
            let all = [axis.torque_acceleration_mm_s2, axis.slack_acceleration_mm_s2, axis.speed_jump_mm_s];
            assert!(all.into_iter().all(|v| v > 1.0 && v.is_finite()), "{machine:?}: {axis:?}");
        }
        // The table of torque at speed begins with the same figures.
        let table = TorqueLimits::new(machine, &params, 0.0, 300.0).unwrap();
        for (name, axis) in [("x", Some(limits.x)), ("y", Some(limits.y)), ("z", limits.z)] {
            let of = table.directions.iter().find(|of| of.direction == name).and_then(|of| of.acceleration_mm_s2[0]);
            assert_eq!(of, axis.map(|axis| axis.torque_acceleration_mm_s2), "{machine:?}");
        }
        let text = [limits.to_string(), found.to_string()].concat();
        assert_eq!(text.contains("the firmware has no shaper for z"), machine.lifts(), "{text}");
    }
    // Motors of 63 N move a mass, its friction and rotors of 0.134 kg. All four of a CoreXYZ move the 3.8 kg that go
    // up, evenly in the middle and a little less so at the worst place.
    let (force, rotor) = (400.0 / 6.35, 5.4e-6 / (6.35e-3 * 6.35e-3));
    let limits = |machine: Machine| {
        let tool = workspace(machine, &params).centre();
        Limits::new(&Setup { machine, params: params.clone(), tool, freedom: Default::default() }, 0.025, 1.0).unwrap()
    };
    let up = limits(Machine::CoreXyz).z.unwrap().torque_acceleration_mm_s2;
    let part = up / (4.0 * force / (3.8 + 4.0 * rotor) * 1e3);
    assert!(part > 0.9 && part < 0.95, "{up} {part}");
    // One motor for each axis of a Cartesian machine, and its energy alone: 2 F times 0.127 mm.
    let alone = limits(cartesian);
    assert!(agree(alone.x.torque_acceleration_mm_s2, (force - 0.5) / (0.6 + rotor) * 1e3, 1e-9), "{alone:?}");
    let jump = (2.0 * 2.0 * force * 0.127 * 1e3 / (0.6 + rotor)).sqrt();
    assert!(agree(alone.x.slip_jump_mm_s, jump, 1e-9), "{alone:?} {jump}");
    // The bed of a CoreXZ, 1 kg, on its own belt.
    let bed = limits(corexz).y.torque_acceleration_mm_s2;
    assert!(agree(bed, (force - 1.0) / (1.0 + rotor) * 1e3, 1e-9), "{bed}");
}
