//! Machines of every routing, and numbers of single belts and motors, against figures by hand.

use corehbot_twin::geometry::{layout, workspace};
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::model::ways::{Ways, residual_mm};
use corehbot_twin::params::{Each, Params};
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::push::Push;
use corehbot_twin::queries::stiffness::Stiffness;
use corehbot_twin::routing::{Machine, Own, Place};
use corehbot_twin::solve::balance::condensed;
use corehbot_twin::solve::modes::modes;

const EA: f64 = 30_000.0;
const W: f64 = 470.0;
const R: f64 = 6.35;

fn near(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= part * expected.abs().max(1e-9)
}

/// Stiffness of the tool along x, y and (if belts lift it) z.
fn stiffness(machine: Machine, params: &Params, tool: Place) -> Vec<Vec<f64>> {
    let elastic = Elastic::new(machine, params, tool, Freedom::default());
    let tool: Vec<usize> = Coordinate::TOOL.into_iter().filter_map(|axis| elastic.links.index(axis)).collect();
    let k = condensed(&elastic, &tool).unwrap();
    (0..tool.len()).map(|i| (0..tool.len()).map(|j| k[(i, j)]).collect()).collect()
}

fn own(rows: &[[i8; 3]]) -> Machine {
    Machine::Own(Own::new(rows, false).unwrap())
}

fn ways(machine: Machine) -> Vec<[i8; 3]> {
    Ways::new(machine, &Params::default()).rows.iter().map(|row| row.map(|way| way.round() as i8)).collect()
}

/// Carlyle's table: A (1, 1, 1), B (1, -1, 1), C (-1, -1, 1), D (-1, 1, 1).
#[test]
fn the_motors_of_a_corexyz_turn_as_in_carlyles_table() {
    let [a, b, c, d] = [[1, 1, 1], [1, -1, 1], [-1, -1, 1], [-1, 1, 1]];
    assert_eq!(Machine::CoreXyz.motors(), [1, 4, 8, 11]);
    assert_eq!(ways(Machine::CoreXyz), [d, c, b, a]);
    assert_eq!(ways(Machine::CoreXyzThree), [c, b, a]);
    // A - B + C - D.
    assert_eq!(residual_mm(Machine::CoreXyz, &[0.0, 0.0, 0.0, 0.25]), Some(0.25));
    assert_eq!(residual_mm(Machine::CoreXyz, &[1.0, 1.0, 0.0, 0.0]), Some(0.0));
    assert_eq!(residual_mm(Machine::CoreXyzThree, &[1.0, 2.0, 3.0]), None);
    // X = (B - C) / 2, Y = (A - B) / 2, Z = (A + C) / 2, from turns in the order C, B, A.
    let three = Ways::new(Machine::CoreXyzThree, &Params::default());
    let tool = three.tool(&[-3.0, 1.0, 5.0]);
    assert!(tool.into_iter().zip([2.0, 2.0, 1.0]).all(|(found, expected)| near(found, expected, 1e-9)), "{tool:?}");
}

/// Free lengths of a CoreXYZ's belt in the middle. The way out to the motor is W/2 along each axis, less e/2 and four
/// radii at two pulleys. The way back is three edges and W/2 along each axis, less e/2 and ten radii at five pulleys.
#[test]
fn four_belts_hold_a_corexyz_alike_in_all_directions() {
    let [out, back] = [1.5 * W - 40.0 - 4.0 * R, 4.5 * W - 40.0 - 10.0 * R];
    let belt = EA * (1.0 / out + 1.0 / back);
    let (params, middle) = (Params::default(), Place::of_xyz([235.0; 3]));
    // Up to the motor's axis, and down to where two quarters of a turn meet.
    let reach = workspace(Machine::CoreXyz, &params);
    assert!(near(reach.z[0], 2.0 * R, 1e-9) && near(reach.z[1], W - R, 1e-9), "{reach:?}");
    let k = stiffness(Machine::CoreXyz, &params, middle);
    for (i, row) in k.iter().enumerate() {
        for (j, k) in row.iter().enumerate() {
            let expected = if i == j { 4.0 * belt } else { 0.0 };
            assert!((k - expected).abs() < 1e-6, "{i} {j}: {k} {expected}");
        }
    }
    // 4 K of 61.8 N/mm: 102.2, 59.0 and 40.6 Hz with 0.6, 1.8 and 3.8 kg.
    let modes = modes(&Elastic::new(Machine::CoreXyz, &params, middle, Freedom::default())).unwrap();
    let found: Vec<f64> = modes.iter().map(|mode| mode.frequency_hz).collect();
    let hz = |kg: f64| (4.0 * belt * 1000.0 / kg).sqrt() / std::f64::consts::TAU;
    assert!(found.iter().zip([hz(3.8), hz(1.8), hz(0.6)]).all(|(f, e)| near(*f, e, 1e-9)), "{found:?}");
}

