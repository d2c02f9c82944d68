//! How much power a heater takes for its model, and how far its reading moves: on both plants, healthy and not.

use super::lives::{print, warm_up};
use super::machine::{Apart, Breaks, Dice, Machine, Outside, Simulated, Spec};
use corehbot::connectors::Heater;
use corehbot::fault::Cause;
use corehbot::settings::ThermalSettings;
use corehbot::units::JoulesPerKelvin;

/// Figures of a heater: its power, and how many times less it moves.
fn figures(machine: &impl Machine, heater: Heater) -> [f64; 2] {
    let figures = machine.status().heat().figures(heater);
    [figures.power, figures.less].map(|ratio| f64::from(ratio) / 256.0)
}

/// The temperature of most prints.
const TARGET: f64 = 210.0;

/// A machine that has held its target, and printed for ten minutes.
fn printed<M: Machine>(seed: u64, settings: impl Fn(&Spec) -> ThermalSettings) -> (M, Dice) {
    let spec = Spec::of(seed);
    let mut machine = M::new(&spec, settings(&spec));
    let mut dice = Dice::new(seed);
    warm_up(&mut machine, TARGET);
    print(&mut machine, &mut dice, 600.0, 8.0);
    assert_eq!(machine.fault(), None, "{spec:?}");
    (machine, dice)
}

/// Seeds of machines of 60 W and more: 40 W are near full power when something is wrong.
fn strong() -> impl Iterator<Item = u64> {
    (0..12).filter(|seed| Spec::of(*seed).watt > 50.0)
}

fn right(spec: &Spec) -> ThermalSettings {
    spec.settings(0.0)
}

#[test]
fn a_healthy_hotend_takes_and_moves_what_its_model_says() {
    fn check<M: Machine>(seed: u64) {
        let (machine, _) = printed::<M>(seed, right);
        let [power, less] = figures(&machine, Heater::Hotend);
        println!("{seed}: power {power:.2}, moves {less:.2} times less");
        assert!((0.8..1.3).contains(&power) && (0.85..1.2).contains(&less));
    }
    for seed in 0..6 {
        check::<Simulated>(seed);
        check::<Apart>(seed);
    }
}

#[test]
fn a_draught_takes_power_and_a_wrong_capacity_moves_less_and_a_sensor_does_both() {
    fn check<M: Machine>(seed: u64) {
        let (mut machine, mut dice) = printed::<M>(seed, right);
        let before = figures(&machine, Heater::Hotend);
        let spec = Spec::of(seed);
        machine.outside(Outside { room: spec.room, draught: 1.7, ..Outside::USUAL });
        print(&mut machine, &mut dice, 400.0, 8.0);
        let [power, less] = figures(&machine, Heater::Hotend);
        assert!(power > 1.2 * before[0] && less < 1.2 * before[1], "draught: {power} {less} of {before:?}");

        let heavy = |spec: &Spec| {
            let mut settings = spec.settings(0.0);
            let model = &mut settings.heater_mut(Heater::Hotend).model;
            model.capacity = JoulesPerKelvin::from_num(model.capacity.to_num::<f64>() / 1.5);
            settings
        };
        let (machine, _) = printed::<M>(seed, heavy);
        let [power, less] = figures(&machine, Heater::Hotend);
        assert!(power < 1.1 * before[0] && less > 1.3 * before[1], "capacity: {power} {less} of {before:?}");

        let (mut machine, mut dice) = printed::<M>(seed, right);
        machine.break_it(Breaks::SensorLeaves { share: 0.75, seconds: 300.0 });
        print(&mut machine, &mut dice, 900.0, 8.0);
        assert_eq!(machine.fault(), None, "{spec:?}");
        let [power, less] = figures(&machine, Heater::Hotend);
        assert!(power > 1.3 * before[0] && less > 1.15 * before[1], "sensor: {power} {less} of {before:?}");
    }
    for seed in strong().take(3) {
        check::<Simulated>(seed);
        check::<Apart>(seed);
    }
}

