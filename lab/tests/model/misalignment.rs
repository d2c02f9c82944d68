//! Pulleys off their places, against the printed equations of the CoreH-bot paper and belts by hand.

use corehbot_lab::queries::misalignment::{Misalignment, MisalignmentError, Offset};
use corehbot_twin::params::{Each, Params};
use corehbot_twin::queries::Setup;
use corehbot_twin::routing::Machine;

fn off(pulley: u8, x: f64, y: f64) -> Offset {
    Offset { pulley, off_mm: [x, y] }
}

fn of(machine: Machine, offsets: &[Offset]) -> Misalignment {
    Misalignment::new(&Setup::nominal(machine, 150.0, 300.0), offsets).unwrap()
}

fn agree(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= (part * expected.abs()).max(1e-9)
}

/// Equations 26 and 27 as they are printed, with offsets in the place of places; in N mm for 40 N.
fn printed(offsets: &[Offset]) -> [f64; 2] {
    let all =
        |pulley: u8, axis: usize| offsets.iter().filter(|o| o.pulley == pulley).map(|o| o.off_mm[axis]).sum::<f64>();
    let (x, y) = (|pulley| all(pulley, 0), |pulley| all(pulley, 1));
    let bar = (x(12) - x(14))
        + (x(10) - x(2))
        + (x(9) - x(3))
        + (x(7) - x(5))
        + (y(3) - y(2))
        + (y(5) - y(14))
        + (y(7) - y(12))
        + (y(9) - y(10));
    let head = 2.0 * (y(13) - y(6));
    [40.0 * (bar + head), 40.0 * head]
}

#[test]
fn torques_are_those_of_equations_26_and_27() {
    let mixed: Vec<Offset> = (1..=14)
        .map(|pulley| off(pulley, 0.3 * f64::from(pulley) - 2.0, 1.7 - 0.2 * f64::from(pulley * 3 % 14)))
        .collect();
    let single = (1..=14).flat_map(|pulley| [vec![off(pulley, 1.0, 0.0)], vec![off(pulley, 0.0, 1.0)]]);
    for offsets in single.chain([mixed]) {
        let found = of(Machine::CoreHBot, &offsets).paper;
        let [bar, head] = printed(&offsets);
        assert!(
            agree(1000.0 * found.bar_nm, bar, 1e-9) && agree(1000.0 * found.head_nm, head, 1e-9),
            "{offsets:?} {found:?}"
        );
    }
    // Alike offsets of an aligned pair, equations 28 and 29, make none.
    let pairs = [
        (12, 14, [1.0, 0.0]),
        (10, 2, [1.0, 0.0]),
        (9, 3, [1.0, 0.0]),
        (7, 5, [1.0, 0.0]),
        (3, 2, [0.0, 1.0]),
        (5, 14, [0.0, 1.0]),
        (7, 12, [0.0, 1.0]),
        (9, 10, [0.0, 1.0]),
        (13, 6, [0.0, 1.0]),
    ];
    for (a, b, [x, y]) in pairs {
        let found = of(Machine::CoreHBot, &[off(a, x, y), off(b, x, y)]).paper;
        assert!(found.bar_nm.abs() < 1e-12 && found.head_nm.abs() < 1e-12, "{a} and {b}: {found:?}");
    }
}

