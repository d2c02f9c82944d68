//! Parts that fail in a running machine: a jumped tooth, broken cords, a seized idler, a loose pulley. Against numbers
//! by hand.

use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Own, Place};
use corehbot_twin::stepped_machine::Live;
use corehbot_twin::stepped_machine::failing::idlers_of;

const MS: u64 = 10_000;

/// Guides without dry friction, belts that no span leaves slack, and motors that hardly give way: so many times
/// the current, at the same losses.
fn stiff(times: f64) -> Params {
    let dry = Params { dry_friction_x_n: 0.0, dry_friction_y_n: 0.0, dry_friction_z_n: 0.0, ..Params::default() };
    Params {
        holding_torque_nm: times * dry.holding_torque_nm,
        run_current_a: times * dry.run_current_a,
        phase_resistance_ohm: dry.phase_resistance_ohm / times,
        preload_n: 400.0.into(),
        phase_inductance_mh: dry.phase_inductance_mh / times,
        ..dry
    }
}

/// One belt along x and one along y.
fn straight() -> Machine {
    Machine::Own(Own::new(&[[1, 0, 0], [0, 1, 0]], false).unwrap())
}

/// A machine that holds its tool in the middle.
fn holding(machine: Machine, params: &Params, idlers: &[usize]) -> Live {
    let middle =
        [params.width_mm / 2.0, params.depth_mm / 2.0, if machine.lifts() { params.height_mm / 2.0 } else { 0.0 }];
    let motors = machine.motors().len();
    let step_mm = vec![params.full_step_mm(0) / 256.0; motors];
    let mut live = Live::new(machine, params, Place::of_xyz(middle), &step_mm, &[], 0).with_idlers(idlers);
    (0..motors).for_each(|motor| live.give(motor, 1.0));
    live.advance(100 * MS);
    live
}

fn off(live: &Live) -> [f64; 3] {
    let (tool, meant) = (live.tool().xyz(), live.stepped_to().xyz());
    [0, 1, 2].map(|axis| tool[axis] - meant[axis])
}

fn wait(live: &mut Live, ms: u64) {
    live.advance(live.now() + ms * MS);
}