/// The block swings by less than a quarter of a kelvin around what it would be, and no mean is lost.
#[test]
fn the_dither_of_a_hotend_at_rest_is_a_quarter_of_a_kelvin() {
    fn check<M: Machine>(seed: u64) {
        let spec = Spec::of(seed);
        let mut machine = M::new(&spec, spec.settings(0.1));
        warm_up(&mut machine, TARGET);
        machine.run(120.0);
        let [mut least, mut most] = [f64::MAX, f64::MIN];
        let (mut sum, mut readings) = (0.0, 0.0);
        for _ in 0..64 * 50 {
            machine.period(|_| 0.0);
            let block = machine.block();
            (least, most) = (least.min(block), most.max(block));
            (sum, readings) = (sum + machine.reading(), readings + 1.0);
        }
        let (peak, mean) = ((most - least) / 2.0, sum / readings);
        println!("{seed}: {peak:.2} K, mean {mean:.2}, {:.0} J/K", spec.block + spec.cartridge + spec.nozzle);
        assert!(peak < 0.4 && (mean - TARGET).abs() < 0.1, "{peak} {mean} {spec:?}");
    }
    for seed in 0..10 {
        check::<Simulated>(seed);
        check::<Apart>(seed);
    }
}

/// A bed of half the power, and one with a sensor that comes off, take more and move less.
#[test]
fn a_bed_that_lost_power_or_its_sensor_shows_it() {
    fn check<M: Machine>(seed: u64, breaks: Breaks) {
        let spec = Spec::of(seed);
        let mut machine = M::new(&spec, spec.settings(0.1));
        machine.run(1.0);
        machine.set(Heater::Bed, 60.0);
        machine.run(2400.0);
        let before = figures(&machine, Heater::Bed);
        machine.break_it(breaks);
        machine.run(2700.0);
        let after = figures(&machine, Heater::Bed);
        println!("{seed} {breaks:?}: {before:.2?}, then {after:.2?}");
        assert_eq!(machine.fault(), None);
        assert!((0..2).all(|n| after[n] > 1.25 * before[n]), "{before:.2?} {after:.2?} {spec:?}");
    }
    for seed in 0..4 {
        for breaks in [Breaks::BedPower(0.5), Breaks::BedSensorLeaves { share: 0.5, seconds: 1200.0 }] {
            check::<Simulated>(seed, breaks);
            check::<Apart>(seed, breaks);
        }
    }
}

/// A machine that has learned its baseline in an hour and more of prints.
fn learned<M: Machine>(seed: u64) -> (M, Dice, f64) {
    let spec = Spec::of(seed);
    let mut machine = M::new(&spec, spec.settings(0.1));
    let mut dice = Dice::new(seed ^ 0x77);
    let target = dice.within(200.0, 240.0).round();
    machine.run(1.0);
    machine.set(Heater::Bed, 60.0);
    warm_up(&mut machine, target);
    print(&mut machine, &mut dice, 4900.0, 8.0);
    assert_eq!(machine.fault(), None, "{spec:?}");
    for heater in [Heater::Hotend, Heater::Bed] {
        assert!(machine.status().heat().figures(heater).has_learned(), "{heater:?} {spec:?}");
    }
    machine.learn();
    machine.period(|_| 0.0);
    (machine, dice, target)
}

/// How an accident ended: the cause, the seconds until then, whether the user was told before or instead, and the
/// hottest block, C.
#[derive(Clone, Copy, Debug)]
struct End {
    cause: Option<Cause>,
    seconds: f64,
    told: bool,
    block: f64,
}

