use super::*;
use corehbot::kinematics::Mechanism;
use corehbot::motors::prototype::{M1, Z1};

/// The guide's way: every motor once, then what tells most. What is seen comes from `look`.
fn found(belt: &Belt, mut look: impl FnMut(&Buzz) -> Way) -> (Vec<Wiring>, usize) {
    let count = belt.motors.len();
    let (mut among, mut asked) = (Wiring::all(count), 0);
    for moved in 0..count {
        let buzz = belt.usual(moved);
        among = belt.fitting(among, &buzz, look(&buzz));
        asked += 1;
    }
    while let Some(buzz) = belt.next(&among) {
        among = belt.fitting(among, &buzz, look(&buzz));
        asked += 1;
    }
    (among, asked)
}

/// Where the tool of a CoreH-bot goes: every place in quarters is tried with the formulas of
/// docs/explanation/kinematics.md. No code of the guide has a part in it.
fn of_corehbot(wiring: &Wiring, buzz: &Buzz) -> Way {
    let mut turns: [Option<i32>; 4] = [None; 4];
    for (driver, (motor, reversed)) in wiring.0.iter().enumerate() {
        if !buzz.free.contains(&driver) {
            let turn = if *reversed { -4 } else { 4 };
            turns[*motor] = Some(if driver == buzz.moved { turn } else { 0 });
        }
    }
    let mut ways = Vec::new();
    for x in -8..=8 {
        for y in -8..=8 {
            for c in -8..=8 {
                let motors = [c - x + y, c - x - y, c + x - y, c + x + y];
                if motors.iter().zip(turns).all(|(motor, turn)| turn.is_none_or(|turn| turn == *motor)) {
                    ways.push([x, y, 0].map(|v: i32| v.signum() as i8));
                }
            }
        }
    }
    assert_eq!(ways.len(), 1, "the tool has one place to go: {wiring:?} {buzz:?}");
    ways[0]
}

#[test]
fn every_wiring_of_a_corehbot_is_found() {
    let belt = Belt::of(&Settings::prototype(), M1);
    let all = Wiring::all(4);
    assert_eq!((belt.motors.len(), all.len(), all[0].changes()), (4, 384, 0));
    let mut most = 0;
    for wiring in &all {
        let (among, asked) = found(&belt, |buzz| of_corehbot(wiring, buzz));
        // The other one has each motor in the place of the opposite one, the other way round.
        let other = Wiring(wiring.0.iter().map(|(motor, reversed)| ((motor + 2) % 4, !reversed)).collect());
        assert!(among == [wiring.clone(), other.clone()] || among == [other.clone(), wiring.clone()], "{wiring:?}");
        let (buzz, motor) = belt.mirrored(&among).unwrap();
        let turns = |wiring: &Wiring| [buzz.moved, buzz.free[0]].iter().any(|driver| wiring.0[*driver].0 == motor);
        let is = if turns(wiring) { &among[0] } else { &among[1] };
        assert_eq!(is, wiring, "{among:?}");
        most = most.max(asked);
    }
    assert!(most <= 5, "{most} questions");
    assert_eq!([0, 1, 2, 3].map(|motor| belt.place(motor)), ["front left", "front right", "back right", "back left"]);
}

/// A CoreXY: n11 = x + y and n8 = x - y, and the other one is held.
#[test]
fn every_wiring_of_a_corexy_is_found() {
    let mut s = Settings::prototype();
    s.mechanism = Mechanism::of(&[[1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]);
    s.belt.is_closed = false;
    let belt = Belt::of(&s, M1);
    for wiring in Wiring::all(2) {
        let look = |buzz: &Buzz| {
            let (motor, reversed) = wiring.0[buzz.moved];
            let turn = if reversed { -1 } else { 1 };
            [turn, if motor == 0 { turn } else { -turn }, 0]
        };
        assert_eq!(found(&belt, look), (vec![wiring.clone()], 2));
    }
}

/// Motors of one row bring the tool to the same places, so it does not matter which is which.
#[test]
fn motors_that_do_the_same_are_left_where_they_are() {
    let s = Settings::prototype();
    let screws = Belt::of(&s, Z1);
    for backward in [false, true] {
        let way = if backward { [0, 0, -1] } else { [0, 0, 1] };
        let (among, _) = found(&screws, |_| way);
        assert_eq!((&among[0], among.len()), (&Wiring(vec![(0, backward), (1, backward)]), 2));
        assert_eq!(screws.mirrored(&among), None);
    }
    let mut awd = s;
    awd.mechanism = Mechanism::of(&[[1, 1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, 0]]);
    awd.belt.is_closed = false;
    let belt = Belt::of(&awd, M1);
    for wiring in Wiring::all(4) {
        let (among, _) = found(&belt, |buzz| belt.way(&wiring, buzz));
        // Motors 0 and 2 have one row, and 1 and 3.
        let rows = |wiring: &Wiring| wiring.0.iter().map(|(motor, back)| (motor % 2, *back)).collect::<Vec<_>>();
        assert_eq!(rows(&among[0]), rows(&wiring));
    }
}

#[test]
fn the_usual_buzz_frees_the_other_of_a_pair_and_straight_plugs_go_along_the_row() {
    let belt = Belt::of(&Settings::prototype(), M1);
    let straight = &Wiring::all(4)[0];
    let of = |moved| (belt.usual(moved).free, belt.way(straight, &belt.usual(moved)));
    assert_eq!([of(0), of(1)], [(vec![2], [-1, 1, 0]), (vec![3], [-1, -1, 0])]);
    assert_eq!([of(2), of(3)], [(vec![0], [1, -1, 0]), (vec![1], [1, 1, 0])]);
    let beside = Buzz { moved: 0, free: vec![1] };
    assert_eq!(belt.way(straight, &beside), [-1, 0, 0]);
}
