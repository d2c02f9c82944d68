//! Zig-zag, racking and levelling of a CoreXYZ, against Carlyle's table and closed forms by hand.

use corehbot_lab::queries::level::{Ask as Levelled, Case, Kind, Level, LevelError};
use corehbot_lab::queries::zigzag::{Ask, Zigzag, ZigzagError};
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::solve::balance::balance;

const W: f64 = 470.0;
const EA: f64 = 30_000.0;
const R: f64 = 6.35;
/// Free lengths of a belt on both sides of its motor, tool in the middle (derived in `routings.rs`).
const OUT: f64 = 1.5 * W - 40.0 - 4.0 * R;
const BACK: f64 = 4.5 * W - 40.0 - 10.0 * R;

fn near(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= part * expected.abs().max(1e-9)
}

fn ask(axis: usize, order: Option<&str>) -> Ask {
    let order = order.map(|order| order.split(' ').map(str::to_owned).collect());
    Ask { axis, steps: 1, step_mm: 0.02, speed_mm_s: 100.0, order, alternates: false }
}

fn played(machine: Machine, ask: &Ask) -> Zigzag {
    Zigzag::new(machine, &Params::default(), ask).unwrap()
}

/// Carlyle: +A is +X-Y and +B is +X+Y, each by half a step of the axis; the width is about 0.01 mm.
#[test]
fn a_corexy_goes_half_a_step_aside() {
    let path = played(Machine::CoreXy, &ask(0, None));
    assert_eq!(path.order, ["+A", "+B"]);
    let [_, corner, end] = path.one_after_the_other_mm[..] else { panic!("{path:?}") };
    assert!(near(corner[0], 0.01, 1e-9) && near(corner[1], -0.01, 1e-9) && near(end[0], 0.02, 1e-9), "{path:?}");
    assert!(end[1].abs() < 1e-12 && near(path.aside_mm, 0.01, 1e-9) && path.residual_steps.is_none());
    assert_eq!(played(Machine::CoreXy, &ask(1, None)).order, ["-A", "+B"]);
    // Alternating orders go to both sides.
    let both = played(Machine::CoreXy, &Ask { steps: 2, alternates: true, ..ask(0, None) });
    assert!(near(both.width_steps, 1.0, 1e-9) && near(both.aside_steps, 0.5, 1e-9), "{both:?}");
}

/// A CoreXY of 198.1 N/mm (computed elsewhere) with 1.8 kg along y, which is across x, and 0.6 kg along x. Steps of
/// 0.02 mm at 100 mm/s are 5 kHz, and half of it where orders alternate.
#[test]
fn the_tool_follows_across_the_move() {
    for (axis, kg) in [(0, 1.8), (1, 0.6)] {
        let own = (198.1e3_f64 / kg).sqrt() / std::f64::consts::TAU;
        for (alternates, hz) in [(false, 5000.0), (true, 2500.0)] {
            let path = played(Machine::CoreXy, &Ask { alternates, steps: 2, ..ask(axis, None) });
            assert!(near(path.tool_hz, own, 1e-3) && near(path.zigzag_hz, hz, 1e-12), "{path:?}");
            assert!(near(path.followed, own * own / (hz * hz - own * own), 2e-3), "{path:?}");
        }
    }
    // Across x a CoreXYZ has y and z, and z is the slower one. Just above z's frequency z follows most.
    let both = played(Machine::CoreXyz, &ask(0, None));
    let slow = played(Machine::CoreXyz, &Ask { speed_mm_s: 0.02 * 41.0, ..ask(0, None) });
    assert!(both.tool_hz > 50.0 && both.tool_hz < 70.0 && slow.followed > 10.0, "{both:?} {slow:?}");
}