fn accident<M: Machine>(seed: u64, breaks: Breaks, most_s: f64) -> End {
    let (mut machine, mut dice, _) = learned::<M>(seed);
    machine.break_it(breaks);
    let mut end = End { cause: None, seconds: 0.0, told: false, block: 0.0 };
    let mut flow = 0.0;
    for n in 0..(most_s * 50.0) as u32 {
        if n % 250 == 0 {
            flow = dice.within(0.0, 8.0);
        }
        machine.period(|_| flow);
        let heat = machine.status().heat();
        end.told |= [Heater::Hotend, Heater::Bed].into_iter().any(|heater| heat.figures(heater).is_low);
        end.block = end.block.max(machine.block());
        if let (None, Some(fault)) = (end.cause, machine.fault()) {
            (end.cause, end.seconds) = (Some(fault.cause), f64::from(n) / 50.0);
        }
        if end.cause.is_some() && f64::from(n) / 50.0 > end.seconds + 30.0 {
            break;
        }
    }
    end
}

/// Machines of each plant; more in a soak.
fn seeds() -> u64 {
    if crate::faults::soak_hours().is_some() { 10 } else { 3 }
}

/// Accidents on both plants, as a row of a table.
fn family(what: &str, breaks: Breaks, most_s: f64) -> Vec<End> {
    let mut ends: Vec<_> = (0..seeds()).map(|seed| accident::<Simulated>(seed, breaks, most_s)).collect();
    ends.extend((0..seeds()).map(|seed| accident::<Apart>(seed, breaks, most_s)));
    let found: Vec<_> = ends.iter().filter(|end| end.cause.is_some()).collect();
    let by = |cause: Cause| found.iter().filter(|end| end.cause == Some(cause)).count();
    let causes: Vec<_> = Cause::all().filter(|c| by(*c) > 0).map(|c| format!("E{:02} {}", c as u8, by(c))).collect();
    let mut times: Vec<_> = found.iter().map(|end| end.seconds).collect();
    times.sort_by(f64::total_cmp);
    println!(
        "| {what} | {} of {} ({}) | {:.0}, {:.0} s | {:.0} C | {} |",
        found.len(),
        ends.len(),
        causes.join(", "),
        times.get(times.len() / 2).unwrap_or(&0.0),
        times.last().unwrap_or(&0.0),
        ends.iter().map(|end| end.block).fold(0.0, f64::max),
        ends.iter().filter(|end| end.told).count(),
    );
    ends
}

#[test]
fn a_sensor_that_reads_half_stops_the_machine() {
    let ends = family("seat 1 to 0.5 in 20 min", Breaks::SensorLeaves { share: 0.5, seconds: 1200.0 }, 1800.0);
    assert!(ends.iter().all(|end| end.cause.is_some() && end.seconds < 1200.0), "{ends:?}");
    assert!(ends.iter().any(|end| end.cause == Some(Cause::ReadsLow)), "{ends:?}");
}

#[test]
fn a_sensor_that_reads_seven_tenths_is_told() {
    let ends = family("seat 1 to 0.7 in 1 h", Breaks::SensorLeaves { share: 0.7, seconds: 3600.0 }, 4500.0);
    let seen = ends.iter().filter(|end| end.told || end.cause.is_some()).count();
    assert!(seen * 10 >= ends.len() * 6, "{ends:?}");
}

#[test]
fn a_plug_that_corrodes_slowly_is_found() {
    let ends = family("+300 Ohm in 1 h", Breaks::Series { ohm: 300.0, seconds: 3600.0 }, 4500.0);
    let seen = ends.iter().filter(|end| end.told || end.cause.is_some()).count();
    assert!(seen * 10 >= ends.len() * 8, "{ends:?}");
}

#[test]
fn half_of_the_power_is_found() {
    let ends = family("half of the power", Breaks::Power(0.5), 1800.0);
    assert!(ends.iter().filter(|end| end.cause.is_some()).count() * 10 >= ends.len() * 8, "{ends:?}");
}

#[test]
fn half_of_a_beds_power_and_of_its_sensor_are_told_and_stop_nothing() {
    let ends = family("half of the bed's power", Breaks::BedPower(0.5), 3600.0);
    assert!(ends.iter().all(|end| end.cause.is_none()), "{ends:?}");
    assert!(ends.iter().filter(|end| end.told).count() * 10 >= ends.len() * 6, "{ends:?}");
    let ends = family("bed sensor half off in 30 min", Breaks::BedSensorLeaves { share: 0.5, seconds: 1800.0 }, 3600.0);
    assert!(ends.iter().all(|end| end.cause.is_none()), "{ends:?}");
    assert!(ends.iter().any(|end| end.told), "{ends:?}");
}

