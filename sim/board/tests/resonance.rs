//! Resonance tests: the sweep within the machine's limits, what the sensor finds, and the machine after all that may
//! happen in it.

use crate::common::heated;
use crate::common::life::{Life, live_with};
use corehbot::accelerometer::{SensorFault, SensorKind};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, MmPerSec2};
use corehbot_resonance::axis::{Named, Question, judge, measure};
use corehbot_resonance::label;
use corehbot_resonance::recording::read;
use corehbot_sim::accelerometer::{ModeTruth, SensorAccident, SensorTruth};
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::world::Desk;

/// The prototype with a sensor.
fn settings() -> Settings {
    let mut settings = Settings::prototype();
    settings.accelerometer.kind = Some(SensorKind::Adxl345);
    settings
}

/// In the middle.
const MIDDLE: [i32; 3] = [200, 200, 50];

/// Lives in the middle with this sensor, as if homed.
fn live(settings: &Settings, sensor: SensorTruth, body: impl FnOnce(&mut Life<'_>)) {
    let mut desk = Desk::new(1);
    desk.sensor = Some(sensor);
    live_with(settings, Some(MIDDLE.map(Mm::from_num)), (&mut desk, 1), NoStorage, body);
}

fn modes(modes: &[(usize, f64, f64, f64)]) -> SensorTruth {
    let modes = modes.iter().map(|(axis, hz, damping, part)| ModeTruth {
        axis: *axis,
        hz: *hz,
        damping: *damping,
        part: *part,
    });
    SensorTruth { modes: modes.collect(), ..SensorTruth::default() }
}

/// Frequencies and dampings that the answers tell.
fn found(life: &Life<'_>) -> Vec<(f64, f64)> {
    let lines =
        life.heard.iter().filter_map(|line| line.strip_prefix("resonance ")).filter(|line| line.contains(" Hz "));
    let numbers = lines.map(|line| {
        let words: Vec<&str> = line.split(' ').collect();
        (words[1].parse().unwrap(), words[4].parse().unwrap())
    });
    numbers.collect()
}

fn near(found: f64, truth: f64, part: f64) {
    assert!((found / truth - 1.0).abs() <= part, "{found} instead of {truth}");
}

/// Whether the tool, and the program's place, are where they were.
fn assert_is_back(life: &mut Life<'_>) {
    let at = life.nozzle();
    assert!(at.iter().zip(MIDDLE).all(|(at, place)| (at - f64::from(place)).abs() < 0.007), "{at:?}");
    let told = life.ask("M114 R", "X:");
    assert!(told.starts_with("X:200.00 Y:200.00 Z:50.00"), "{told}");
}

/// The four modes were given to another implementation, too, which found them within 0.4 % and 10 %.
#[test]
fn modes_of_known_frequency_and_damping_are_found() {
    let alone = [(48.6, 0.06), (81.0, 0.10), (33.0, 0.03)];
    for (axis, name, (hz, damping)) in alone.into_iter().enumerate().map(|(i, mode)| (i % 2, ["X", "Y"][i % 2], mode)) {
        live(&settings(), modes(&[(axis, hz, damping, 1.0)]), |life| {
            life.say(&format!("TEST_RESONANCES AXIS={name}"));
            let found = found(life);
            assert_eq!(found.len(), 1, "{:#?}", life.heard);
            near(found[0].0, hz, 0.005);
            near(found[0].1, damping, 0.1);
            assert_eq!(life.count("echo:one mode only"), 1);
            assert_is_back(life);
        });
    }
}

#[test]
fn two_modes_are_found_apart_or_close_together() {
    for all in [[(42.0, 0.05, 0.7), (88.0, 0.08, 0.3)], [(40.0, 0.04, 0.5), (50.0, 0.05, 0.5)]] {
        let truth: Vec<_> = all.iter().map(|(hz, damping, part)| (1, *hz, *damping, *part)).collect();
        live(&settings(), modes(&truth), |life| {
            life.say("TEST_RESONANCES AXIS=Y");
            let found = found(life);
            assert_eq!(found.len(), 2, "{:#?}", life.heard);
            for ((hz, damping), (true_hz, true_damping, _)) in found.iter().zip(all) {
                near(*hz, true_hz, 0.01);
                near(*damping, true_damping, 0.15);
            }
        });
    }
}

#[test]
fn the_sweep_is_reduced_to_the_accelerations_of_the_machine() {
    live(&settings(), modes(&[(0, 48.6, 0.06, 1.0)]), |life| {
        life.say("TEST_RESONANCES AXIS=X FREQ_START=80 FREQ_END=90 HZ_PER_SEC=2");
        assert_eq!(
            life.count("echo:ACCEL_PER_HZ reduced to 51: the machine allows 5000 mm/s2"),
            1,
            "{:#?}",
            life.heard
        );
    });
    let mut strong = settings();
    strong.axes.x.max_acceleration = MmPerSec2::from_num(9000);
    strong.motor_max_acceleration = MmPerSec2::from_num(9000);
    strong.travel_acceleration = MmPerSec2::from_num(9000);
    live(&strong, modes(&[(0, 48.6, 0.06, 1.0)]), |life| {
        life.say("TEST_RESONANCES AXIS=X FREQ_START=80 FREQ_END=90 HZ_PER_SEC=2");
        assert_eq!(life.count("echo:ACCEL_PER_HZ"), 0, "{:#?}", life.heard);
    });
}

#[test]
fn what_the_machine_cannot_do_is_refused_before_the_first_step() {
    live(&settings(), SensorTruth::default(), |life| {
        for (line, answer) in [
            ("TEST_RESONANCES AXIS=X SWEEPING_ACCEL=2000 SWEEPING_PERIOD=10", "echo:sweep ignored: it "),
            ("TEST_RESONANCES AXIS=X FREQ_END=20 FREQ_START=30", "echo:TEST_RESONANCES ignored: FREQ_END=20 is out"),
            ("TEST_RESONANCES AXIS=X HZ_PER_SEC=5", "echo:TEST_RESONANCES ignored: HZ_PER_SEC=5 is out of range"),
            ("TEST_RESONANCES AXIS=Z", "echo:line ignored: \"AXIS=Z\" is not"),
            ("TEST_RESONANCES FREQ_END=", "echo:line ignored: \"FREQ_END=\" is not"),
        ] {
            life.mark();
            life.say(line);
            assert_eq!((life.count(answer), life.events().len()), (1, 0), "{line}: {:#?}", life.heard);
        }
        life.say("G1 X380 F6000");
        life.say("M400");
        life.mark();
        life.say("TEST_RESONANCES AXIS=X");
        assert_eq!(
            (life.count("echo:sweep ignored: it takes X from 36"), life.events().len()),
            (1, 0),
            "{:#?}",
            life.heard
        );
        life.say("TEST_RESONANCES AXIS=A FREQ_START=100");
        assert_eq!(
            (life.count("echo:sweep ignored: it takes X from 36"), life.events().len()),
            (2, 0),
            "{:#?}",
            life.heard
        );
        life.say("M84");
        life.say("TEST_RESONANCES AXIS=Y");
        assert_eq!(life.count("echo:move ignored: home its axes first"), 1);
    });
}

/// A short one.
const SHORT: &str = "TEST_RESONANCES AXIS=X FREQ_START=40 FREQ_END=60 HZ_PER_SEC=2";

#[test]
fn a_sensor_that_fails_ends_the_sweep_and_the_tool_goes_back() {
    let failing = [
        (SensorAccident::Fails(SensorFault::Overflow), "echo:ADXL345: samples were lost"),
        (SensorAccident::IsUnplugged, "echo:ADXL345 gives no samples"),
        (SensorAccident::Sticks, "echo:ADXL345 gives the same sample"),
        (SensorAccident::Fails(SensorFault::WrongId(0x79)), "echo:no ADXL345: its identity reads 0x79"),
    ];
    // In the noise, and in the sweep.
    for (accident, text) in failing {
        for after in [0, 10_000] {
            let truth = SensorTruth { accident: Some((after, accident)), ..modes(&[(0, 48.6, 0.06, 1.0)]) };
            live(&settings(), truth, |life| {
                let before = life.ask("M593", "  M593 X");
                life.say(SHORT);
                assert_eq!(life.count(text), 1, "{accident:?}: {:#?}", life.heard);
                assert_is_back(life);
                assert_eq!((life.ask("M593", "  M593 X"), life.is_halted()), (before, false));
                assert!(found(life).is_empty());
            });
        }
    }
    live(&settings(), SensorTruth { noise: 1500.0, ..SensorTruth::default() }, |life| {
        life.mark();
        life.say(SHORT);
        assert_eq!((life.count("echo:ADXL345 is too noisy at rest: x 1"), life.events().len()), (1, 0));
    });
}

/// Heaters go on heating to their targets, through the fault and after it.
#[test]
fn a_sensor_that_fails_leaves_the_heaters_alone() {
    let mut settings = heated::heated();
    settings.accelerometer.kind = Some(SensorKind::Adxl345);
    let truth = SensorTruth { accident: Some((10_000, SensorAccident::IsUnplugged)), ..modes(&[(0, 48.6, 0.06, 1.0)]) };
    live(&settings, truth, |life| {
        life.say("M104 S60");
        life.say("M140 S40");
        life.rest(2000);
        let before = life.targets();
        life.say(SHORT);
        assert_eq!(life.count("echo:ADXL345 gives no samples"), 1, "{:#?}", life.heard);
        assert_eq!((life.targets(), life.is_halted()), (before, false));
        assert!(before == [60.0, 40.0] && life.celsius() > 25.0, "{before:?} {}", life.celsius());
    });
}

#[test]
fn the_sensor_tells_its_rate_and_its_noise() {
    live(&settings(), SensorTruth { clock: 1.02, ..SensorTruth::default() }, |life| {
        let told = life.ask("M955", "Accelerometer 0: ADXL345, rate ");
        let words: Vec<&str> = told.split(' ').collect();
        near(words[4].trim_end_matches(',').parse().unwrap(), 3264.0, 0.005);
        near(words[7].parse().unwrap(), 100.0, 0.1);
    });
    live(&Settings::prototype(), SensorTruth::default(), |life| {
        life.say("M955");
        assert_eq!(life.count("echo:no accelerometer configured"), 1);
        life.say(SHORT);
        assert_eq!(life.count("echo:swept X; no accelerometer configured"), 1);
        assert_is_back(life);
    });
}

/// Klipper's form: a header, then four columns, the first in seconds.
#[test]
fn raw_samples_are_in_klippers_form() {
    live(&settings(), modes(&[(0, 48.6, 0.06, 1.0)]), |life| {
        for (line, least, most) in [("M956 S500", 500, 540), (&format!("{SHORT} OUTPUT=raw_data")[..], 31_000, 34_000)]
        {
            life.heard.clear();
            life.say(line);
            let begin = life.heard.iter().position(|line| line == "#time,accel_x,accel_y,accel_z").unwrap();
            let rows: Vec<Vec<f64>> = life.heard[begin + 1..]
                .iter()
                .filter(|line| line.contains(','))
                .map(|line| line.split(',').map(|number| number.parse().unwrap()).collect())
                .collect();
            assert!((least..most).contains(&rows.len()), "{line}: {}", rows.len());
            assert!(rows.iter().all(|row| row.len() == 4 && (row[3] - 9806.65).abs() < 1000.0));
            let gaps: Vec<f64> = rows.windows(2).map(|two| two[1][0] - two[0][0]).collect();
            assert!(gaps.iter().all(|gap| (0.0001..0.001).contains(gap)), "{line}");
            let mean = (rows.last().unwrap()[0] - rows[0][0]) / gaps.len() as f64;
            near(1.0 / mean, 3216.0, 0.005);
        }
        near(found(life)[0].0, 48.6, 0.005);
    });
}

/// M410 at 60 Hz: it stops within 0.1 s, the position is the counts', and everything goes on as before.
#[test]
fn a_sweep_that_is_stopped_leaves_the_machine_as_it_was() {
    live(&settings(), modes(&[(0, 48.6, 0.06, 1.0)]), |life| {
        life.say("M593 X F48.6 D0.06 T2");
        life.mark();
        // A second of noise, and 5 s from 50 Hz on by 2 Hz a second.
        life.put(0, "TEST_RESONANCES AXIS=X FREQ_START=50 FREQ_END=70 HZ_PER_SEC=2");
        life.rest(6000);
        let before = life.events().len();
        life.put(0, "M410");
        life.rest(100);
        let stopped = life.events().len();
        assert!(before > 1000 && stopped > before);
        life.rest(1000);
        assert_eq!(life.events().len(), stopped, "it stops within 0.1 s");
        life.forget_answers();
        assert_eq!(life.count("resonance X"), 0);
        let (real, planned) = (life.ask("M114 R", "X:"), life.ask("M114", "X:"));
        assert_eq!(real.split(" Count").next(), planned.split(" Count").next());
        let told: f64 = real.strip_prefix("X:").unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((life.nozzle()[0] - told).abs() < 0.01);
        // Again, from where it stands.
        life.say("G1 X200 F6000");
        life.say(SHORT);
        near(found(life)[0].0, 48.6, 0.005);
        assert_is_back(life);
        // The shaper is in use as before: a stroke takes the time of its taps longer.
        assert!(life.ask("M593", "  M593 X").contains("F48.6 D0.06 T2"), "{:#?}", life.heard);
        life.say("G28");
        assert_eq!(life.count("Error"), 0);
        life.say("G1 X50 Y60 Z10 F6000");
        life.say("M400");
        assert!(
            life.nozzle().iter().zip([50.0, 60.0, 10.0]).all(|(at, to)| (at - to).abs() < 0.01),
            "{:?}",
            life.nozzle()
        );
        assert!(!life.is_halted());
    });
}

/// Twice the same steps, to the tick; with a shaper as without one, and a print behind it as if nothing had been.
#[test]
fn a_sweep_is_the_same_again_and_shaping_is_off_only_in_it() {
    let sweep = |life: &mut Life<'_>| {
        life.say("M400");
        life.mark();
        life.say(SHORT);
        life.events()
    };
    let stroke = |life: &mut Life<'_>| {
        life.say("M400");
        life.mark();
        life.say("G1 X220 Y210 F6000");
        life.say("G1 X200 Y200");
        life.say("M400");
        life.events()
    };
    let mut plain = Vec::new();
    live(&settings(), modes(&[(0, 48.6, 0.06, 1.0)]), |life| {
        plain = sweep(life);
        assert!(plain.len() > 3000);
        assert!(sweep(life) == plain, "again the same");
    });
    live(&settings(), modes(&[(0, 48.6, 0.06, 1.0)]), |life| {
        life.say("M593 X Y F50 D0.1 T3");
        let before = stroke(life);
        // The way back is shaped.
        let alike = plain.iter().zip(sweep(life)).take_while(|(one, other)| **one == *other).count();
        assert!(alike * 4 > plain.len() * 3, "without shaping: {alike} of {}", plain.len());
        assert!(stroke(life) == before, "with shaping again");
    });
}

