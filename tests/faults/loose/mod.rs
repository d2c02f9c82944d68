//! What comes loose in a hotend that heated well, and a switch that leaks: sensors that leave their hole, plugs that
//! corrode, cartridges that slide out. On two plants with different equations.

mod lives;
mod low;
mod machine;
mod other;

use lives::{print, warm_up};
use machine::{Apart, Breaks, Dice, Machine, Simulated, Spec};

use corehbot::connectors::Heater;
use corehbot::fault::Cause;

/// How the accident of a machine ended.
#[derive(Clone, Copy, Debug)]
struct End {
    cause: Option<Cause>,
    /// Seconds until the heaters were off.
    seconds: f64,
    /// The hottest that block and cartridge got, C.
    block: f64,
    cartridge: f64,
}

/// Machines of each plant.
const SEEDS: u64 = 10;

/// Breaks machines that print, on both plants; a machine may be off for `off_s` before.
fn break_all(breaks: Breaks, off_s: f64, most_s: f64) -> Vec<End> {
    fn one<M: Machine>(seed: u64, breaks: Breaks, off_s: f64, most_s: f64) -> End {
        let spec = Spec::of(seed);
        let mut machine = M::new(&spec, spec.settings(0.1));
        let mut dice = Dice::new(seed ^ 0x77);
        let target = dice.within(200.0, 240.0).round();
        warm_up(&mut machine, target);
        print(&mut machine, &mut dice, 180.0, 8.0);
        assert_eq!(machine.fault(), None, "{spec:?}");
        machine.break_it(breaks);
        if off_s > 0.0 {
            machine.set(Heater::Hotend, 0.0);
        }
        let mut end = End { cause: None, seconds: 0.0, block: 0.0, cartridge: 0.0 };
        let mut flow = 0.0;
        for n in 0..(most_s * 50.0) as u32 {
            if n % 250 == 0 {
                flow = if off_s > 0.0 { 0.0 } else { dice.within(0.0, 8.0) };
            }
            machine.period(|_| flow);
            (end.block, end.cartridge) = (end.block.max(machine.block()), end.cartridge.max(machine.hottest()));
            if let (None, Some(fault)) = (end.cause, machine.fault()) {
                (end.cause, end.seconds) = (Some(fault.cause), f64::from(n) / 50.0);
            }
            if end.cause.is_some() && f64::from(n) / 50.0 > end.seconds + 60.0 {
                break;
            }
        }
        assert!(end.cause.is_none() || !machine.is_supplied(), "{end:?}: a switch may stick unseen");
        end
    }
    let mut ends: Vec<_> = (0..SEEDS).map(|seed| one::<Simulated>(seed, breaks, off_s, most_s)).collect();
    ends.extend((0..SEEDS).map(|seed| one::<Apart>(seed, breaks, off_s, most_s)));
    ends
}

/// The longest time, and the hottest block and cartridge, of accidents that must all be found.
fn all_found(what: &str, ends: &[End], causes: &[Cause]) -> [f64; 3] {
    let most = |of: fn(&End) -> f64| ends.iter().map(of).fold(0.0, f64::max);
    let mut times: Vec<_> = ends.iter().map(|end| end.seconds).collect();
    times.sort_by(f64::total_cmp);
    let found = ends.iter().filter(|end| end.cause.is_some()).count();
    let by = |cause: &Cause| ends.iter().filter(|end| end.cause == Some(*cause)).count();
    let list: Vec<_> = Cause::all().filter(|cause| by(cause) > 0).map(|c| format!("{c:?} {}", by(&c))).collect();
    println!(
        "{what}: {found} of {} found ({}), median {:.1} s, worst {:.1} s, block {:.0} C, cartridge {:.0} C",
        ends.len(),
        list.join(", "),
        times[times.len() / 2],
        times[times.len() - 1],
        most(|end| end.block),
        most(|end| end.cartridge),
    );
    for end in ends {
        assert!(end.cause.is_some_and(|cause| causes.contains(&cause)), "{what}: {end:?}");
    }
    [most(|end| end.seconds), most(|end| end.block), most(|end| end.cartridge)]
}

