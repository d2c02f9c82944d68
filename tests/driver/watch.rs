//! The watch: the faults that it finds in drivers with power, how soon, and the reaction.

use super::bench::{Bench, GSTAT, Z1};
use corehbot::driver::{DriverError, DriverJob, Fault, News, Register};
use corehbot::motors::{MotorName, MotorSet, prototype};
use corehbot::port::BusError;
use corehbot::settings::Settings;

#[test]
fn silence_is_believed_after_four_tries() {
    for (silent, expected) in [(3, Ok(())), (4, Err(DriverError::Silent))] {
        let mut bench = Bench::new();
        bench.bus.mishaps = (1..=silent).map(|n| (n, Err(BusError::Silent))).collect();
        assert_eq!(bench.verify(prototype::M1), expected);
        assert_eq!(bench.drivers.known(prototype::M1).1, silent as u16);
    }
}

#[test]
fn registers_of_drivers_with_power_are_read_in_turn_a_hundred_and_twenty_times_a_second() {
    let mut bench = Bench::new();
    for motor in [prototype::Z1, prototype::Z2] {
        assert_eq!(bench.verify(motor), Ok(()));
        let on = bench.drivers.powered().with(MotorSet::of(motor));
        assert_eq!(bench.power(on), Ok(()));
    }
    bench.run(100);
    bench.bus.requests.clear();
    bench.run(1000);
    assert!((120..=126).contains(&bench.bus.requests.len()), "{}", bench.bus.requests.len());
    // DRV_STATUS, GSTAT and CHOPCONF of one, and then of the other.
    let begin = bench.bus.requests.iter().position(|(_, bytes)| bytes[2] == 0x6F).unwrap();
    let both: Vec<_> = bench.bus.requests[begin..].chunks_exact(3).collect();
    for each in &both {
        let registers: Vec<u8> = each.iter().map(|(_, bytes)| bytes[2]).collect();
        assert_eq!(registers, [0x6F, 0x01, 0x6C]);
        assert!(each.iter().all(|(motor, _)| *motor == each[0].0));
    }
    assert!(both.windows(2).all(|pair| pair[0][0].0 != pair[1][0].0));
    assert_eq!(bench.news, []);
}

#[test]
fn a_fault_takes_the_power_from_all_and_stays() {
    let mut bench = Bench::new();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    bench.bus.registers[GSTAT] = 1;
    bench.run(110);
    let fault = Fault { motor: prototype::Z1, name: MotorName::lit("z1"), error: DriverError::LostConfiguration };
    assert_eq!((bench.bus.powered, bench.drivers.powered()), (MotorSet::NONE, MotorSet::NONE));
    assert_eq!((bench.news.as_slice(), bench.drivers.fault()), (&[News::Stopped(fault)][..], Some(fault)));
    assert_eq!(bench.power(MotorSet::NONE), Ok(()));
    let before = bench.bus.requests.len();
    bench.run(500);
    bench.drivers.ask(DriverJob::Read, prototype::Z2);
    bench.run(500);
    assert_eq!(bench.bus.requests.len(), before, "nobody talks any more");
}

#[test]
fn on_a_slow_wire_polls_and_what_is_asked_take_turns() {
    let mut bench = Bench::powered();
    // A poll takes 45 ms, so that the next one is due when it ends.
    bench.bus.slowness = 15;
    let mut answers = 0;
    for _ in 0..30 {
        bench.drivers.ask(DriverJob::Read, prototype::Z2);
        for _ in 0..300 {
            bench.run(1);
            if let Some(answer) = bench.drivers.answer() {
                assert!(answer.is_ok());
                answers += 1;
                break;
            }
        }
    }
    assert_eq!(answers, 30);
    let of = |wanted| bench.bus.requests.iter().filter(|(motor, _)| *motor == wanted).count();
    let (looks, reads) = (of(prototype::Z1), of(prototype::Z2));
    assert!(reads == 6 * 30 && looks.abs_diff(reads) <= 30, "{looks} {reads}");
    // Even with continuous requests, motors with power are polled.
    bench.bus.requests.clear();
    for _ in 0..1000 {
        bench.drivers.ask(DriverJob::Read, prototype::Z2);
        bench.run(1);
    }
    assert!(bench.bus.requests.iter().filter(|(motor, bytes)| *motor == prototype::Z1 && bytes[2] == 1).count() > 5);
    // And a change gets its turn: every second exchange, after the six of a report under way. It has eighteen.
    let mut settings = Settings::prototype();
    settings.drivers.z.current_ma = 500;
    bench.drivers.want(&settings);
    bench.run(2 * (6 + 18) * 15);
    assert!(bench.drivers.is_configured());
}

#[test]
fn what_a_look_finds_after_the_power_has_gone_is_no_fault() {
    let mut bench = Bench::powered();
    bench.bus.registers[GSTAT] = 1;
    bench.run_until(|bench| bench.count(GSTAT as u8) > 0);
    bench.drivers.cut(&mut bench.bus);
    bench.run(100);
    assert_eq!((bench.news.as_slice(), bench.drivers.fault()), (&[][..], None));
    assert_eq!(bench.drivers.known(prototype::Z1).0, None, "but it has everything to prove");
}