/// X = (B - C) / 2, Y = (A - B) / 2, Z = (A + C) / 2 of three motors; places by hand.
#[test]
fn three_motors_of_a_corexyz_go_round_a_helix() {
    let path = played(Machine::CoreXyzThree, &ask(0, Some("A B C")));
    assert_eq!(path.order, ["+A", "+B", "-C"]);
    // A: (0, 1, 1)/2; then B: (1, 0, 1)/2; then -C: (1, 0, 0) steps.
    let expected = [[0.0; 3], [0.0, 0.01, 0.01], [0.01, 0.0, 0.01], [0.02, 0.0, 0.0]];
    for (place, expected) in path.one_after_the_other_mm.iter().zip(expected) {
        assert!(place.iter().zip(expected).all(|(p, e)| (p - e).abs() < 1e-12), "{path:?}");
    }
    for axis in 0..3 {
        let orders = played(Machine::CoreXyzThree, &ask(axis, None)).orders;
        let found: Vec<(f64, usize)> = orders.iter().map(|o| (o.aside_steps, o.count)).collect();
        assert!(found.len() == 2 && near(found[0].0, 0.5, 1e-9) && near(found[1].0, 0.5_f64.sqrt(), 1e-9), "{found:?}");
        assert_eq!((found[0].1, found[1].1), (2, 4));
    }
}

#[test]
fn four_motors_go_less_aside_and_strain_each_other() {
    for axis in 0..3 {
        let orders = played(Machine::CoreXyz, &ask(axis, None)).orders;
        let found: Vec<_> = orders.iter().map(|o| (o.aside_steps, o.residual_steps.unwrap(), o.count)).collect();
        let [(least, most_strain, _), (most, less_strain, _)] = found[..] else { panic!("{found:?}") };
        assert!(near(least, 0.125_f64.sqrt(), 1e-9) && near(most_strain, 2.0, 1e-9), "{found:?}");
        assert!(near(most, 0.5, 1e-9) && near(less_strain, 1.0, 1e-9), "{found:?}");
        assert_eq!(orders.iter().map(|o| o.count).sum::<usize>(), 24);
    }
    // The CoreH-bot whose pairs follow each other.
    let pairs = played(Machine::CoreHBot, &ask(0, Some("1 4 8 11")));
    assert!(near(pairs.aside_steps, 0.25, 1e-9) && near(pairs.residual_steps.unwrap(), 1.0, 1e-9), "{pairs:?}");
}

/// The places of a CoreXYZ with four motors are those of elastic belts in the middle, where all are alike.
#[test]
fn motors_that_disagree_leave_the_tool_where_their_belts_do() {
    let (params, middle) = (Params::default(), Place::of_xyz([W / 2.0; 3]));
    let elastic = Elastic::new(Machine::CoreXyz, &params, middle, Freedom::default());
    // +A alone, and +A +B: motors 11 and 8.
    let path = played(Machine::CoreXyz, &ask(0, Some("A B C D")));
    for (turns, place) in [&[(11, 0.02)][..], &[(11, 0.02), (8, 0.02)]].iter().zip(&path.one_after_the_other_mm[1..]) {
        let balance = balance(&elastic, &params, [0.0; 3], turns).unwrap();
        for (axis, at) in Coordinate::TOOL.into_iter().zip(place) {
            assert!((balance.of(&elastic, axis) - at).abs() < 1e-12, "{axis}: {place:?}");
        }
    }
}

#[test]
fn motors_in_one_instant_go_straight() {
    for machine in [Machine::CoreXy, Machine::CoreXyzThree, Machine::CoreXyz, Machine::CoreHBot] {
        for axis in 0..machine.axes() {
            let path = played(machine, &Ask { steps: 7, ..ask(axis, None) });
            for (step, place) in path.in_one_instant_mm.iter().enumerate() {
                let expected = [0, 1, 2].map(|i| if i == axis { 0.02 * step as f64 } else { 0.0 });
                assert!(place.iter().zip(expected).all(|(p, e)| (p - e).abs() < 1e-12), "{machine:?} {place:?}");
            }
        }
    }
    let wrong = |machine, ask: &Ask| Zigzag::new(machine, &Params::default(), ask).unwrap_err();
    assert!(matches!(wrong(Machine::CoreXy, &ask(2, None)), ZigzagError::NoAxis(..)));
    for order in ["A", "A A", "A B B", "A C", "A B C"] {
        assert_eq!(wrong(Machine::CoreXy, &ask(0, Some(order))), ZigzagError::Order(vec!["A".into(), "B".into()]));
    }
}

