//! Lives: one machine is used for days, as its owner would use it, and no guard may alarm; then something breaks in
//! such a life, and must be found. `cargo xtask soak heat` makes weeks of it.
//!
//! A life is a machine drawn from a seed (powers, masses, losses, lags, noise, room) and a row of acts drawn from
//! [`ACTS`]. The seed decides the plant; the firmware knows the power of its heaters and nothing else, until it tunes
//! itself.

use crate::common::lives::{Life, Machine, live};
use corehbot::connectors::Heater;
use corehbot_sim::accident::table::Does;
use corehbot_sim::accident::{Accident, Family, ROWS, Row};
use rayon::prelude::*;

/// Something that owners do.
struct Act {
    name: &'static str,
    /// Relative frequency of the act.
    weight: u64,
    play: fn(&mut Life<'_>),
}

const fn act(name: &'static str, weight: u64, play: fn(&mut Life<'_>)) -> Act {
    Act { name, weight, play }
}

/// Everything that is done with a machine.
const ACTS: [Act; 18] = [
    act("print", 6, |life| {
        let [hotend, bed] = targets(life);
        print(life, hotend, bed);
    }),
    act("print again at once", 8, |life| {
        let [hotend, bed] = life.last.unwrap_or_else(|| targets(life));
        print(life, hotend, bed);
    }),
    act("heat again to the same target", 8, |life| {
        let [hotend, bed] = life.last.unwrap_or_else(|| targets(life));
        for _ in 0..1 + life.dice.below(3) {
            life.say(&format!("M109 S{hotend:.0}"));
            life.say("M104 S0");
            let seconds = life.dice.within(0.0, 150.0);
            life.say(&format!("G4 S{seconds:.0}"));
        }
        life.last = Some([hotend, bed]);
    }),
    act("the same with the bed", 3, |life| {
        let bed = targets(life)[1];
        for _ in 0..2 {
            life.say(&format!("M190 S{bed:.0}"));
            life.say("M140 S0");
            let seconds = life.dice.within(0.0, 600.0);
            life.pass(seconds);
        }
    }),
    act("cancel while it heats", 6, |life| {
        let [hotend, bed] = targets(life);
        life.say(&format!("M140 S{bed:.0}"));
        life.put(&format!("M109 S{hotend:.0}"));
        let seconds = life.dice.within(0.0, 120.0);
        life.pass(seconds);
        life.put("M108");
        life.await_answers(60.0);
        all_off(life);
        let seconds = life.dice.within(0.0, 90.0);
        life.pass(seconds);
    }),
    act("preheat both, one goes off", 6, |life| {
        let [hotend, bed] = targets(life);
        life.say(&format!("M140 S{bed:.0}"));
        life.say(&format!("M104 S{hotend:.0}"));
        let seconds = life.dice.within(1.0, 200.0);
        life.pass(seconds);
        let first = life.dice.pick(&["M104 S0", "M140 S0"]);
        life.say(first);
        let seconds = life.dice.within(1.0, 300.0);
        life.pass(seconds);
        all_off(life);
    }),
    act("a joint preheat, waited for", 4, |life| {
        let [hotend, bed] = targets(life);
        life.say(&format!("M140 S{bed:.0}"));
        life.say(&format!("M104 S{hotend:.0}"));
        life.say(&format!("M109 S{hotend:.0}"));
        life.say("M104 S0");
        life.say(&format!("M190 S{bed:.0}"));
        all_off(life);
    }),
    act("any targets at any time", 8, |life| {
        for _ in 0..2 + life.dice.below(12) {
            let heaters = if life.machine.has_chamber { 3 } else { 2 };
            let heater = [Heater::Hotend, Heater::Bed, Heater::Chamber][life.dice.below(heaters) as usize];
            let most = life.machine.most(heater);
            let target = if life.dice.is_one_of(4) { 0.0 } else { life.dice.within(1.0, most) };
            life.say(&format!("{} S{target:.1}", code(heater)));
            let seconds = life.dice.pick(&[1.0, 5.0, 20.0, 60.0, 300.0]);
            let seconds = life.dice.within(0.0, seconds);
            life.pass(seconds);
        }
    }),
    act("pause", 4, |life| {
        let [hotend, bed] = targets(life);
        life.say("G28");
        life.say(&format!("M140 S{bed:.0}"));
        life.say(&format!("M109 S{hotend:.0}"));
        let pause = life.dice.pick(&["M0", "M601"]);
        life.put(pause);
        let minutes = life.dice.within(0.2, 50.0);
        life.pass(minutes * 60.0);
        life.put("M108");
        life.await_answers(3600.0);
        extrude(life, 60.0);
        all_off(life);
    }),
    act("forgotten", 2, |life| {
        let [hotend, bed] = targets(life);
        life.say(&format!("M140 S{bed:.0}"));
        life.say(&format!("M104 S{hotend:.0}"));
        life.pass(32.0 * 60.0);
        life.say(&format!("M109 S{hotend:.0}"));
        all_off(life);
    }),
    act("tune the hotend", 1, |life| {
        let target = life.machine.most(Heater::Hotend).min(215.0);
        let target = life.dice.within(150.0, target.max(150.5));
        tune(life, 0, target);
    }),
    act("tune the bed", 1, |life| {
        let most = life.machine.most(Heater::Bed).min(90.0);
        let target = life.dice.within(50.0, most.max(50.5));
        tune(life, -1, target);
    }),
    act("PID or model", 2, |life| {
        let watt = life.machine.hotend.watt;
        match life.dice.below(4) {
            // Gains from M303, or default gains, serve only if it was tuned: foreign gains are no fault of a guard.
            0 => life.say("M301 P22.2 I1.08 D114"),
            1 => life.say("M304 P120 I1 D600"),
            2 => life.say(&format!("M306 E0 P{watt:.0}")),
            _ => {
                let watt = life.machine.bed.watt;
                life.say(&format!("M306 E-1 P{watt:.0}"))
            }
        };
    }),
    act("a cold plate", 2, |life| {
        life.say("M140 S0");
        let celsius = life.dice.within(5.0, 20.0);
        life.lay_plate(celsius);
        let seconds = life.dice.within(0.0, 60.0);
        life.pass(seconds);
        let bed = targets(life)[1];
        life.say(&format!("M190 S{bed:.0}"));
        all_off(life);
    }),
    act("chamber", 2, |life| {
        if life.machine.has_chamber {
            let target = life.dice.within(30.0, 55.0);
            life.say(&format!("M141 S{target:.0}"));
            let minutes = life.dice.within(1.0, 60.0);
            life.pass(minutes * 60.0);
            life.say("M141 S0");
        }
    }),
    act("self-test", 1, |life| {
        life.say("SELF_TEST");
    }),
    act("self-test just after heat", 1, |life| {
        let heater = life.dice.pick(&["M104 S200", "M140 S60"]);
        life.say(heater);
        let seconds = life.dice.within(1.0, 30.0);
        life.pass(seconds);
        all_off(life);
        life.say("SELF_TEST");
    }),
    act("night", 2, |life| {
        all_off(life);
        let hours = life.dice.within(0.5, 6.0);
        let room = life.machine.room + life.dice.within(-4.0, 4.0);
        life.faults(|faults| faults.ambient_celsius = room);
        life.pass(hours * 3600.0);
    }),
];