/// A machine with the right model that was never learned.
#[test]
fn a_sensor_that_reads_six_tenths_from_the_start_stops_a_strong_hotend() {
    fn check<M: Machine>(seed: u64) -> Option<(Cause, f64)> {
        let spec = Spec::of(seed);
        let mut machine = M::new(&spec, right(&spec));
        machine.break_it(Breaks::SensorLeaves { share: 0.6, seconds: 0.01 });
        let mut dice = Dice::new(seed);
        machine.run(1.0);
        machine.set(Heater::Hotend, TARGET);
        for n in 0..60 {
            print(&mut machine, &mut dice, 20.0, 8.0);
            if let Some(fault) = machine.fault() {
                return Some((fault.cause, f64::from(n + 1) * 20.0));
            }
        }
        None
    }
    for seed in strong().take(3) {
        let found = check::<Simulated>(seed);
        println!("{seed}: {found:?}");
        assert!(found.is_some_and(|(cause, seconds)| cause == Cause::ReadsLow && seconds < 600.0), "{found:?}");
    }
}

/// Hotend and bed lack the same power: it is the supply, which stops nothing below 300 C.
#[test]
fn a_weak_supply_is_told_and_delays_no_stop_of_a_hot_block() {
    fn check<M: Machine>(seed: u64, target: f64) -> Option<Cause> {
        let (mut machine, mut dice, _) = learned::<M>(seed);
        let room = Spec::of(seed).room;
        machine.set(Heater::Hotend, target);
        print(&mut machine, &mut dice, 900.0, 2.0);
        // Slowly, as a bed is: in hours.
        for n in 1..=10 {
            machine.outside(Outside { room, supply: 1.0 - 0.04 * f64::from(n), ..Outside::USUAL });
            print(&mut machine, &mut dice, 1200.0, 2.0);
        }
        print(&mut machine, &mut dice, 1800.0, 2.0);
        let heat = machine.status().heat();
        let lows = [Heater::Hotend, Heater::Bed].map(|heater| f64::from(heat.figures(heater).low()) / 256.0);
        println!("{seed} at {target} C: {lows:.2?} {:?}", machine.fault());
        machine.fault().map(|fault| fault.cause)
    }
    for seed in strong().take(2) {
        assert_eq!(check::<Simulated>(seed, 170.0), None);
        assert_eq!(check::<Apart>(seed, 170.0), None);
        assert_eq!(check::<Simulated>(seed, 235.0), Some(Cause::ReadsLow));
    }
}

#[test]
fn what_was_learned_is_kept_and_another_model_learns_anew() {
    let (mut machine, mut dice, target) = learned::<Simulated>(4);
    let known = |machine: &Simulated| machine.status().heat().figures(Heater::Hotend);
    print(&mut machine, &mut dice, 300.0, 8.0);
    assert!(known(&machine).has_baseline && known(&machine).learned == [0; 2]);
    // Off and on again.
    machine.set(Heater::Hotend, 0.0);
    machine.run(300.0);
    warm_up(&mut machine, target);
    print(&mut machine, &mut dice, 300.0, 8.0);
    let before = known(&machine);
    assert!(before.has_baseline && before.power.abs_diff(256) < 40 && before.less.abs_diff(256) < 40, "{before:?}");
    // Another model begins without one.
    let mut settings = *Spec::of(4).settings(0.1).heater(Heater::Hotend);
    settings.model.capacity = JoulesPerKelvin::from_num(settings.model.capacity.to_num::<f64>() * 1.1);
    machine.order(corehbot::thermal::Order::Heater(Heater::Hotend, settings));
    print(&mut machine, &mut dice, 300.0, 8.0);
    assert!(!known(&machine).has_baseline);
}