/// With three motors the fourth belt runs round: the tool is held by the sum of three products of rows.
#[test]
fn three_motors_couple_the_axes_of_a_corexyz() {
    let belt = EA * (1.0 / (1.5 * W - 40.0 - 4.0 * R) + 1.0 / (4.5 * W - 40.0 - 10.0 * R));
    let params = Params::default();
    let k = stiffness(Machine::CoreXyzThree, &params, Place::of_xyz([235.0; 3]));
    let expected = [[3.0, 1.0, 1.0], [1.0, 3.0, -1.0], [1.0, -1.0, 3.0]];
    for (row, expected) in k.iter().zip(expected) {
        assert!(row.iter().zip(expected).all(|(k, times)| (k - times * belt).abs() < 1e-6), "{k:?}");
    }
    // The answers have z. The inverse of the matrix is (2, -1, -1; ...) over 4 belts.
    let setup =
        Setup { machine: Machine::CoreXyzThree, params, tool: Place::of_xyz([235.0; 3]), freedom: Freedom::default() };
    let told = Stiffness::new(&setup).unwrap();
    assert!(near(told.kxz.unwrap(), belt, 1e-9) && near(told.kyz.unwrap(), -belt, 1e-9), "{told}");
    let pushed = Push::new(&setup, [5.0, 0.0]).unwrap().strain;
    let moved = [pushed.dx_mm, pushed.dy_mm, pushed.dz_mm.unwrap()];
    let expected = [2.0, -1.0, -1.0].map(|times| times * 5.0 / (4.0 * belt));
    assert!(moved.iter().zip(expected).all(|(mm, expected)| near(*mm, expected, 1e-9)), "{moved:?} {expected:?}");
}

/// A Cartesian machine: K of an axis is EA (1/L1 + 1/L2) of its own belt, with the motor at the far end.
#[test]
fn belts_of_their_own_hold_one_axis_each() {
    let (params, at) = (Params::default(), Place::flat(150.0, 300.0));
    let cartesian = own(&[[1, 0, 0], [0, 1, 0]]);
    assert_eq!(ways(cartesian), [[1, 0, 0], [0, 1, 0]]);
    let k = stiffness(cartesian, &params, at);
    // The clamps are e and d apart.
    let x = EA * (1.0 / (W - 150.0 - 40.0) + 1.0 / (W + 150.0 - 40.0));
    let y = EA * (1.0 / (W - 300.0 - 26.2) + 1.0 / (W + 300.0 - 26.2));
    assert!(near(k[0][0], x, 1e-9) && near(k[1][1], y, 1e-9) && k[0][1].abs() < 1e-9, "{k:?} {x} {y}");
    // A second motor for y doubles it, and the two can strain it.
    let dual = own(&[[1, 0, 0], [0, 1, 0], [0, -1, 0]]);
    let twice = stiffness(dual, &params, at);
    let mirrored = EA * (1.0 / (300.0 - 26.2) + 1.0 / (2.0 * W - 300.0 - 26.2));
    assert!(near(twice[1][1], y + mirrored, 1e-9), "{twice:?}");
    assert_eq!(residual_mm(dual, &[0.0, 1.0, 1.0]), Some(2.0));
    // Belts on both sides hold the bar square, one in the middle does not.
    let yaw = |machine: Machine| {
        let loose = Params { bar_yaw_stiffness_nm_per_rad: 0.0, ..Params::default() };
        let elastic = Elastic::new(machine, &loose, at, Freedom { yaw: true, ..Freedom::default() });
        let index = elastic.links.index(Coordinate::Yaw).unwrap();
        elastic.stiffness[(index, index)] / 1000.0
    };
    assert!(yaw(cartesian).abs() < 1e-9);
    assert!(near(yaw(dual), (y + mirrored) * 235.0 * 235.0 / 1000.0, 1e-9));
}