const LOST: [Cause; 5] =
    [Cause::HeatMissing, Cause::TemperatureLost, Cause::LostAtFull, Cause::HeatsTooSlowly, Cause::ReadsLow];

#[test]
fn a_sensor_that_leaves_its_hole_is_found() {
    for (seconds, most_s, most_c) in [(5.0, 10.0, 262.0), (60.0, 20.0, 285.0), (600.0, 340.0, 450.0)] {
        let breaks = Breaks::SensorLeaves { share: 0.0, seconds };
        let ends = break_all(breaks, 0.0, 700.0);
        let [time, block, _] = all_found(&format!("sensor out in {seconds} s"), &ends, &LOST);
        assert!(time <= most_s && block <= most_c, "{time} s, {block} C");
    }
}

#[test]
fn a_plug_that_corrodes_quickly_is_found() {
    let ends = break_all(Breaks::Series { ohm: 2000.0, seconds: 600.0 }, 0.0, 700.0);
    let [time, block, _] = all_found("2 kOhm in 10 min", &ends, &LOST);
    assert!(time <= 160.0 && block <= 370.0, "{time} s, {block} C");
}

#[test]
fn a_cartridge_that_slides_out_is_found_before_it_glows() {
    let mut ends = break_all(Breaks::CartridgeOut, 0.0, 60.0);
    // One of the other plant is hot enough to radiate what the block needs.
    let hottest = ends.iter().map(|end| end.cartridge).fold(0.0, f64::max);
    ends.retain(|end| end.cause.is_some());
    let [time, ..] = all_found("cartridge out", &ends, &LOST);
    assert!(ends.len() >= 19 && time <= 20.0 && hottest <= 750.0, "{} found, {time} s, {hottest} C", ends.len());
}

#[test]
fn power_that_goes_is_found() {
    for part in [0.0, 0.1, 0.25] {
        let ends = break_all(Breaks::Power(part), 0.0, 120.0);
        let [time, ..] = all_found(&format!("{part} of the power"), &ends, &LOST);
        assert!(time <= 40.0, "{time} s");
    }
}

#[test]
fn a_switch_that_leaks_costs_the_supply_when_its_heater_goes_off() {
    for (part, most_s) in [(0.2, 290.0), (0.3, 160.0)] {
        let ends = break_all(Breaks::Leak(part), 1.0, 600.0);
        let causes = [Cause::StaysWarm, Cause::HeatsWhileOff, Cause::Overshoot];
        let [time, ..] = all_found(&format!("leak of {part}"), &ends, &causes);
        assert!(time <= most_s, "{time} s");
    }
}

/// Hours on each plant, except in a soak.
const HOURS: u32 = 2;

#[test]
fn healthy_hotends_in_draughts_and_with_a_supply_that_changes_raise_nothing() {
    let hours = super::soak_hours().unwrap_or(HOURS);
    let lived = lives::healthy(hours);
    for (_, told) in &lived.alarms {
        println!("{told}");
    }
    println!("{:.1} hours on two plants; in 1,000 hours at most (95 %):", lived.hours);
    let rate = |what: &str, events: u32| {
        println!("| {what} | {events} | {:.1} |", lives::most_in_1000_hours(events, lived.hours));
    };
    let of = |cause: Cause| lived.alarms.iter().filter(|(found, _)| *found == cause).count() as u32;
    for cause in Cause::all().filter(|cause| of(*cause) > 0 || NEW.contains(cause)) {
        rate(&format!("false stops, E{:02} {cause:?}", cause as u8), of(cause));
    }
    rate("messages of a hotend", lived.told[0]);
    rate("messages of a bed", lived.told[1]);
    let found: u32 = NEW.into_iter().map(of).sum();
    assert!(found == 0 && (lived.alarms.is_empty() || super::soak_hours().is_some()));
    assert!(lived.told.iter().sum::<u32>() <= 1 + (lived.hours / 400.0) as u32, "{:?}", lived.told);
}

/// The causes of the guards that compare a hotend with itself.
const NEW: [Cause; 3] = [Cause::HeatMissing, Cause::StaysWarm, Cause::ReadsLow];
