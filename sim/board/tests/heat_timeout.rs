//! Unused heaters go off in whatever state the machine is left (F23), and stay off.

use corehbot::connectors::Heater;
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Celsius, Mm, TICKS_PER_MS};
use corehbot_rig::plant::HeaterFault;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, HeatPeriod, Sink, World};

/// As short as the setting may be, in minutes.
const IDLE_MIN: u8 = 1;

/// How long the machine is left alone, in s; the default setting is half an hour.
const LEFT_S: u64 = 300;

/// When heaters had power last, and had a target, in ticks.
#[derive(Default)]
struct Last {
    power: u64,
    target: u64,
}

impl Sink for Last {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}

    fn heat(&mut self, period: &HeatPeriod) {
        for heater in period.heaters.iter().flatten() {
            if heater.duty > 0 {
                self.power = period.now;
            }
            if heater.target > Celsius::ZERO {
                self.target = period.now;
            }
        }
    }
}

/// Says lines, a second apart, and leaves the machine alone. When heaters had power and a target for the last time, in
/// s.
fn left_alone(lines: &[&str], mut look: impl FnMut(u64, &mut World<'_>)) -> [f64; 2] {
    let mut settings = Settings::prototype();
    settings.thermal.idle_min = IDLE_MIN;
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    let (drivers, mut desk, mut last) = (Drivers::new(), Desk::new(1), Last::default());
    {
        let start = Some([100, 100, 50].map(Mm::from_num));
        let mut world = World::new(&mut desk, &settings, start, NoStorage, &drivers, &mut last);
        let mut lines = (1..).zip(lines);
        let mut next = lines.next();
        while world.now() < LEFT_S * 1000 * u64::from(TICKS_PER_MS) {
            let ms = world.now() / u64::from(TICKS_PER_MS);
            if let Some((second, line)) = next
                && ms >= second * 1000
            {
                world.wires()[0].put(format!("{line}\n").into_bytes());
                next = lines.next();
            }
            world.poll();
            drop(world.wires()[0].heard());
            look(ms, &mut world);
            world.advance();
        }
        assert!(next.is_none());
    }
    [last.power, last.target].map(|tick| tick as f64 / 1000.0 / f64::from(TICKS_PER_MS))
}

#[test]
fn f23_heaters_go_off_in_every_state_that_a_machine_is_left_in() {
    let heat = ["M140 S60", "M104 S150"];
    for state in [
        // A file that has ended, or a host that has gone away between two lines or in one.
        "M400",
        "M105",
        "G1 X1",
        "; a comment",
        // The user is waited for.
        "M0",
        "M1 S3600",
        "M600",
        "M601",
        "M25",
        "M125",
        // Nothing moves, whatever else is asked.
        "M84",
        "M106 S255",
        "M211 S0",
        "M155 S1",
        "M154 S1",
    ] {
        let [power, target] = left_alone(&[heat.as_slice(), &[state]].concat(), |_, _| {});
        println!("{state}: power until {power:.1} s, targets until {target:.1} s");
        // A minute after the last of at most three lines, and the time of a move.
        assert!((60.0..68.0).contains(&power) && (60.0..68.0).contains(&target), "{state}: {power} s, {target} s");
    }
}

#[test]
fn f23_a_line_without_an_end_keeps_no_heater_on() {
    // The begin of a host's line does not count as use of the heaters.
    let [power, _] = left_alone(&["M140 S60"], |ms, world| {
        if ms > 5000 && ms.is_multiple_of(10_000) {
            world.wires()[0].put(*b"G1 X");
        }
    });
    assert!((60.0..63.0).contains(&power), "{power}");
}

#[test]
fn f23_a_machine_that_has_failed_has_no_heater_on() {
    let [power, target] = left_alone(&["M140 S60", "M104 S150", "M112"], |_, _| {});
    assert!(power < 3.1 && target < 3.1, "{power}, {target}");
    // An open cartridge: the bed goes off with it.
    let [power, target] = left_alone(&["M140 S60", "M104 S200"], |_, world| {
        if let Some(plant) = world.heat().plant() {
            plant.faults().hotend_heater = HeaterFault::OPEN;
        }
    });
    assert!(power < 40.0 && target < 40.0, "{power}, {target}");
}