/// Amplitude of the tool's y in the 60 ms after a stroke along it.
fn ringing(life: &mut Life<'_>) -> f64 {
    life.say("G1 Y230 F6000");
    life.say("M400");
    let all: Vec<f64> = (0..60)
        .map(|_| {
            life.rest(1);
            life.nozzle()[1]
        })
        .collect();
    life.say("G1 Y200");
    life.say("M400");
    life.rest(1000);
    all.iter().copied().fold(f64::MIN, f64::max) - all.iter().copied().fold(f64::MAX, f64::min)
}

/// The belt plant with its own modes, yaw included. The twin says 102.14 Hz for x and 58.45 Hz for y (`corehbot twin
/// modes --model rotors --at 200,200 --gcode-frame` with idlers of 1e-8 kg m2: the plant's have no mass). The suggested
/// line leaves a twentieth of the ringing.
#[test]
fn the_belt_plants_resonance_is_found_and_shaped_away() {
    let settings = settings();
    let start = MIDDLE.map(Mm::from_num);
    let mut desk = Desk::new(1);
    desk.belt = Some(Box::new(BeltPlant::new(&settings, Some(start), true, BeltSetup::default(), 0).unwrap()));
    live_with(&settings, Some(start), (&mut desk, 1), NoStorage, |life| {
        life.say("TEST_RESONANCES AXIS=X FREQ_START=20 FREQ_END=130 HZ_PER_SEC=2");
        life.say("SHAPER_CALIBRATE AXIS=Y FREQ_START=20 FREQ_END=120 HZ_PER_SEC=2");
        let found = found(life);
        assert_eq!(found.len(), 2, "{:#?}", life.heard);
        near(found[0].0, 102.14, 0.005);
        near(found[1].0, 58.45, 0.005);
        let before = ringing(life);
        let line =
            life.heard.iter().find(|line| line.contains("M593 Y")).unwrap().trim_start_matches("echo:").to_owned();
        assert!(line.ends_with(" D0.1 T2"), "{line}");
        assert!(life.ask("M593", "  M593 Y").contains("F0"), "nothing is set by itself");
        life.say(line.trim());
        let after = ringing(life);
        assert!(before > 0.05 && after < 0.05 * before, "{before} {after}");
    });
}

