//! The owner of a machine: sees which way the tool goes, and answers what is asked.

pub(super) const CORE: [&str; 4] = ["m1", "m4", "m8", "m11"];

/// What hangs on each driver of a CoreH-bot: a motor by its place, which way it turns, and nothing if it is dead.
pub(super) type Wires = [Option<(usize, i32)>; 4];

pub(super) const STRAIGHT: Wires = [Some((0, 1)), Some((1, 1)), Some((2, 1)), Some((3, 1))];

/// Where its tool goes when one driver turns and another one is off: the only place at which the belt fits
/// (docs/explanation/kinematics.md), tried in quarters of a step.
pub(super) fn seen(wires: &Wires, moved: &str, free: &str) -> String {
    let place = |name: &str| CORE.iter().position(|known| *known == name).unwrap();
    let (moved, free) = (place(moved), place(free));
    if wires[moved].is_none() {
        return "nothing".to_owned();
    }
    let mut turns: [Option<i32>; 4] = [None; 4];
    for (driver, (motor, way)) in wires.iter().enumerate().filter_map(|(driver, wire)| Some((driver, (*wire)?))) {
        if driver != free {
            turns[motor] = Some(if driver == moved { 4 * way } else { 0 });
        }
    }
    let mut ways = std::collections::BTreeSet::new();
    for (x, y, c) in (-8..=8).flat_map(|x| (-8..=8).flat_map(move |y| (-8..=8).map(move |c| (x, y, c)))) {
        let motors: [i32; 4] = [c - x + y, c - x - y, c + x - y, c + x + y];
        if motors.iter().zip(turns).all(|(motor, turn)| turn.is_none_or(|turn| turn == *motor)) {
            ways.insert((x.signum(), y.signum()));
        }
    }
    match ways.into_iter().collect::<Vec<_>>()[..] {
        [(x, y)] => format!("{} {}", ["left", "", "right"][(x + 1) as usize], ["front", "", "back"][(y + 1) as usize]),
        _ => "?".to_owned(),
    }
}

/// An owner who does and sees what is asked for, on a machine with these wires. After problems he goes on.
pub(super) fn honest(wires: Wires) -> impl FnMut(&str, &mut dyn FnMut(&str)) -> String {
    move |key, act| {
        let words: Vec<_> = key.split(' ').collect();
        match words[..] {
            ["sensors", part] => act(&format!("warm {part}")),
            ["endstops", "press", switch] => act(&format!("press {switch}")),
            ["endstops", "release", _] => act("let go"),
            ["motors", "turn", moved, free, motor] => {
                let place = |name: &str| CORE.iter().position(|known| *known == name).unwrap();
                let turning = [moved, free].map(|driver| wires[place(driver)].map(|(motor, _)| motor));
                return if turning.contains(&Some(place(motor))) { "yes" } else { "no" }.to_owned();
            }
            ["motors", moved, free] => return seen(&wires, moved, free),
            ["supply", "supply"] => return "24.1 V".to_owned(),
            ["tuning", _] => return "no".to_owned(),
            [_, "needs"] => return "yes".to_owned(),
            [_, "decide"] => return "skip".to_owned(),
            _ => {}
        }
        String::new()
    }
}