/// Bar and head together feel the segments to the frame alone, which run along y: offsets in y make no torque on the
/// bar's guides, though equation 26 has it. Pulley 12 to the right by d: the line to pulley 11 slants by d / L, L = D -
/// y - 2r. It goes through the same place on pulley 11, D - y above the tool. So its moment about the tool changes by T
/// d (D - y) / L where the paper has T d.
#[test]
fn real_lines_agree_with_the_paper_but_for_their_slant() {
    for pulley in [2, 3, 5, 7, 9, 10, 12, 14] {
        let found = of(Machine::CoreHBot, &[off(pulley, 0.2, 0.0)]);
        let (paper, real) = (found.paper.bar_nm, found.slanted.bar_nm);
        assert!(paper.abs() > 0.0079 && (real / paper - 1.0).abs() < 0.25, "{pulley}: {paper} {real}");
        let found = of(Machine::CoreHBot, &[off(pulley, 0.0, 0.2)]);
        assert!(found.paper.bar_nm.abs() > 0.0079 && found.slanted.bar_nm.abs() < 1e-12, "{pulley}: {found:?}");
        let per_mm = found.per_mm.iter().find(|one| one.pulley == pulley).unwrap();
        let [right, back] = [per_mm.right_slanted, per_mm.back_slanted].map(|torques| torques.unwrap().bar_nm);
        assert!(agree(right, 5.0 * real, 1e-2) && back.abs() < 1e-9);
    }
    // The head's guide does feel pulley 6 in y, by the line from pulley 5 and the one to pulley 7: 2 T d (L + e / 2) /
    // L.
    let found = of(Machine::CoreHBot, &[off(6, 0.0, 0.01)]);
    let line = 470.0 - 150.0 - 40.0;
    assert!(agree(found.slanted.head_nm, -2.0 * 40.0 * 1e-5 * (line + 40.0) / line, 1e-3), "{:?}", found.slanted);
    assert!(found.paper.bar_nm.abs() > 7e-4 && found.slanted.bar_nm.abs() < 1e-12);
    let found = of(Machine::CoreHBot, &[off(12, 0.01, 0.0)]);
    let ratio = found.slanted.bar_nm / found.paper.bar_nm;
    assert!(agree(ratio, 170.0 / (170.0 - 12.7), 1e-4), "{ratio}");
    // 40 N by 1 mm are 40 mN m, which guides of 2,000 N m/rad bear with 0.02 mrad; no belt helps.
    let found = of(Machine::CoreHBot, &[off(12, 1.0, 0.0)]);
    assert!(agree(found.yaw_mrad.unwrap(), 1000.0 * found.slanted.bar_nm / 2000.0, 1e-6), "{found:?}");
}

/// The line from pulley 11 to 12 becomes hypot(L, d): with L = D - y - 2r along the stroke of y, in the span L. The
/// tool gives way in x until both sides pull alike: dT = e k_L k_R / (k_L + k_R), x = -e k_L / (2 (k_L + k_R)).
#[test]
fn the_slant_pulls_more_towards_the_end_of_the_stroke() {
    let found = of(Machine::CoreHBot, &[off(12, 1.0, 0.0)]);
    let (w, r) = (470.0, 6.35);
    let slant = |y: f64| (w - y - 2.0 * r).hypot(1.0) - (w - y - 2.0 * r);
    let rest = w - 4.0 * r - 80.0;
    let [left, right] = [30_000.0 / (rest + 2.0 * 150.0), 30_000.0 / (rest + 2.0 * 320.0)];
    for place in &found.along_y {
        let longer = slant(place.y_mm) - slant(300.0);
        let tension = longer * left * right / (left + right);
        for (span, expected) in [("L", tension), ("R", tension), ("lo", 0.0), ("up", 0.0)] {
            assert!((place.tension_change_n[span] - expected).abs() < 1e-9, "{span} at y {}: {place:?}", place.y_mm);
        }
        assert!((place.dx_mm + longer * left / (2.0 * (left + right))).abs() < 1e-9 && place.dy_mm.abs() < 1e-12);
    }
    let end = found.along_y.last().unwrap();
    assert!(agree(end.y_mm, 443.8, 1e-9) && end.greatest_n() > 0.3, "{end:?}");
    // Along x no line of pulley 12 changes its slant. At the very end the belt passes from it to the head's pulley
    // askew.
    let [end, others @ ..] = &found.along_x[..] else { panic!() };
    assert!(others.iter().all(|place| place.greatest_n().abs() < 1e-9) && end.greatest_n().abs() < 0.1, "{end:?}");
    // Where the preload was set nothing has changed, with rotors neither.
    let at = Setup {
        freedom: corehbot_twin::model::elastic::Freedom { idlers: true, rotors: true, ..Default::default() },
        ..Setup::nominal(Machine::CoreHBot, 150.0, 235.0)
    };
    let found = Misalignment::new(&at, &[off(12, 1.0, 0.0), off(6, 0.0, 2.0)]).unwrap();
    assert!(found.along_y[20].greatest_n().abs() < 1e-9 && found.along_y[0].greatest_n().abs() > 1e-3);
    assert!(found.along_x[0].greatest_n().abs() > 1e-3);
}