/// The line that sets a heater's target.
const fn code(heater: Heater) -> &'static str {
    match heater {
        Heater::Hotend => "M104",
        Heater::Bed => "M140",
        Heater::Chamber => "M141",
    }
}

/// Targets of a print that this machine can hold.
fn targets(life: &mut Life<'_>) -> [f64; 2] {
    let [hotend, bed] = [Heater::Hotend, Heater::Bed].map(|heater| life.machine.most(heater));
    [life.dice.within(185.0_f64.min(hotend - 1.0), hotend.min(260.0)), life.dice.within(40.0, bed)].map(f64::round)
}

fn all_off(life: &mut Life<'_>) {
    life.say("M104 S0");
    life.say("M140 S0");
}

/// Extrudes for `seconds` at up to 6 mm3/s.
fn extrude(life: &mut Life<'_>, seconds: f64) {
    // A nozzle on its way down to a lower target would have the line held.
    life.say("M302 P1");
    life.say("M83");
    let end = life.now() + seconds;
    let mut x = 110.0;
    while life.now() < end && life.fault().is_none() {
        x = 210.0 - x;
        let e = life.dice.within(0.0, 2.5);
        life.say(&format!("G1 X{x} E{e:.2} F600"));
    }
    life.say("M400");
}

/// A print of some minutes: heat, fan, filament, a change of the temperature, off.
fn print(life: &mut Life<'_>, hotend: f64, bed: f64) {
    // Motors that were left alone have lost their places.
    life.say("G28");
    life.say(&format!("M140 S{bed:.0}"));
    life.say(&format!("M104 S{hotend:.0}"));
    life.say(&format!("M190 S{bed:.0}"));
    life.say(&format!("M109 S{hotend:.0}"));
    for _ in 0..1 + life.dice.below(5) {
        let seconds = life.dice.within(5.0, 120.0);
        extrude(life, seconds);
        let fan = life.dice.below(256);
        life.say(&format!("M106 S{fan}"));
        if life.dice.is_one_of(3) {
            let other = hotend + life.dice.within(-15.0, 5.0).min(life.machine.most(Heater::Hotend) - hotend);
            let code = life.dice.pick(&["M104", "M109"]);
            life.say(&format!("{code} S{other:.0}"));
        }
    }
    life.say("M107");
    all_off(life);
    life.last = Some([hotend, bed]);
    let seconds = life.dice.pick(&[0.0, 30.0, 600.0]);
    life.pass(seconds);
}

