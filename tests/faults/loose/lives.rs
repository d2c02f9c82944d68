//! Healthy lives of hotends: prints with flow, fans and draughts, a supply and targets that change, and rests.

use super::machine::{Apart, Dice, Machine, Outside, Simulated, Spec};
use corehbot::connectors::Heater;
use corehbot::fault::Cause;
use corehbot::thermal::Order;

/// Heats up to `target` and waits until it has settled.
pub fn warm_up<M: Machine>(machine: &mut M, target: f64) {
    machine.run(1.0);
    machine.set(Heater::Hotend, target);
    for _ in 0..60 {
        if (machine.reading() - target).abs() > 2.0 {
            machine.run(10.0);
        }
    }
    machine.run(60.0);
}

/// Prints for so long, with a flow that changes every few seconds, up to `most_flow` mm3/s.
pub fn print<M: Machine>(machine: &mut M, dice: &mut Dice, seconds: f64, most_flow: f64) {
    let mut flows = [0.0; 32];
    flows.iter_mut().for_each(|flow| {
        *flow = if dice.below(4) == 0 { 0.0 } else { dice.within(0.0, most_flow) };
    });
    let every = dice.within(2.0, 15.0);
    for n in 0..(seconds * 50.0) as u32 {
        if machine.fault().is_some() {
            return;
        }
        let now = f64::from(n) / 50.0;
        machine.period(|ahead| flows[((now + ahead) / every) as usize % 32]);
    }
}

/// A print of about an hour with everything that a healthy machine meets, and its rest. Returns its hours.
fn hour<M: Machine>(machine: &mut M, dice: &mut Dice, room: f64, told: &mut [(bool, u32); 2]) -> f64 {
    let target = dice.within(200.0, 240.0).round();
    let mut seconds = 0.0;
    machine.set(Heater::Bed, dice.pick(&[0.0, 60.0, 60.0, 90.0]));
    warm_up(machine, target);
    seconds += 120.0;
    let minutes = dice.within(10.0, 45.0) as u32;
    for _ in 0..minutes {
        if machine.fault().is_some() {
            return seconds / 3600.0;
        }
        if dice.below(3) == 0 {
            machine.order(Order::Fan(0, dice.pick(&[0, 20_000, 40_000, 65_535])));
        }
        if dice.below(4) == 0 {
            let gust = dice.pick(&[1.0, 1.0, 1.2, 1.4, 1.6]);
            let supply = dice.within(0.83, 1.17);
            machine.outside(Outside { room: room + dice.within(-4.0, 4.0), supply, draught: gust });
        }
        if dice.below(10) == 0 {
            machine.set(Heater::Hotend, target + dice.within(-20.0, 5.0));
        }
        if dice.below(20) == 0 {
            // A pause, and heat again.
            machine.set(Heater::Hotend, 0.0);
            let pause = dice.within(5.0, 200.0);
            machine.run(pause);
            machine.set(Heater::Hotend, target);
            seconds += pause;
        }
        print(machine, dice, 60.0, 12.0);
        seconds += 60.0;
        machine.learn();
        for (heater, told) in [Heater::Hotend, Heater::Bed].into_iter().zip(told.iter_mut()) {
            let is_low = machine.status().heat().figures(heater).is_low;
            told.1 += u32::from(is_low && !told.0);
            told.0 = is_low;
        }
    }
    if machine.fault().is_none() {
        machine.order(Order::Off);
    }
    let rest = dice.pick(&[120.0, 400.0, 900.0]);
    machine.run(rest);
    (seconds + rest) / 3600.0
}

/// A fault of a healthy machine, and its story.
pub type Alarm = (Cause, String);

/// What healthy machines lived.
#[derive(Default)]
pub struct Lived {
    pub hours: f64,
    pub alarms: Vec<Alarm>,
    /// Messages that a hotend, and a bed, reads low.
    pub told: [u32; 2],
}

/// A healthy machine for some hours.
fn life<M: Machine>(plant: &str, seed: u64, hours: f64) -> Lived {
    let spec = Spec::of(seed);
    // A model that is right, off by a tenth, off by a quarter.
    let off = [0.0, 0.1, 0.25][(seed % 3) as usize];
    let mut machine = M::new(&spec, spec.settings(off));
    let mut dice = Dice::new(seed ^ 0x1234);
    let (mut lived, mut told) = (Lived::default(), [(false, 0); 2]);
    while lived.hours < hours && lived.alarms.is_empty() {
        lived.hours += hour(&mut machine, &mut dice, spec.room, &mut told);
        if let Some(fault) = machine.fault() {
            let hours = lived.hours;
            let story = format!("{plant}, seed {seed}, model off by {off}, after {hours:.1} h: {fault} ({spec:?})");
            lived.alarms.push((fault.cause, story));
        }
    }
    lived.told = told.map(|(_, times)| times);
    lived
}

/// Hours on each plant, five to a machine at most.
pub fn healthy(hours: u32) -> Lived {
    let machines = u64::from(hours.div_ceil(5)).max(2);
    let each = f64::from(hours) / machines as f64;
    let first = 100;
    let ends: Vec<_> = std::thread::scope(|scope| {
        let all: Vec<_> = [0, 1]
            .into_iter()
            .map(|plant| {
                scope.spawn(move || {
                    (first..first + machines)
                        .map(|seed| match plant {
                            0 => life::<Simulated>("the simulator's plant", seed, each),
                            _ => life::<Apart>("the other plant", seed, each),
                        })
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        all.into_iter().flat_map(|lives| lives.join().unwrap()).collect()
    });
    ends.into_iter().fold(Lived::default(), |mut all, one| {
        all.hours += one.hours;
        all.alarms.extend(one.alarms);
        all.told = [all.told[0] + one.told[0], all.told[1] + one.told[1]];
        all
    })
}

/// The greatest rate in 1,000 hours that so many events in these hours leave possible (95 %, one-sided, Poisson).
pub fn most_in_1000_hours(events: u32, hours: f64) -> f64 {
    let chance = |mean: f64| {
        let mut term = (-mean).exp();
        let mut sum = term;
        for n in 1..=events {
            term *= mean / f64::from(n);
            sum += term;
        }
        sum
    };
    let (mut least, mut most) = (0.0, 1000.0);
    for _ in 0..60 {
        let mean = f64::midpoint(least, most);
        if chance(mean) > 0.05 { least = mean } else { most = mean }
    }
    most / hours * 1000.0
}