/// CoreXZ: the head in x and z on two belts, the bed in y on its own.
#[test]
fn a_corexz_stands_up_and_its_bed_moves() {
    let machine = own(&[[1, 0, 1], [1, 0, -1], [0, 1, 0]]);
    let params = Params::default();
    let k = stiffness(machine, &params, Place::of_xyz([235.0; 3]));
    // Out: W/2 - e/2 - r and H/2 - r; back: H - r, W - 2 r, H/2 - 2 r, W/2 - e/2 - r.
    let belt = EA * (1.0 / (W - 40.0 - 2.0 * R) + 1.0 / (3.0 * W - 40.0 - 6.0 * R));
    assert!(near(k[0][0], 2.0 * belt, 1e-9) && near(k[2][2], 2.0 * belt, 1e-9) && k[0][2].abs() < 1e-9, "{k:?}");
    let masses = machine.masses_kg(&params);
    assert!(masses.into_iter().zip([0.6, 1.0, 1.8]).all(|(found, kg)| near(found, kg, 1e-12)), "{masses:?}");
}

/// Each belt has its own stiffness, and belt outside the reach makes a span longer.
#[test]
fn belts_differ_and_run_outside() {
    let at = Place::flat(235.0, 235.0);
    // CoreXY: belts A (1, 1) and B (1, -1) have equal lengths in the middle.
    let nominal = stiffness(Machine::CoreXy, &Params::default(), at);
    let unlike = Params { belt_ea_n: Each::listed(&[20_000.0, 40_000.0]).unwrap(), ..Params::default() };
    let k = stiffness(Machine::CoreXy, &unlike, at);
    assert!(near(k[0][0], nominal[0][0], 1e-9) && near(k[1][1], nominal[1][1], 1e-9));
    // kA - kB: a third of the sum, negative.
    assert!(near(k[0][1], -nominal[0][0] / 3.0, 1e-9), "{k:?}");
    // A CoreH-bot with 200 mm more belt beyond its right side: Kxx = 4 EA (1/LR + 1/LL).
    let outside = Params { outside_mm: Each::listed(&[0.0, 200.0, 0.0, 0.0]).unwrap(), ..Params::default() };
    let side = W - 4.0 * R - 80.0 + W;
    let k = stiffness(Machine::CoreHBot, &outside, at);
    assert!(near(k[0][0], 4.0 * EA * (1.0 / (side + 200.0) + 1.0 / side), 1e-9), "{k:?}");
    let [with, without] = [&outside, &Params::default()].map(|p| layout(Machine::CoreHBot, p, at).belt_lengths_mm[0]);
    assert!(near(with - without, 200.0, 1e-9));
    // A preload of each belt.
    let tight = Params { preload_n: Each::listed(&[40.0, 55.0]).unwrap(), ..Params::default() };
    let plant = corehbot_twin::dynamics::plant::Plant::new(Machine::CoreXy, &tight, at, Default::default());
    assert_eq!(plant.tensions(&[]).collect::<Vec<_>>(), [40.0, 40.0, 55.0, 55.0]);
}

