//! After a stop only a new start helps: hosts that come later are greeted, and M999 is that new start.

use corehbot::connectors::Heater;
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_rig::plant::SensorFault;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Sink, World};

/// Counts the events.
struct Count<'a>(&'a std::cell::Cell<u32>);

impl Sink for Count<'_> {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {
        self.0.set(self.0.get() + 1);
    }
}

const GREETING: &str = "echo:Printer halted. Send M999 or reset\n";
const KILLED: &str = "Error:Printer halted. kill() called! Send M999 or reset\n";

/// Lets two hosts say lines in turns: which host, the line, and for how many ms time passes. Returns the lines that
/// each has heard after each, whether the machine restarts, and whether motors have power.
fn talk(script: &[(usize, &str, u32)]) -> (Vec<[String; 2]>, bool, bool) {
    let (drivers, events) = (Drivers::new(), std::cell::Cell::new(0));
    let mut desk = Desk::new(2);
    let mut sink = Count(&events);
    let start = Some([100, 100, 10].map(Mm::from_num));
    let settings = Settings::prototype();
    let mut world = World::new(&mut desk, &settings, start, NoStorage, &drivers, &mut sink);
    let mut heard = Vec::new();
    for (host, text, ms) in script {
        match *text {
            "opens" => world.wires()[*host].open(),
            text => world.wires()[*host].put(text.bytes()),
        }
        let (halted, before) = (world.status().is_halted(), events.get());
        let end = world.now() + u64::from(*ms) * 10_000;
        world.poll();
        while world.now() < end {
            world.advance();
            world.poll();
        }
        assert!(!halted || events.get() == before, "{text}: steps after a stop");
        heard.push([0, 1].map(|host| String::from_utf8(world.wires()[host].heard()).unwrap()));
    }
    (heard, world.has_ended(), !drivers.enabled().is_empty())
}

#[test]
fn who_was_there_hears_the_error_and_who_comes_is_greeted() {
    let (heard, has_ended, has_power) = talk(&[
        (0, "", 1000),
        (0, "G1 X150 F6000\n", 300),
        (1, "M112\n", 10),
        (0, "M105\n", 10),
        (1, "opens", 10),
        (1, "M105\nM115\nM155 S2\n", 10),
        (1, "M112\n", 10),
        (1, "G28\n", 10),
        (0, "N-1 M110 N-1*125\n", 10),
        (0, "N0 M17*21\n", 10),
        (0, "M105\n", 5000),
    ]);
    assert_eq!(heard[2], [KILLED, KILLED].map(str::to_owned));
    assert_eq!(heard[3], [KILLED, ""].map(str::to_owned));
    assert_eq!(heard[4], ["", GREETING].map(str::to_owned));
    let [ref silence, ref told] = heard[5];
    assert!(silence.is_empty() && told.starts_with("ok T:") && told.contains("\nCap:"), "{told}");
    assert!(told.ends_with(&format!("ok\n{GREETING}ok\n")) && !told.contains("Error"), "{told}");
    assert_eq!([&heard[6][1], &heard[7][1]], [KILLED; 2]);
    assert_eq!(heard[8][0], format!("{GREETING}ok\n"));
    assert_eq!(heard[9][0], KILLED);
    assert!(heard[10][0].starts_with("ok T:"), "{heard:?}");
    assert!(!has_ended && !has_power);
}

/// A reset of the firmware cools nothing: a part that was hot at a fault is hot at the next start, and prints again
/// from there.
#[test]
fn heaters_are_as_hot_after_m999_as_before_it_and_the_machine_prints_again() {
    let mut settings = Settings::prototype();
    settings.thermal.heater_mut(Heater::Hotend).is_fitted = true;
    let (drivers, events) = (Drivers::new(), std::cell::Cell::new(0));
    let place = Some([100, 100, 10].map(Mm::from_num));
    let (mut now, mut plant, mut left) = (0, None, 25.0_f64);
    for round in 0..3 {
        let (mut desk, mut sink) = (Desk::at(1, now), Count(&events));
        desk.plant = plant.take();
        let mut world = World::new(&mut desk, &settings, place, NoStorage, &drivers, &mut sink);
        let celsius = |world: &mut World<'_>| world.heat().plant().unwrap().hotend_celsius();
        assert!((celsius(&mut world) - left).abs() < 0.1, "{round}: {} C after {left} C", celsius(&mut world));
        let mut heard = String::new();
        let mut until = |world: &mut World<'_>, most_s: u64, is_over: &dyn Fn(&World<'_>, &str) -> bool| {
            let end = world.now() + most_s * 10_000_000;
            while !is_over(world, &heard) {
                assert!(world.now() < end, "{round}: {heard}");
                world.poll();
                heard.push_str(&String::from_utf8(world.wires()[0].heard()).unwrap());
                world.advance();
            }
            heard.clear();
        };
        let before = events.get();
        for line in ["M109 S200", "G1 X120 E3 F3000", "M400"] {
            world.wires()[0].put(format!("{line}\n").into_bytes());
            until(&mut world, 200, &|_, heard| heard.contains("ok\n"));
        }
        assert!(events.get() > before + 1000, "{round}: it prints");
        // A wire comes off, and is mended before the reset.
        world.heat().plant().unwrap().faults().hotend_sensor = SensorFault::Open;
        until(&mut world, 5, &|world, _| world.status().is_halted());
        world.heat().plant().unwrap().faults().hotend_sensor = SensorFault::None;
        world.wires()[0].put("M999\n".bytes());
        until(&mut world, 5, &|world, _| world.has_ended());
        (left, now) = (celsius(&mut world), world.now());
        assert!(left > 190.0, "{left}");
        plant = world.take_plant();
    }
}

#[test]
fn m999_is_a_new_start_after_a_stop_and_nothing_before_it() {
    for (script, expected) in [
        (&[(0, "M112\n", 10), (0, "M999\n", 10)][..], true),
        (&[(0, "M112\n", 10), (1, "M999\n", 10)], true),
        (&[(0, "M112\n", 10), (0, "N77 M999*1\n", 10)], true),
        (&[(0, "M112\nM999\n", 10)], true),
        (&[(0, "G28\n", 500), (0, "M112\n", 10), (1, "opens", 10), (1, "m999 ;again\n", 10)], true),
        (&[(0, "M999\nM112\n", 10)], false),
        (&[(0, "M999\n", 10), (0, "M112\n", 10)], false),
        (&[(0, "M112\n", 10), (0, "M117 M999\nM9990\n;M999\n", 10)], false),
        (&[(0, "M999\n", 1000)], false),
    ] {
        let (heard, has_ended, has_power) = talk(script);
        assert_eq!(has_ended, expected, "{script:?}: {heard:?}");
        assert!(!has_power, "{script:?}");
        // The answer to it is the greeting of the new start.
        let [a, b] = heard.last().unwrap();
        assert!(!expected || !(a.contains("ok") || b.contains("ok")), "{script:?}: {heard:?}");
    }
}