fn level(machine: Machine, params: &Params, spring: Option<f64>) -> Level {
    let asked = Levelled { taken_mm: 1.0, spring_n_per_mm: spring, acceleration: 10.0 };
    Level::new(machine, params, Place::of_xyz([W / 2.0; 3]), asked).unwrap()
}

fn case<'l>(level: &'l Level, name: &str) -> &'l Case {
    level.cases.iter().find(|case| case.name == name).unwrap_or_else(|| panic!("{name}"))
}

/// A belt's two sides pull the bar's ends by T sx sy along y at sx W/2: a couple W T sx sy, which three belts leave
/// over.
#[test]
fn three_belts_rack_and_a_fourth_balances_them() {
    // Guides so stiff that the belts hold their preload of 40 N.
    let stiff =
        Params { bar_yaw_stiffness_nm_per_rad: 1e9, gantry_tilt_stiffness_nm_per_rad: 1e9, ..Params::default() };
    for machine in [Machine::CoreXyz, Machine::CoreXyzThree] {
        let three = level(machine, &stiff, None);
        let alone = case(&three, "belts A, B and C alone");
        // A - B + C of racking; sy of A, B, C is 1, -1, -1, sx is 1, 1, -1.
        let couple = W * 40.0 / 1000.0;
        assert!(near(alone.bar_nm.abs(), couple, 1e-4), "{alone:?}");
        assert!(alone.gantry_nm.iter().all(|m| near(m.abs(), couple, 1e-4)), "{alone:?}");
        let all = three.cases.iter().rfind(|case| case.kind == Kind::Preload).unwrap();
        assert!(all.bar_nm.abs() < 1e-9 && all.gantry_nm.iter().all(|m| m.abs() < 1e-9), "{all:?}");
    }
}