/// A tooth is 2 mm. Where motors are as many as axes, the tool goes by the inverse of the motors' rows; where they are
/// more, the belt shares it out and keeps the rest as strain.
#[test]
fn a_jumped_tooth_moves_the_tool_by_the_column_of_its_motor() {
    let cases: [(Machine, &[[f64; 3]]); 6] = [
        (Machine::CoreHBot, &[[-0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0]]),
        (Machine::HBot, &[[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]]),
        (Machine::CoreXy, &[[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]]),
        (Machine::CoreXyz, &[[-0.5, 0.5, 0.5], [-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5]]),
        // Motors C, B, A of -x - y + z, x - y + z, x + y + z: half a sum of two of them is y + z or z - y, and so on.
        (Machine::CoreXyzThree, &[[-1.0, 0.0, 1.0], [1.0, -1.0, 0.0], [0.0, 1.0, 1.0]]),
        (straight(), &[[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]),
    ];
    for (machine, columns) in cases {
        assert_eq!(machine.motors().len(), columns.len());
        for (motor, column) in columns.iter().enumerate() {
            for teeth in [1.0, -1.0].into_iter().take(if motor == 0 { 2 } else { 1 }) {
                // A motor that has the tool alone must bear all of a sudden pull.
                let times = if columns.len() == 2 { 50.0 } else { 10.0 };
                let mut live = holding(machine, &stiff(times), &[]);
                live.jump(motor, teeth);
                wait(&mut live, if machine.lifts() { 2000 } else { 700 });
                let off = off(&live);
                let is_right = off.iter().zip(column).all(|(off, mm)| (off - teeth * mm).abs() < 0.012 * teeth.abs());
                assert!(is_right, "{} motor {motor}, {teeth} teeth: {off:?}", machine.name());
                assert!((live.shifted_mm(motor) - 2.0 * teeth).abs() < 1e-9);
                // The rotor stays in its field's turn.
                assert!(live.take_skips().is_empty());
            }
        }
    }
    // The strain of a closed belt: all of it, but for the fields that give way.
    let mut live = holding(Machine::CoreHBot, &stiff(10.0), &[]);
    live.jump(0, 1.0);
    wait(&mut live, 1000);
    assert!((1.9..2.0).contains(&live.residual_mm().unwrap()), "{:?}", live.residual_mm());
}

/// Motors of nominal strength do not bear two millimetres of strain: some skip, and less than a turn (0.8 mm) stays.
#[test]
fn a_jumped_tooth_makes_motors_of_one_belt_skip() {
    let mut live = holding(Machine::CoreHBot, &Params::default(), &[]);
    live.jump(1, 1.0);
    wait(&mut live, 1000);
    assert!(!live.take_skips().is_empty());
    assert!(live.residual_mm().unwrap().abs() < 0.8, "{:?}", live.residual_mm());
}

/// Deflection by 10 N to the right.
fn pushed(live: &mut Live) -> [f64; 2] {
    let before = live.tool();
    live.push([10.0, 0.0]);
    wait(live, 700);
    let tool = live.tool();
    live.push([0.0; 2]);
    wait(live, 700);
    [tool.x - before.x, tool.y - before.y]
}

#[test]
fn a_broken_cord_makes_the_tool_give_way_more() {
    // One closed belt: half of its stiffness doubles what gives way.
    let mut live = holding(Machine::CoreHBot, &stiff(50.0), &[]);
    let [before, _] = pushed(&mut live);
    live.weaken(0, 0.5);
    let [after, across] = pushed(&mut live);
    assert!((after / before - 2.0).abs() < 0.03 && across.abs() < 0.01 * before, "{before} {after} {across}");
    // Two belts along (1, 1) and (1, -1), each with a stiffness k: 10 N give way by F / 2k. With half of one,
    // F / 4 (1 / kA + 1 / kB) along the push, and F / 4 (1 / kA - 1 / kB) across: 1.5 and 0.5 times as much.
    for (belt, sign) in [(0, 1.0), (1, -1.0)] {
        let mut live = holding(Machine::CoreXy, &stiff(50.0), &[]);
        let [before, _] = pushed(&mut live);
        live.weaken(belt, 0.5);
        let [after, across] = pushed(&mut live);
        let ratios = [after / before, across.abs() / before];
        assert!((ratios[0] - 1.5).abs() < 0.03 && (ratios[1] - 0.5).abs() < 0.03, "{belt}: {ratios:?}");
        assert!(across.signum() == sign, "{belt}: {across}");
        // The next cord of the same belt.
        live.weaken(belt, 0.5);
        assert!((pushed(&mut live)[0] / before - 2.5).abs() < 0.06);
    }
}

/// Belt from clamp over motor and idler to the other clamp, with free lengths 1, 2 and 3. A sliding idler takes a force
/// F out of the tension; the tool has the same one on both sides. So it lags by F / (k1 + k2 + k1 k2 / k3).
#[test]
fn a_seized_idler_drags_the_tool_back_by_what_the_belt_stretches() {
    let (params, machine, force_n) = (stiff(10.0), straight(), 15.0);
    let [first, ..] = idlers_of(machine, 22)[..] else { unreachable!() };
    let mut live = holding(machine, &params, &[first]);
    let length = params.width_mm;
    live.seize(0, force_n);
    // 4 mm at 2 mm/s, so that it hardly rings.
    let steps = (4.0 / (params.full_step_mm(0) / 256.0)) as u64;
    for _ in 0..steps {
        live.step(&[1, 0]);
        live.advance(live.now() + 2000 * MS / steps);
    }
    wait(&mut live, 500);
    let [lag, ..] = off(&live).map(|mm| -mm);
    // Clamps are half of their distance from the tool's place.
    let to_motor = length / 2.0 - 4.0 - params.head_pulleys_mm / 2.0;
    let to_idler = length / 2.0 + 4.0 - params.head_pulleys_mm / 2.0;
    let [k1, k2, k3] = [to_motor, length, to_idler].map(|mm| params.belt_ea_n.of(0) / mm);
    let expected = force_n / (k1 + k2 + k1 * k2 / k3) + force_n / params.field_stiffness_n_per_mm(0);
    assert!((lag / expected - 1.0).abs() < 0.05, "{lag} {expected}");
    // It turns again, and the tool is where it should be.
    live.seize(0, 0.0);
    wait(&mut live, 500);
    assert!(off(&live)[0].abs() < 1e-3, "{:?}", off(&live));
}

/// The screw holds 10 N. A push of 15 N leaves 5 for the head: half of a t^2 in 100 ms.
#[test]
fn a_loose_pulley_slips_from_its_force_on_and_only_in_its_direction() {
    let params = Params { guide_x_n_s_per_m: 0.0, ..stiff(10.0) };
    let moved = |push_n: f64, most_n: [f64; 2]| {
        let mut live = holding(straight(), &params, &[]);
        live.loosen(0, most_n);
        live.push([push_n, 0.0]);
        wait(&mut live, 100);
        let (moved, shifted) = (off(&live)[0], live.shifted_mm(0));
        // Tightened, it holds where it is.
        live.tighten(0);
        live.push([0.0; 2]);
        wait(&mut live, 1000);
        assert!((off(&live)[0] - live.shifted_mm(0)).abs() < 1e-3, "{:?} {}", off(&live), live.shifted_mm(0));
        assert!(live.take_skips().is_empty());
        (moved, shifted)
    };
    // Before that the belt takes 10 N over 10 N / k, half of that on the way; the rest moves the head: 10 N of 15.
    let [short, long] = [0.5, 1.5].map(|part| part * params.width_mm - params.head_pulleys_mm / 2.0);
    let stiffness = params.belt_ea_n.of(0) * (1.0 / short + 1.0 / long);
    let before = (2.0 * (15.0 - 5.0) * 10.0 / stiffness / params.head_mass_kg / 1000.0).sqrt() * 100.0;
    let free = 0.5 * 5.0 / params.head_mass_kg * 0.1 * 0.1 * 1000.0 + before;
    let (slipped, shifted) = moved(15.0, [10.0; 2]);
    assert!((slipped / free - 1.0).abs() < 0.05 && (slipped - shifted).abs() < 0.2, "{slipped} {shifted} {free}");
    let (back, _) = moved(-15.0, [10.0; 2]);
    assert!((back / free + 1.0).abs() < 0.05, "{back} {free}");
    // A belt that pulls clockwise drives the tool to the left here.
    assert_eq!(moved(15.0, [10.0, f64::INFINITY]).1, 0.0);
    assert!(moved(-15.0, [10.0, f64::INFINITY]).1 < -0.9 * free);
    assert_eq!(moved(8.0, [20.0; 2]).1, 0.0);
}