/// M303, from any temperature; its result is used.
fn tune(life: &mut Life<'_>, heater: i32, target: f64) {
    if life.dice.is_one_of(3) {
        // Just after a print.
        let hotend = targets(life)[0];
        life.say(&format!("M109 S{hotend:.0}"));
    }
    let heard = life.say(&format!("M303 E{heater} S{target:.0} C3 U1"));
    let is_done = heard.iter().any(|line| line.starts_with("PID Autotune finished"));
    assert!(is_done || life.fault().is_some(), "not tuned: {heard:?}\n{}", life.story());
}

/// A row of acts until `hours` are over or a guard has found something: the act, and the finding.
fn use_it(life: &mut Life<'_>, hours: f64) -> Option<(&'static str, String)> {
    let end = life.now() + hours * 3600.0;
    let all: u64 = ACTS.iter().map(|act| act.weight).sum();
    while life.now() < end {
        let mut place = life.dice.below(all);
        let act = ACTS.iter().find(|act| {
            let is_it = place < act.weight;
            place = place.saturating_sub(act.weight);
            is_it
        });
        let act = act.unwrap();
        life.log.push(format!("{:.1}: -- {}", life.now(), act.name));
        (act.play)(life);
        if let Some(fault) = life.fault() {
            return Some((act.name, fault));
        }
    }
    None
}

/// An owner with heaters that differ from the firmware's defaults tunes them first.
fn tune_first(life: &mut Life<'_>) -> Option<(&'static str, String)> {
    let [hotend, bed] = life.machine.is_tuned_first;
    if hotend {
        let target = life.machine.most(Heater::Hotend).min(200.0);
        tune(life, 0, target);
    }
    if bed && life.fault().is_none() {
        let target = life.machine.most(Heater::Bed).min(60.0);
        tune(life, -1, target);
    }
    life.fault().map(|fault| ("tuned first", fault))
}

/// A number from the environment, for a soak.
fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap())
}

/// Hours of a soak, if this is one (`cargo xtask soak heat`).
fn soak_hours() -> Option<f64> {
    number("COREHBOT_SOAK_HOURS").map(|hours| hours as f64)
}

/// Lives of the test, and hours of each.
const LIVES: u64 = 8;
const HOURS: f64 = 1.0;

#[test]
fn a_machine_that_is_used_raises_no_alarm() {
    // Lives of two days, so that many machines are met.
    let (lives, hours) = soak_hours().map_or((LIVES, HOURS), |all| ((all / 48.0).ceil() as u64, 48.0));
    let seeds: Vec<u64> = number("COREHBOT_SOAK_SEED").map_or_else(|| (0..lives).collect(), |seed| vec![seed]);
    let ends: Vec<_> = seeds
        .par_iter()
        .map(|seed| {
            let machine = Machine::of(*seed);
            live(&machine, *seed, |life| {
                let found = tune_first(life).or_else(|| use_it(life, hours));
                let told = found.map(|(act, fault)| format!("seed {seed}, {act}: {fault}\n{}", life.story()));
                (life.now() / 3600.0, told)
            })
        })
        .collect();
    let lived: f64 = ends.iter().map(|(hours, _)| hours).sum();
    let alarms: Vec<_> = ends.iter().filter_map(|(_, told)| told.as_ref()).collect();
    for alarm in &alarms {
        println!("{alarm}\n");
    }
    println!("{lived:.1} hours lived on {} machines, {} alarms", seeds.len(), alarms.len());
    assert!(alarms.is_empty(), "{} of {} machines had a false alarm", alarms.len(), seeds.len());
}

/// The required result of a life with a fault.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Must {
    /// A guard finds it, or its heater is refused.
    BeFound,
    /// No guard can know it; nothing gets too hot.
    BeHarmless,
}

/// The required result of each accident (docs/explanation/safety.md). One that is not here must be found.
/// A leak below 60 C, next to a hot bed or of a bed keeps it warm, and no guard asks why.
const HARMLESS: [&str; 5] = ["late", "weak", "loose", "leaky", "fan-dead"];

const fn is_of_hotend_and_bed(row: &Row) -> bool {
    matches!(row.does, Does::Machine(_))
}