/// Reproducer: with pulleys that come together before the stroke ends, the last place was one of an even grid, up to
/// 10 mm before. The greatest pull was told as 0.8 N, and is 2.3 N.
#[test]
fn the_last_place_with_room_is_told() {
    for (pulley, way) in [(1, 1.0), (2, -1.0), (10, -1.0), (11, 1.0)] {
        let found = of(Machine::CoreHBot, &[off(pulley, way, 0.0)]);
        let [first, second, ..] = &found.along_y[..] else { panic!() };
        let [.., before, last] = &found.along_y[..] else { panic!() };
        let (end, next) = if pulley < 8 { (first, second) } else { (last, before) };
        let to_the_edge = if pulley < 8 { end.y_mm - 26.2 } else { 443.8 - end.y_mm };
        assert!(found.along_y.len() == 41 && (4.0..6.0).contains(&to_the_edge), "{pulley}: {end:?}");
        assert!(end.greatest_n().abs() > 2.0 * next.greatest_n().abs(), "{pulley}: {end:?} {next:?}");
    }
}

#[test]
fn every_flat_machine_answers_and_bad_questions_are_named() {
    for machine in [Machine::HBot, Machine::CoreXy, Machine::AwdCoreXy] {
        let found = of(machine, &[off(2, 0.5, 0.0)]);
        assert!(found.paper.bar_nm.abs() > 1e-4, "{found:?}");
        let text = found.to_string();
        assert!(text.contains("tau_B2") && text.contains("along the stroke of x"), "{text}");
    }
    // Twice the preload, twice the torque.
    let tight = Params { preload_n: Each::all(80.0), ..Params::default() };
    let setup = Setup { params: tight, ..Setup::nominal(Machine::CoreHBot, 150.0, 300.0) };
    let found = Misalignment::new(&setup, &[off(12, 1.0, 0.0)]).unwrap();
    assert!(agree(found.paper.bar_nm, 0.08, 1e-9));
    let why = |machine, offset| Misalignment::new(&Setup::nominal(machine, 235.0, 235.0), &[offset]).unwrap_err();
    assert_eq!(why(Machine::CoreXyz, off(21, 1.0, 0.0)), MisalignmentError::InSpace);
    assert_eq!(why(Machine::CoreHBot, off(15, 1.0, 0.0)), MisalignmentError::NoPulley(15, (1..=14).collect()));
    assert_eq!(why(Machine::CoreHBot, off(5, -400.0, 0.0)), MisalignmentError::NoRoom);
}

/// In a corner of the reach pulleys 1 and 2 touch, and 3 and 4: a mm of 2 to the left leaves the belt between them no
/// room. So it has no torque by real lines there, and none a tenth of a mm before, where that mm is too much as well.
#[test]
fn the_end_of_the_reach_leaves_some_pulleys_no_room() {
    for y in [26.2, 26.3] {
        let found = Misalignment::new(&Setup::nominal(Machine::CoreHBot, 40.0, y), &[off(12, 1.0, 0.0)]).unwrap();
        let of = |pulley: u8| found.per_mm.iter().find(|one| one.pulley == pulley).unwrap();
        assert!(of(2).right_slanted.is_none() && of(3).right_slanted.is_none(), "{y}: {found:?}");
        assert!(of(12).back_slanted.is_none() && of(13).back_slanted.is_none(), "{y}: {found:?}");
        // Pulley 9 is far from the end: 40 N by a mm, and its slant.
        assert!(of(9).right_slanted.is_some_and(|real| agree(real.bar_nm, 0.0425, 1e-2)), "{y}: {found:?}");
        for one in &found.per_mm {
            for real in [one.right_slanted, one.back_slanted].into_iter().flatten() {
                assert!(real.bar_nm.abs() < 0.1 && real.head_nm.abs() < 0.6, "{y}: {one:?}");
            }
        }
        let text = found.to_string();
        assert!(text.contains("-40.00 /  no room") && !text.contains("NaN"), "{text}");
    }
}

/// Pulley 12 off by 20 mm, preloaded where its line is 17.3 mm long: 9 mm too much belt in the middle of the stroke.
#[test]
fn slack_belts_are_told() {
    let setup = Setup::nominal(Machine::CoreHBot, 150.0, 440.0);
    let slack = Misalignment::new(&setup, &[off(12, 20.0, 0.0)]).unwrap();
    assert!(slack.along_y.iter().any(|place| place.goes_slack), "{slack}");
    assert!(slack.along_y.iter().all(|place| place.goes_slack == (40.0 + place.tension_change_n["L"] < 0.0)));
    assert!(slack.to_string().contains("there belts go slack, so figures do not hold"), "{slack}");
    let tight = of(Machine::CoreHBot, &[off(12, 1.0, 0.0)]);
    assert!(tight.along_x.iter().chain(&tight.along_y).all(|place| !place.goes_slack));
    assert!(!tight.to_string().contains("slack"), "{tight}");
}