#[test]
fn heat_is_reported_once() {
    let mut bench = Bench::powered();
    bench.run(100);
    assert_eq!(bench.news, []);
    // The pre-warning, bit 0 of DRV_STATUS.
    bench.bus.registers[Register::DrvStatus as usize] = 1;
    bench.run(500);
    assert_eq!(bench.news, [News::Hot(prototype::Z1)]);
    assert_eq!(bench.bus.powered, Z1, "it is still at work");
}

/// The four motors of a belt, all others too.
fn belt() -> Bench {
    let mut bench = Bench::new();
    bench.drivers.watch_closely(prototype::BELT);
    for motor in prototype::ALL.iter() {
        assert_eq!(bench.verify(motor), Ok(()));
        let on = bench.drivers.powered().with(MotorSet::of(motor));
        assert_eq!(bench.power(on), Ok(()));
    }
    // As long as at 19,200 baud.
    bench.bus.slowness = 8;
    bench.run(200);
    bench
}

#[test]
fn a_belt_motor_without_supply_is_noticed_within_100_ms_whenever_it_fails_and_whatever_else_goes_on() {
    let mut worst = 0;
    for wait in 0..64 {
        for is_busy in [false, true] {
            let mut bench = belt();
            if is_busy {
                bench.drivers.ask(DriverJob::Read, prototype::E0);
            }
            bench.run(wait);
            let motor = [prototype::M1, prototype::M4, prototype::M8, prototype::M11][wait as usize % 4];
            bench.bus.silent = MotorSet::of(motor);
            let begin = bench.ms;
            while bench.news.is_empty() && bench.ms < begin + 1000 {
                bench.run(1);
            }
            assert_eq!(
                bench.news,
                [News::Stopped(Fault {
                    motor,
                    name: Settings::prototype().name_of(motor),
                    error: DriverError::Silent
                })]
            );
            worst = worst.max(bench.ms - begin);
        }
    }
    assert!(worst <= 100, "{worst} ms");
    println!("noticed after {worst} ms at most");
}

#[test]
fn why_a_driver_has_switched_itself_off_is_asked_before_it_is_told() {
    let status = Register::DrvStatus as usize;
    for (said, error) in
        [(0, DriverError::ShutDown), (1 << 3, DriverError::ShortCircuit), (1 << 1, DriverError::OverTemperature)]
    {
        let mut bench = belt();
        (bench.bus.registers[GSTAT], bench.bus.registers[status]) = (2, said);
        let begin = bench.ms;
        while bench.news.is_empty() && bench.ms < begin + 1000 {
            bench.run(1);
        }
        assert!(matches!(bench.news[..], [News::Stopped(fault)] if fault.error == error), "{:?}", bench.news);
        // All drivers say so here, so the next look finds it.
        assert!(bench.ms - begin <= 64, "{} ms", bench.ms - begin);
    }
}

#[test]
fn after_a_fault_the_others_go_on_and_are_looked_at_at_once() {
    let mut bench = belt();
    bench.is_limping = true;
    bench.bus.silent = MotorSet::of(prototype::M8);
    while bench.news.is_empty() {
        bench.run(1);
    }
    let others = prototype::ALL.without(MotorSet::of(prototype::M8));
    assert_eq!((bench.bus.powered, bench.drivers.powered(), bench.drivers.are_unseen()), (others, others, true));
    bench.run(56);
    assert!(!bench.drivers.are_unseen(), "six looks of 8 ms");
    // Nothing is changed, proved or powered any more.
    let mut settings = Settings::prototype();
    settings.drivers.belt.current_ma = 500;
    bench.drivers.want(&settings);
    bench.bus.requests.clear();
    bench.run(200);
    assert!(bench.bus.requests.iter().all(|(motor, bytes)| bytes.len() == 4 && *motor != prototype::M8));
    assert_eq!(bench.power(others.with(MotorSet::of(prototype::M8))), Err(prototype::M8));
    assert_eq!(bench.bus.powered, others);
    // A second fault is reported, and the first one stays the reason.
    bench.bus.silent = MotorSet::of(prototype::M8).with(MotorSet::of(prototype::M1));
    bench.is_limping = false;
    bench.run(100);
    let [first, second] = [prototype::M8, prototype::M1].map(|motor| Fault {
        motor,
        name: Settings::prototype().name_of(motor),
        error: DriverError::Silent,
    });
    assert_eq!(bench.news, [News::Stopped(first), News::Stopped(second)]);
    assert_eq!((bench.drivers.fault(), bench.bus.powered), (Some(first), MotorSet::NONE));
}

#[test]
fn a_motor_that_pulls_against_nobody_is_noticed_no_later_than_it_was() {
    let mut worst = 0;
    for wait in 0..200 {
        let mut bench = belt();
        bench.run(wait);
        let motor = [prototype::Z1, prototype::Z2, prototype::E0][wait as usize % 3];
        bench.bus.silent = MotorSet::of(motor);
        let begin = bench.ms;
        while bench.news.is_empty() && bench.ms < begin + 1000 {
            bench.run(1);
        }
        assert_eq!(
            bench.news,
            [News::Stopped(Fault { motor, name: Settings::prototype().name_of(motor), error: DriverError::Silent })]
        );
        worst = worst.max(bench.ms - begin);
    }
    // A poll at least every 175 ms, and four tries.
    assert!(worst <= 175 + 4 * 8, "{worst} ms");
    println!("noticed after {worst} ms at most");
}