/// A small pulley on one motor: stiffer field and heavier rotor at the belt, by the square of the radii.
#[test]
fn motors_with_pulleys_of_two_sizes_differ_at_the_belt() {
    let params = Params { motor_radius_mm: Each::listed(&[6.35, 5.08]).unwrap(), ..Params::default() };
    let freedom = Freedom { rotors: true, ..Freedom::default() };
    let elastic = Elastic::new(Machine::CoreXy, &params, Place::flat(235.0, 235.0), freedom);
    let [first, second] = [1, 4].map(|number| elastic.links.index(Coordinate::Motor(number)).unwrap());
    for matrix in [&elastic.mass, &nalgebra::DMatrix::from_diagonal(&elastic.held_by.clone().into())] {
        assert!(near(matrix[(second, second)] / matrix[(first, first)], 1.25 * 1.25, 1e-12));
    }
    let at = Setup { params, freedom, ..Setup::nominal(Machine::CoreXy, 235.0, 235.0) };
    // The two belts in series with their fields: 99.05 N/mm each, 496.06 and 775.10 N/mm.
    let belt = stiffness(Machine::CoreXy, &Params::default(), Place::flat(235.0, 235.0))[0][0] / 2.0;
    let series = |field: f64| 1.0 / (1.0 / belt + 1.0 / field);
    let found = Stiffness::new(&at).unwrap();
    let (a, b) = (series(20_000.0 / (6.35 * 6.35)), series(20_000.0 / (5.08 * 5.08)));
    assert!(near(found.kxx, a + b, 1e-3) && near(found.kxy, a - b, 0.05), "{found:?} {a} {b}");
}

/// Equation 8 of the CoreH-bot paper with four radii: motors with pulleys of 20, 16, 40 and 32 teeth make 80, 100, 40
/// and 50 steps for a mm of belt. Each turns by its own row over its own radius, and the tool comes to its place. With
/// the same radius on all of them, the same steps would strain the belt and lead elsewhere.
#[test]
fn four_pulleys_of_four_sizes_pull_the_tool_to_its_place() {
    use corehbot_twin::dynamics::plant::Detail;
    use corehbot_twin::run::Run;
    use corehbot_twin::steps::{Column, StepTrace};
    let rows = [[-8, 8, 0], [-10, -10, 0], [4, -4, 0], [5, 5, 0]];
    let columns = rows.map(|row| Column { name: String::new(), row, axis_step: 1.0 });
    let mut trace = StepTrace::new(columns.to_vec(), 0.1);
    // x goes by 4 mm and y by 1 mm in 0.5 s: (-3, -5, 3, 5) mm of belt, each motor evenly in its own steps.
    let belts = [-3.0_f64, -5.0, 3.0, 5.0];
    let mut events: Vec<(u64, usize)> = Vec::new();
    for (motor, (belt, per_mm)) in belts.into_iter().zip([80.0, 100.0, 40.0, 50.0]).enumerate() {
        let steps = (belt.abs() * per_mm) as u64;
        events.extend((0..steps).map(|step| ((2 * step + 1) * 5_000_000 / (2 * steps), motor)));
    }
    events.sort_unstable();
    for (tick, motor) in events {
        trace.add(tick, 1 << motor, 0b1100);
    }
    let start = Place::flat(200.0, 200.0);
    let played = |params: &Params| {
        let detail = Detail { idlers: false, rotors: true };
        Run::new(Machine::CoreHBot, params, start, detail, &trace).unwrap().play(|_| true).unwrap()
    };
    let radii = [20.0, 16.0, 40.0, 32.0].map(|teeth| teeth / std::f64::consts::PI);
    for radii in [Each::NONE, Each::listed(&radii).unwrap()] {
        let watch = played(&Params { motor_radius_mm: radii, ..Params::default() });
        let [x, y] = watch.contour.vertices.last().unwrap().at;
        assert!((x - 204.0).abs() < 1e-6 && (y - 201.0).abs() < 1e-6, "{x} {y}");
        assert!(watch.contour.greatest_mm < 0.1 && watch.residual_mm < 0.1, "{}", watch.residual_mm);
        assert!(watch.motors.iter().all(|motor| motor.slips == 0));
    }
    // 20 teeth everywhere: 3, 6.25, 1.5 and 3.125 mm. x is a quarter of 3 + 6.25 + 1.5 + 3.125, y of -3 + 6.25 - 1.5
    // + 3.125, and equation 11 is off by -3 + 6.25 + 1.5 - 3.125.
    let same = played(&Params { motor_radius_mm: Each::all(20.0 / std::f64::consts::PI), ..Params::default() });
    let [x, y] = same.contour.vertices.last().unwrap().at;
    assert!((x - 200.0 - 13.875 / 4.0).abs() < 1e-6 && (y - 200.0 - 4.875 / 4.0).abs() < 1e-6, "{x} {y}");
    assert!((same.commanded_residual_mm - 1.625).abs() < 0.05, "{}", same.commanded_residual_mm);
}