/// Highest allowed temperatures of hotend, bed and chamber whatever breaks, in C: nothing burns below them
/// (docs/explanation/safety.md).
const BURNS: [f64; 3] = [320.0, 160.0, 110.0];

/// Something breaks in a life.
fn break_in_a_life(row: &'static Row, heater: Heater, seed: u64) -> Result<(f64, String), String> {
    let machine = Machine::of(seed);
    let must = if HARMLESS.contains(&row.word) { Must::BeHarmless } else { Must::BeFound };
    live(&machine, seed, |life| {
        if let Some((act, fault)) = tune_first(life).or_else(|| use_it(life, 0.3)) {
            return Err(format!("a false alarm before anything broke: {act}: {fault}\n{}", life.story()));
        }
        let is_of_heater = matches!(row.does, Does::Sensor(_) | Does::Heater(_));
        let place = if is_of_heater { format!(":{}", heater.name()) } else { String::new() };
        let accident: Accident = format!("{}{place}@0s", row.word).parse().unwrap();
        // At rest, while it heats, or while it holds.
        if life.dice.below(3) > 0 {
            let [hotend, bed] = targets(life);
            life.say(&format!("M140 S{bed:.0}"));
            life.say(&format!("M104 S{hotend:.0}"));
            let seconds = life.dice.within(0.0, 500.0);
            life.pass(seconds);
        }
        if let Some(fault) = life.fault() {
            return Err(format!("a false alarm before anything broke: {fault}\n{}", life.story()));
        }
        life.faults(|faults| accident.happen(faults));
        let broken = life.now();
        life.log.push(format!("{broken:.1}: == {} {heater:?}", row.word));
        // It is used on, and heated again.
        let mut rounds = 0;
        while !life.is_found() && rounds < 8 {
            rounds += 1;
            let [hotend, bed] = targets(life);
            life.put(&format!("M140 S{bed:.0}"));
            life.put(&format!("M104 S{hotend:.0}"));
            if life.machine.has_chamber {
                life.put("M141 S50");
            }
            for _ in 0..60 {
                if !life.is_found() {
                    life.pass(15.0);
                }
            }
            all_off(life);
            life.pass(120.0);
        }
        let time = life.now() - broken;
        let found = life.fault().unwrap_or_else(|| if life.is_found() { "refused".to_owned() } else { String::new() });
        life.pass_after(900.0);
        if must == Must::BeFound && !life.is_found() {
            return Err(format!("not found in {time:.0} s\n{}", life.story()));
        }
        if life.fault().is_some() && life.is_powered() {
            return Err(format!("found ({found}), and still heats\n{}", life.story()));
        }
        if life.hottest.iter().zip(BURNS).any(|(hottest, burns)| *hottest > burns) {
            return Err(format!("{:.0?} C: {found}\n{}", life.hottest, life.story()));
        }
        Ok((time, found))
    })
}

/// Seeds of each kind of accident in the test; a soak has more.
const ACCIDENTS: u64 = 1;

#[test]
fn what_breaks_in_a_life_is_found() {
    let seeds = soak_hours().map_or(ACCIDENTS, |hours| (hours / 24.0).ceil() as u64);
    let one = number("COREHBOT_SOAK_SEED");
    let mut cases = Vec::new();
    for seed in one.map_or_else(|| (0..seeds).collect::<Vec<_>>(), |seed| vec![seed]) {
        for row in ROWS.iter().filter(|row| matches!(row.family, Family::Heat | Family::Supply)) {
            let heaters: &[Heater] =
                if is_of_hotend_and_bed(row) { &[Heater::Hotend] } else { &[Heater::Hotend, Heater::Bed] };
            let is_of_heater = matches!(row.does, Does::Sensor(_) | Does::Heater(_));
            let has = |heater: &&Heater| !is_of_heater || row.names().any(|name| name == heater.name());
            cases.extend(heaters.iter().filter(has).map(|heater| (row, *heater, 1000 + seed)));
        }
    }
    let ends: Vec<_> = cases.par_iter().map(|(row, heater, seed)| break_in_a_life(row, *heater, *seed)).collect();
    let mut missed = 0;
    for ((row, heater, seed), end) in cases.iter().zip(ends) {
        match end {
            Ok((time, found)) => println!("{} {heater:?} (seed {seed}): {time:.0} s, {found}", row.word),
            Err(why) => {
                missed += 1;
                println!("MISSED {} {heater:?} (seed {seed}): {why}\n", row.word);
            }
        }
    }
    println!("{} accidents, {missed} not as they should be", cases.len());
    assert_eq!(missed, 0);
}