/// Letter, frequency, damping and kind of an M593 line.
fn shaper(line: &str) -> (char, f64, f64, u8) {
    let line = &line[line.find("M593").unwrap()..];
    let number = |letter: char| line.split(' ').find_map(|word| word.strip_prefix(letter)).unwrap();
    let kind = number('T').parse().unwrap();
    (line.as_bytes()[5].into(), number('F').parse().unwrap(), number('D').parse().unwrap(), kind)
}

/// The board's line, and that of `corehbot resonance` for the raw data of the same sweep: the same kind, the frequency
/// within 2 %. The board's windows are twice as long.
#[test]
fn the_board_and_the_command_give_one_answer() {
    let mut settings = settings();
    settings.accelerometer.rate = 800;
    let machines: [&[(usize, f64, f64, f64)]; 4] = [
        &[(0, 48.6, 0.06, 1.0)],
        &[(0, 42.0, 0.05, 0.7), (0, 88.0, 0.08, 0.3)],
        &[(0, 38.0, 0.05, 0.25), (0, 55.0, 0.05, 0.25), (0, 75.0, 0.05, 0.25), (0, 98.0, 0.05, 0.25)],
        &[(0, 30.0, 0.08, 0.5), (0, 70.0, 0.06, 0.5)],
    ];
    for truth in machines {
        live(&settings, modes(truth), |life| {
            life.say("SHAPER_CALIBRATE AXIS=X HZ_PER_SEC=2 OUTPUT=raw_data");
            let own = life.heard.iter().find(|line| line.contains("M593 X")).unwrap().clone();
            let begin = life.heard.iter().position(|line| line.starts_with("#time")).unwrap();
            let is_raw = |line: &&String| line.split(',').count() == 4;
            let rows: Vec<String> = life.heard[begin..].iter().filter(is_raw).cloned().collect();
            let recording = read(rows.join("\n").as_bytes()).unwrap();
            let mut question = Question::default();
            (question.sweep.hz_per_s, question.sweep.accel_per_hz) = (2.0, 34.0);
            let named = Named { file: "x", recording: &recording };
            let measured = measure(named, Some(label::Axis::X), &question.sweep).unwrap();
            let command = judge(Some(label::Axis::X), vec![measured], &question).suggestion.unwrap().line.unwrap();
            let ((axis, hz, damping, kind), known) = (shaper(&own), shaper(&command));
            println!("{own} {command}");
            assert_eq!((axis, damping, kind), (known.0, known.2, known.3), "{own} {command}");
            near(hz, known.1, 0.02);
        });
    }
}
