//! Motors: each one is moved alone, and the wiring is found from where the tool went.

use super::direction_words::{Seen, read_seen, words};
use super::guide::{Failure, Found, Guide, Problem};
use super::step_error::StepError;
use super::wiring::{Belt, Buzz, Way, Wiring};
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;

const STILL: Failure = Failure {
    what: "nothing moves.",
    cure: "switch off. Check the motor's plug and its coils: the two wires of one coil have some ohms between them, and stand \
           next to each other in the plug.",
};
const ELSEWHERE: Failure = Failure {
    what: "what was seen fits no wiring.",
    cure: "do this step again; if it stays, a motor of another axis is plugged in here, a belt is off or a pulley is loose.",
};
const WRONG: Failure = Failure {
    what: "its plug is elsewhere, or turned round.",
    cure: "write the lines below into [motors] of the machine file, corehbot config send M.toml PORT, reset, and do this step \
           again. Or switch off and exchange the plugs.",
};
const REFUSED: Failure = Failure { what: "the board does not move it.", cure: "do the step of the drivers again." };

pub(super) const FAILURES: &[&Failure] = &[&STILL, &ELSEWHERE, &WRONG, &REFUSED];

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let room = "Put the tool by hand into the middle, 10 mm or more from the bed, take the filament out, and lay a finger on \
                the tool: it goes half a millimetre";
    guide.owner.wait("motors begin", room)?;
    let s = guide.machine;
    let fitted = s.mechanism.fitted();
    let mut done = MotorSet::NONE;
    for motor in fitted.iter() {
        if done.has(motor) {
            continue;
        }
        if s.mechanism.motors_of(3).has(motor) {
            extruder(guide, motor, &mut found)?;
            done = done.with(MotorSet::of(motor));
            continue;
        }
        let belt = Belt::of(&s, motor);
        axes(guide, &s, &belt, &mut found)?;
        done = belt.motors.iter().fold(done, |done, motor| done.with(MotorSet::of(*motor)));
    }
    Ok(found)
}

/// The motors that share axes.
fn axes(guide: &mut Guide, s: &Settings, belt: &Belt, found: &mut Found) -> Result<(), StepError> {
    let count = belt.motors.len();
    let mut among = Wiring::all(count);
    let straight = among.first().cloned().unwrap_or(Wiring(Vec::new()));
    let (mut still, mut unsure) = (false, false);
    let mut asked = (0..count).map(|moved| belt.usual(moved)).collect::<Vec<_>>();
    asked.reverse();
    while let Some(buzz) = asked.pop().or_else(|| if still || unsure { None } else { belt.next(&among) }) {
        let name = s.name_of(belt.motors[buzz.moved]).to_string();
        match look(guide, s, belt, &buzz, belt.way(&straight, &buzz))? {
            Seen::Refused(why) => {
                found.problems.push(Problem { what: format!("{name}: {why}"), cure: REFUSED.cure.to_owned() });
                return Ok(());
            }
            Seen::Unsure => {
                found.note(format!("{name} alone, {} free: not sure where the tool went", free_names(s, belt, &buzz)));
                unsure = true;
            }
            Seen::Way([0, 0, 0]) => {
                found.problems.push(STILL.of(&name));
                still = true;
            }
            Seen::Way(way) => {
                found.note(format!("{name} alone, {} free: {}", free_names(s, belt, &buzz), words(way)));
                among = belt.fitting(among, &buzz, way);
            }
        }
    }
    if let Some((buzz, turning)) = belt.mirrored(&among).filter(|_| !still && !unsure)
        && !turns(guide, s, belt, &buzz, turning)?
    {
        among.swap(0, 1);
    }
    match among.first() {
        // Without one motor the others do not hold the tool on a line, so nothing can be said of them.
        _ if still => {}
        _ if unsure => found.problems.push(ELSEWHERE.of(&names(s, &belt.motors))),
        None => found.problems.push(ELSEWHERE.of(&names(s, &belt.motors))),
        Some(wiring) if *wiring == straight => found.note(format!("{}: wired as in the file", names(s, &belt.motors))),
        Some(wiring) => {
            for (driver, (motor, reversed)) in wiring.0.iter().enumerate().filter(|(at, wire)| **wire != (*at, false)) {
                let [driver, motor] = [driver, *motor].map(|place| s.name_of(belt.motors[place]));
                let way = if *reversed { ", backward" } else { "" };
                found.note(format!("the socket of {driver} turns motor {motor}{way}"));
            }
            let cure = format!("{} {}", WRONG.cure, plugs(s, belt, wiring).join(", "));
            found.problems.push(Problem { what: WRONG.of(&names(s, &belt.motors)).what, cure });
        }
    }
    Ok(())
}

