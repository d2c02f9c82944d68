//! Proof: no motor gets power before its driver has shown that it holds its settings.

use super::bench::{Bench, CHOPCONF, IFCNT, Z1};
use corehbot::driver::{Chip, DriverError, DriverJob, Drivers, Reading, Register, Tmc2209};
use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;

#[test]
fn the_flags_are_cleared_before_anything_is_counted_and_read_after_everything() {
    let mut bench = Bench::new();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    let registers: Vec<u8> = bench.bus.requests.iter().map(|(_, bytes)| bytes[2]).collect();
    let writes = [0x80, 0x90, 0x91, 0x93, 0x94, 0xA2, 0xC0, 0xC2, 0xEC, 0xF0];
    let (begin, end) = ([0x83, 0x06, 0x81, 0x02], [0x02, 0x00, 0x6C, 0x70, 0x01]);
    assert_eq!(registers, [&begin[..], &writes, &end].concat());
    let config = Tmc2209::config(prototype::Z1, &Settings::prototype());
    assert_eq!(bench.drivers.known(prototype::Z1), (Some(Tmc2209::held(&config)), 0));
    assert_eq!(bench.bus.registers[CHOPCONF], Tmc2209::value(&config, Register::Chopconf));
}

#[test]
fn power_needs_a_proof_of_every_driver_and_the_proof_must_be_new() {
    let mut bench = Bench::new();
    assert_eq!(bench.power(Z1), Err(prototype::Z1));
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.power(prototype::Z), Err(prototype::Z2));
    assert_eq!(bench.bus.powered, MotorSet::NONE);
    bench.run(510);
    assert_eq!(bench.power(Z1), Err(prototype::Z1), "too old");
    let before = bench.bus.requests.len();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.bus.requests.len() - before, 3, "a quick proof");
    assert_eq!(bench.power(Z1), Ok(()));
    assert_eq!(bench.bus.powered, Z1);
    // A proof is good for one time.
    assert_eq!(bench.power(MotorSet::NONE), Ok(()));
    assert_eq!(bench.power(Z1), Err(prototype::Z1));
}

#[test]
fn a_count_that_wraps_is_right_and_one_that_does_not_fit_is_not() {
    let mut bench = Bench::new();
    bench.bus.registers[IFCNT] = 250;
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    let mut bench = Bench::new();
    bench.bus.lost = Some(Register::IholdIrun as usize);
    assert_eq!(bench.verify(prototype::Z1), Err(DriverError::NotTaken));
    let counts = bench.bus.requests.iter().filter(|(_, bytes)| bytes[2] == IFCNT as u8).count();
    assert_eq!(counts, 4 * 3, "four rounds, and the wrong count was read twice in each");
}

#[test]
fn a_driver_that_is_being_written_has_proved_nothing() {
    let mut bench = Bench::new();
    let old = Settings::prototype();
    let mut new = old;
    new.drivers.z.current_ma = 500;
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    // A change under power proves its writes; the next change is under way when it is withdrawn.
    bench.drivers.want(&new);
    bench.run(60);
    assert!(bench.drivers.is_configured());
    bench.drivers.want(&old);
    bench.run_until(|bench| bench.count(0x90) == 3);
    bench.drivers.want(&new);
    bench.drivers.cut(&mut bench.bus);
    assert_eq!(
        bench.drivers.known(prototype::Z1).0,
        Some(Tmc2209::held(&Tmc2209::config(prototype::Z1, &new))),
        "held as far as is known"
    );
    assert_eq!(bench.power(Z1), Err(prototype::Z1), "but the old current is on its way");
}

#[test]
fn an_answer_goes_to_the_last_who_asked() {
    let mut bench = Bench::new();
    bench.drivers.ask(DriverJob::Verify, prototype::M1);
    bench.run(5);
    bench.drivers.ask(DriverJob::Read, prototype::M4);
    bench.run(100);
    let reading = bench.drivers.answer().unwrap().unwrap();
    assert_eq!(bench.drivers.shown(&reading).microsteps, Some(16));
    assert!(bench.drivers.known(prototype::M1).0.is_some(), "the first job was done all the same");
    assert_eq!(bench.drivers.answer(), None);
}

#[test]
fn a_proof_is_used_up_by_the_motor_that_gets_power_and_by_no_other() {
    let mut bench = Bench::new();
    for motor in [prototype::Z1, prototype::Z2] {
        assert_eq!(bench.verify(motor), Ok(()));
    }
    assert_eq!(bench.power(Z1), Ok(()));
    assert_eq!(bench.power(prototype::Z), Ok(()), "Z2 has proved itself as well");
    bench.drivers.cut(&mut bench.bus);
    assert_eq!(bench.power(Z1), Err(prototype::Z1));
}

#[test]
fn while_a_driver_is_written_it_holds_nothing_that_counts() {
    let mut bench = Bench::new();
    let old = Settings::prototype();
    let mut new = old;
    new.drivers.z.current_ma = 500;
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    bench.drivers.want(&new);
    bench.drivers.ask(DriverJob::Verify, prototype::Z1);
    bench.run(10);
    assert_eq!(bench.drivers.known(prototype::Z1).0, None, "without power all is written anew");

    let mut bench = Bench::powered();
    new.drivers.z.microsteps = 32;
    bench.drivers.want(&new);
    bench.run_until(|bench| bench.count(0xEC) > 0);
    bench.drivers.want(&old);
    assert!(!bench.drivers.is_drivable(), "the old microsteps are wanted, the new ones on their way");
    bench.run(100);
    assert!(bench.drivers.is_drivable() && bench.drivers.is_configured());
}

#[test]
fn nobody_asks_a_driver_without_a_wire_or_configures_one_whose_motor_has_power() {
    let settings = Settings::prototype();
    let mut bench = Bench::new();
    bench.drivers = Drivers::new(prototype::Z, &settings);
    for job in [DriverJob::Verify, DriverJob::Read] {
        bench.drivers.ask(job, prototype::M1);
        bench.run(10);
        assert_eq!(bench.drivers.answer(), Some(Ok(Reading::default())), "{job:?}");
    }
    assert_eq!(bench.bus.requests, []);
    let mut bench = Bench::powered();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.count(0x81), 0, "its flags stay");
    bench.drivers.ask(DriverJob::Read, prototype::Z1);
    bench.run(100);
    let reading = bench.drivers.answer().unwrap().unwrap();
    assert_eq!(bench.drivers.shown(&reading).microsteps, Some(16), "but it may be read");
}