/// With both sides of a belt of different stiffness, a thrust changes its mean tension. Three motors share a force F
/// along x as 0, F/2, -F/2 (A, B, C), along y as F/2, -F/2, 0, along z as F/2, 0, F/2. The lever of each is W/2 (ko -
/// kb) / (ko + kb). The patterns of racking (1, -1, 1) and of tilts about x (1, -1, -1) and y (1, 1, -1) add them up.
/// Four motors share F evenly by the signs of its axis, which are orthogonal to those of racking.
#[test]
fn motion_racks_with_three_motors_alone() {
    let stiff =
        Params { bar_yaw_stiffness_nm_per_rad: 1e9, gantry_tilt_stiffness_nm_per_rad: 1e9, ..Params::default() };
    let uneven = (1.0 / OUT - 1.0 / BACK) / (1.0 / OUT + 1.0 / BACK);
    let three = level(Machine::CoreXyzThree, &stiff, None);
    // Head 0.6, with the bar 1.8, with the gantry 3.8 kg, at 10 m/s2.
    let four = level(Machine::CoreXyz, &stiff, None);
    for (name, newton, of_three, of_four) in [
        ("along x", 6.0, [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
        ("along y", 18.0, [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
        ("along z", 38.0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ] {
        let lever = W / 2.0 * newton * uneven / 1000.0;
        for (level, expected) in [(&three, of_three), (&four, of_four)] {
            let Case { bar_nm, gantry_nm: [about_x, about_y], .. } = *case(level, name);
            let found = [bar_nm, about_x, about_y];
            let agrees = found.iter().zip(expected).all(|(m, e)| (m.abs() - e * lever).abs() < 1e-4 * lever);
            assert!(agrees, "{name}: {found:?} {lever}");
        }
    }
}

/// Off the middle the inertia has couples of its own. Along y it is m_h a (W/2 - x) on the bar, as of a CoreH-bot.
/// Along z it is -(m_h + m_b) a (y - D/2) about x, and m_h a (x - W/2) about y. Mass that goes from the head to the
/// bar, or from both to the gantry, leaves the thrust, and so the belts' part. The difference is the couple. The
/// head is at x = 100, y = 300, with 5 m/s2.
#[test]
fn inertia_off_the_middle_racks_and_tilts() {
    let with = |head_mass_kg, bar_mass_kg, gantry_mass_kg| {
        let params = Params {
            head_mass_kg,
            bar_mass_kg,
            gantry_mass_kg,
            bar_yaw_stiffness_nm_per_rad: 1e9,
            gantry_tilt_stiffness_nm_per_rad: 1e9,
            ..Params::default()
        };
        let asked = Levelled { taken_mm: 1.0, spring_n_per_mm: None, acceleration: 5.0 };
        Level::new(Machine::CoreXyz, &params, Place::of_xyz([100.0, 300.0, W / 2.0]), asked).unwrap()
    };
    let moments = |level: &Level, name: &str| {
        let Case { bar_nm, gantry_nm: [about_x, about_y], .. } = *case(level, name);
        [bar_nm, about_x, about_y]
    };
    let nominal = with(0.6, 1.2, 2.0);
    for (other, name, expected) in [
        (with(0.1, 1.7, 2.0), "along y", [0.5 * 5.0 * 0.135, 0.0, 0.0]),
        (with(0.1, 1.7, 2.0), "along z", [0.0, 0.0, -0.5 * 5.0 * 0.135]),
        (with(0.6, 0.2, 3.0), "along z", [0.0, -5.0 * 0.065, 0.0]),
    ] {
        let (a, b) = (moments(&nominal, name), moments(&other, name));
        for ((a, b), expected) in a.iter().zip(b).zip(expected) {
            assert!((a - b - expected).abs() < 1e-4, "{name}: {a} {b} {expected}");
        }
    }
    // What Carlyle left open is asked in the middle.
    let claim = nominal.claims.iter().find(|claim| claim.text.contains("racking in motion")).unwrap();
    assert!(claim.holds && claim.found.contains("in the middle of the reach 0.000,"), "{claim:?}");
}

/// A motor that holds parts a belt, and a spring would be in one part only: springs count where belts slip.
#[test]
fn springs_count_for_levelling_and_preload_alone() {
    for machine in [Machine::CoreXyz, Machine::CoreXyzThree] {
        let (stiff, sprung) = (level(machine, &Params::default(), None), level(machine, &Params::default(), Some(0.5)));
        for (stiff, sprung) in stiff.cases.iter().zip(&sprung.cases) {
            match stiff.kind {
                Kind::Motors | Kind::Motion => assert_eq!(stiff, sprung),
                Kind::Taken => assert_ne!(stiff.tensions_n, sprung.tensions_n, "{stiff:?}"),
                Kind::Preload => {}
            }
        }
        let text = sprung.to_string();
        assert!(text.contains("motors without power, springs of 0.5 N/mm"), "{text}");
        assert!(text.contains("motors holding, springs not counted"), "{text}");
    }
}

/// A belt of a pair that is let out by 1 mm loses k (1 - 4 k D^2 / (k_t + 4 k D^2)) = 1.9 N of its 40 N.
/// Here k = EA / L.
#[test]
fn slack_belts_are_told() {
    let with = |taken_mm| {
        let asked = Levelled { taken_mm, spring_n_per_mm: None, acceleration: 10.0 };
        Level::new(Machine::CoreXyz, &Params::default(), Place::of_xyz([W / 2.0; 3]), asked).unwrap()
    };
    let slack = |level: &Level| level.cases.iter().filter(|c| c.goes_slack).map(|c| c.name.clone()).collect::<Vec<_>>();
    let k = EA / (OUT + BACK);
    let per_mm = k * 2e6 / (2e6 + 4.0 * k * W * W);
    let (tight, loose) = (with(1.0), with(1.01 * 40.0 / per_mm));
    assert!(slack(&tight).is_empty() && !tight.to_string().contains("slack"), "{tight}");
    let pair = "A shorter, C longer".to_owned();
    assert!(slack(&loose).contains(&pair) && !slack(&with(0.99 * 40.0 / per_mm)).contains(&pair), "{loose}");
    assert!(!slack(&loose).contains(&"all shorter".to_owned()));
    assert!(loose.to_string().contains("belts go slack, so figures do not hold: "), "{loose}");
}

/// Claims are about kinds of motion, whatever the take-up and the guides.
#[test]
fn claims_do_not_depend_on_the_take_up_or_on_the_guides() {
    let holds = |taken_mm, guides: f64| {
        let params = Params {
            bar_yaw_stiffness_nm_per_rad: guides,
            gantry_tilt_stiffness_nm_per_rad: guides,
            ..Params::default()
        };
        let asked = Levelled { taken_mm, spring_n_per_mm: None, acceleration: 5.0 };
        let level = Level::new(Machine::CoreXyz, &params, Place::of_xyz([W / 2.0; 3]), asked).unwrap();
        level
            .claims
            .iter()
            .filter(|claim| !claim.text.contains("spring"))
            .map(|c| (c.text, c.holds))
            .collect::<Vec<_>>()
    };
    let nominal = holds(0.1, 2000.0);
    assert!(nominal.len() > 4 && nominal.iter().all(|(_, holds)| *holds), "{nominal:?}");
    for (taken_mm, guides) in [(1e-7, 2000.0), (1e3, 2000.0), (0.1, 0.0), (0.1, 1e9)] {
        assert_eq!(holds(taken_mm, guides), nominal, "{taken_mm} {guides}");
    }
}

/// A belt that is 1 mm shorter pulls the corners of its diagonal by EA / L, L of both sides. Tilts of 1 rad about x
/// stretch each belt by D: K = k_t + 4 EA D^2 / L, and the four signs sy stand for `A, D shorter, B, C longer`.
#[test]
fn belts_tilt_the_gantry_by_the_closed_form() {
    let params = Params::default();
    let levelled = level(Machine::CoreXyz, &params, None);
    let belt = EA / (OUT + BACK);
    let tilt = 4.0 * belt * W / (2e6 + 4.0 * belt * W * W);
    let about_x = case(&levelled, "A, D shorter, B, C longer");
    assert!(near(about_x.gantry_mrad[0].abs(), 1000.0 * tilt, 1e-9), "{about_x:?} {tilt}");
    assert!(about_x.gantry_mrad[1].abs() < 1e-9 && about_x.bar_mrad.abs() < 1e-9);
    assert!(near(about_x.gantry_nm[0].abs(), 2000.0 * tilt, 1e-9));
    // Front and back corners, alike on both sides.
    let [a, b, c, d] = about_x.corners_mm;
    assert!(near(a, b, 1e-9) && near(c, d, 1e-9) && near(c, -a, 1e-9) && near(c.abs(), tilt * W / 2.0, 1e-9));
    // One belt is a quarter of each pattern: both tilts and the racking of the bar, which its guides bear.
    let one = case(&levelled, "A shorter");
    for found in [one.gantry_mrad[0], one.gantry_mrad[1], one.bar_mrad] {
        assert!(near(found.abs(), 250.0 * tilt, 1e-9), "{one:?}");
    }
    // An opposing pair: half of both tilts, and no racking.
    let pair = case(&levelled, "A shorter, C longer");
    assert!(pair.gantry_mrad.iter().all(|t| near(t.abs(), 500.0 * tilt, 1e-9)) && pair.bar_mrad.abs() < 1e-9);
    let other = case(&levelled, "B shorter, D longer");
    let [p, q] = [pair.gantry_mrad, other.gantry_mrad].map(|[x, y]| x * y);
    assert!(near(p, -q, 1e-9), "the two pairs tilt about the two diagonals: {pair:?} {other:?}");
    // All belts at once: tension alone, k each.
    let tight = case(&levelled, "all shorter");
    assert!(tight.tensions_n.iter().all(|(_, n)| near(*n, belt, 1e-9)) && tight.gantry_mrad[0].abs() < 1e-9);
    // Springs of 1 N/mm in each belt.
    let soft = 1.0 / (1.0 / belt + 1.0);
    let expected = 4.0 * soft * W / (2e6 + 4.0 * soft * W * W);
    let sprung = level(Machine::CoreXyz, &params, Some(1.0));
    assert!(near(case(&sprung, "A, D shorter, B, C longer").gantry_mrad[0].abs(), 1000.0 * expected, 1e-9));
}

/// A belt that is shorter pulls its corner towards the motor, which sits on top of the back right corner for A; the
/// opposite corner is pulled down as much.
#[test]
fn a_shorter_belt_lifts_the_corner_below_its_motor() {
    let one = level(Machine::CoreXyz, &Params::default(), None);
    let [front_left, front_right, back_right, back_left] = case(&one, "A shorter").corners_mm;
    assert!(back_right > 0.0 && near(front_left, -back_right, 1e-9), "{:?}", case(&one, "A shorter"));
    assert!(front_right.abs() < 1e-12 && back_left.abs() < 1e-12);
}

/// Four motors have the patterns x, y and z, which move the tool and strain nothing, and one more. With springs ko and
/// kb of a belt's sides it racks the bar by `2 W (ko - kb) / (k + W^2 (ko + kb))` rad per mm, and does not tilt.
#[test]
fn four_motors_cannot_level_the_gantry() {
    let levelled = level(Machine::CoreXyz, &Params::default(), None);
    let motors: Vec<&Case> = levelled.cases.iter().filter(|case| case.kind == Kind::Motors).collect();
    assert_eq!(motors.len(), 4);
    for (axis, case) in motors.iter().take(3).enumerate() {
        for (i, moved) in case.tool_mm.into_iter().enumerate() {
            assert!((moved - if i == axis { 1.0 } else { 0.0 }).abs() < 1e-9, "{case:?}");
        }
        assert!(case.tensions_n.iter().all(|(_, n)| n.abs() < 1e-6) && case.bar_mrad.abs() < 1e-9, "{case:?}");
    }
    let internal = motors[3];
    let (out, back) = (EA / OUT, EA / BACK);
    let expected = 2.0 * W * (out - back) / (2e6 + W * W * (out + back));
    assert!(near(internal.bar_mrad.abs(), 1000.0 * expected, 1e-6), "{internal:?} {expected}");
    assert!(internal.tool_mm.iter().all(|moved| moved.abs() < 1e-9), "{internal:?}");
    for case in &motors {
        assert!(case.gantry_mrad.iter().all(|tilt| tilt.abs() < 1e-9), "{case:?}");
    }
    let claim = levelled.claims.iter().find(|claim| claim.text.contains("cannot level")).unwrap();
    assert!(claim.holds, "{claim:?}");
    // With three motors there is no such pattern.
    assert!(level(Machine::CoreXyzThree, &Params::default(), None).cases.iter().all(|case| case.kind != Kind::Motors));
}

#[test]
fn machines_without_a_gantry_and_loose_ones_are_refused() {
    let asked = Levelled { taken_mm: 1.0, spring_n_per_mm: None, acceleration: 1.0 };
    let of = |machine, params: &Params| Level::new(machine, params, Place::of_xyz([W / 2.0; 3]), asked);
    assert_eq!(of(Machine::CoreXy, &Params::default()), Err(LevelError::NoGantry("CoreXY")));
    // Three belts hold bar and gantry, each pattern once, also without guides.
    let loose =
        Params { bar_yaw_stiffness_nm_per_rad: 0.0, gantry_tilt_stiffness_nm_per_rad: 0.0, ..Params::default() };
    let free = of(Machine::CoreXyz, &loose).unwrap();
    // Without guides each belt of 1 mm less lets the gantry go by 1 mm over D in the pattern of tilting.
    assert!(near(case(&free, "A, D shorter, B, C longer").gantry_mrad[0].abs(), 1000.0 / W, 1e-9));
    assert!(case(&free, "A, D shorter, B, C longer").tensions_n.iter().all(|(_, n)| n.abs() < 1e-6));
}