/// Two motors in series share the supply, so torque falls at half the speed: the paper's machine.
#[test]
fn motors_in_series_share_the_supply() {
    use corehbot_twin::torque::pull_out::pull_out_torque_nm;
    let series = Params { motors_in_series: 2.0, ..Params::default() };
    let halved = Params { supply_v: 12.0, ..Params::default() };
    for speed in [0.0, 20.0, 60.0, 150.0] {
        assert_eq!(pull_out_torque_nm(&series, speed), pull_out_torque_nm(&halved, speed));
    }
}

/// A given inertia takes the place of the slender bar's 0.0221 kg m2.
#[test]
fn the_bar_yaws_with_its_own_inertia() {
    let yaw = |inertia: Option<f64>| {
        let params = Params { bar_yaw_inertia_kg_m2: inertia, ..Params::default() };
        let freedom = Freedom { yaw: true, ..Freedom::default() };
        let elastic = Elastic::new(Machine::CoreHBot, &params, Place::flat(235.0, 235.0), freedom);
        modes(&elastic).unwrap()[0].frequency_hz
    };
    let hz = |inertia: f64| (2000.0 / inertia).sqrt() / std::f64::consts::TAU;
    // The belts' own stiffness against yaw is 0 without preload's part.
    assert!(near(yaw(None), hz(1.2 * 0.47 * 0.47 / 12.0), 1e-6) && near(yaw(None), 47.9, 0.01));
    assert!(near(yaw(Some(0.03)), hz(0.03), 1e-6));
}

/// Two masses on two springs: k and m of the tool on its belt, k_f and M of the frame on the ground. In absolute places
/// w^2 is a root of `m M s^2 - (k (m + M) + k_f m) s + k k_f`, with the bar as a part of M in x.
#[test]
fn a_soft_frame_has_a_mode_of_its_own() {
    let soft = Params { frame_stiffness_n_per_mm: Each::listed(&[200.0, 400.0]).unwrap(), ..Params::default() };
    let at = Place::flat(235.0, 235.0);
    let found = modes(&Elastic::new(Machine::CoreHBot, &soft, at, Freedom::default())).unwrap();
    let rigid = stiffness(Machine::CoreHBot, &Params::default(), at);
    let mut expected = Vec::new();
    for (k, frame, m, big) in [(rigid[0][0], 200.0, 0.6, 10.0 + 1.2), (rigid[1][1], 400.0, 1.8, 10.0)] {
        let (a, b, c) = (m * big, (k * (m + big) + frame * m) * 1000.0, k * frame * 1e6);
        let root = (b * b - 4.0 * a * c).sqrt();
        expected.extend([b - root, b + root].map(|s| (s / (2.0 * a)).sqrt() / std::f64::consts::TAU));
    }
    expected.sort_by(f64::total_cmp);
    let found: Vec<f64> = found.iter().map(|mode| mode.frequency_hz).collect();
    assert!(found.len() == 4 && found.iter().zip(&expected).all(|(f, e)| near(*f, *e, 1e-9)), "{found:?} {expected:?}");
}