/// Moves a motor, and asks whether another one turns with it.
fn turns(guide: &mut Guide, s: &Settings, belt: &Belt, buzz: &Buzz, turning: usize) -> Result<bool, StepError> {
    let name = s.name_of(belt.motors[buzz.moved]);
    let (free, place) = (free_names(s, belt, buzz), belt.place(turning));
    let turning = s.name_of(belt.motors[turning]);
    guide.owner.tell(&format!("  {name} moves once more. Look at the motors, not at the tool."));
    guide.ask(&format!("STEPPER_BUZZ STEPPER={name} FREE={free}"))?;
    let question = format!("Does the motor turn that stands at the {place} ({turning})?");
    guide.owner.agrees(&format!("motors turn {name} {free} {turning}"), &question)
}

/// The lines of `[motors]` that a wiring needs.
fn plugs(s: &Settings, belt: &Belt, wiring: &Wiring) -> Vec<String> {
    let line = |(place, motor): (usize, &Motor)| {
        let (driver, reversed) = wiring.driver_of(place)?;
        let (plug, was) = (s.wiring.of(belt.motors[driver]), s.wiring.of(*motor));
        let is_reversed = plug.is_reversed != reversed;
        let mark = if is_reversed { "!" } else { "" };
        let changes = plug.connector != was.connector || is_reversed != was.is_reversed;
        changes.then(|| format!("`{} = \"{mark}{}\"`", s.name_of(*motor), plug.connector))
    };
    belt.motors.iter().enumerate().filter_map(line).collect()
}

fn names(s: &Settings, motors: &[Motor]) -> String {
    motors.iter().map(|motor| s.name_of(*motor).to_string()).collect::<Vec<_>>().join(" ")
}

fn free_names(s: &Settings, belt: &Belt, buzz: &Buzz) -> String {
    let free: Vec<_> = belt.set(&buzz.free).iter().collect();
    if free.is_empty() { "none".to_owned() } else { names(s, &free) }
}

/// Moves a motor, and asks where the tool went.
fn look(guide: &mut Guide, s: &Settings, belt: &Belt, buzz: &Buzz, usual: Way) -> Result<Seen, StepError> {
    let name = s.name_of(belt.motors[buzz.moved]).to_string();
    let mut key = vec![name.clone()];
    let mut line = format!("STEPPER_BUZZ STEPPER={name}");
    if let [free] = buzz.free[..] {
        let free = s.name_of(belt.motors[free]);
        line += &format!(" FREE={free}");
        key.push(free.to_string());
    }
    loop {
        guide.owner.tell(&format!("  {name} moves now, five times. The longer pause comes after it is back."));
        let heard = guide.board.ask(&line, &guide.owner)?;
        if !heard.iter().any(|line| line.contains("to and fro")) {
            return Ok(Seen::Refused(refusal(&heard)));
        }
        let question = "Which way does the tool go first? right, left, back, front, apart (nozzle from bed), closer, or two of \
                        them; nothing; again; ?";
        let seen = guide.owner.ask(&format!("motors {}", key.join(" ")), question, &words(usual), |answer| {
            if answer == "again" { Some(None) } else { read_seen(answer).map(Some) }
        })?;
        if let Some(seen) = seen {
            return Ok(seen);
        }
    }
}

/// Why the board has not moved a motor, in its words.
fn refusal(heard: &[String]) -> String {
    heard.last().map(|line| line.trim_start_matches("Error:").to_owned()).unwrap_or_default()
}

/// The extruder's motor moves no axis.
fn extruder(guide: &mut Guide, motor: Motor, found: &mut Found) -> Result<(), StepError> {
    let s = guide.machine;
    let name = s.name_of(motor).to_string();
    guide.owner.tell(&format!("  {name} moves now, five times. The longer pause comes after it is back."));
    let heard = guide.ask(&format!("STEPPER_BUZZ STEPPER={name}"))?;
    if !heard.iter().any(|line| line.contains("to and fro")) {
        let why = refusal(&heard);
        found.problems.push(Problem { what: format!("{name}: {why}"), cure: REFUSED.cure.to_owned() });
        return Ok(());
    }
    let question = "Which way would the filament go first? in (to the nozzle), out, nothing";
    let way = guide.owner.ask(&format!("motors {name}"), question, "in", |answer| {
        ["in", "out", "nothing"].into_iter().find(|known| *known == answer)
    })?;
    let plug = s.wiring.of(motor);
    match way {
        "in" => found.note(format!("{name}: feeds filament in")),
        "out" => {
            let mark = if plug.is_reversed { "" } else { "!" };
            let cure = format!("{} `{name} = \"{mark}{}\"`", WRONG.cure, plug.connector);
            found.problems.push(Problem { what: WRONG.of(&name).what, cure });
        }
        _ => found.problems.push(STILL.of(&name)),
    }
    Ok(())
}
