//! Changes: new settings for drivers of motors with power.

use super::bench::{Bench, CHOPCONF, Z1};
use corehbot::driver::{Chip, DriverError, Fault, News, Register, Tmc2209};
use corehbot::motors::{MotorName, MotorSet, prototype};
use corehbot::settings::Settings;

#[test]
fn other_settings_reach_a_motor_with_power_and_other_microsteps_forbid_driving_until_then() {
    let mut bench = Bench::new();
    let mut settings = Settings::prototype();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    settings.drivers.z.current_ma = 500;
    bench.drivers.want(&settings);
    assert!(!bench.drivers.is_configured() && bench.drivers.is_drivable());
    bench.run(50);
    assert!(bench.drivers.is_configured());
    settings.drivers.z.microsteps = 32;
    bench.drivers.want(&settings);
    assert!(!bench.drivers.is_drivable());
    bench.run(50);
    assert!(bench.drivers.is_drivable() && bench.drivers.is_configured());
    assert_eq!(bench.drivers.known(prototype::Z1).0.unwrap().microsteps, 32);
}

#[test]
fn a_motor_with_power_that_does_not_take_its_new_settings_is_a_fault() {
    let mut bench = Bench::new();
    let mut settings = Settings::prototype();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    bench.bus.lost = Some(Register::IholdIrun as usize);
    settings.drivers.z.current_ma = 500;
    bench.drivers.want(&settings);
    bench.run(300);
    let fault = Fault { motor: prototype::Z1, name: MotorName::lit("z1"), error: DriverError::NotTaken };
    assert_eq!((bench.news.as_slice(), bench.drivers.fault()), (&[News::Stopped(fault)][..], Some(fault)));
    assert_eq!((bench.bus.powered, bench.drivers.powered()), (MotorSet::NONE, MotorSet::NONE));
}

#[test]
fn a_driver_that_holds_something_else_is_written_anew() {
    let mut bench = Bench::new();
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    let config = Tmc2209::config(prototype::Z1, &Settings::prototype());
    bench.bus.registers[CHOPCONF] = 0x1000_0053;
    assert_eq!(bench.verify(prototype::Z1), Ok(()));
    assert_eq!(bench.bus.registers[CHOPCONF], Tmc2209::value(&config, Register::Chopconf));
}

#[test]
fn under_power_no_flag_is_cleared_however_often_a_change_is_written() {
    let mut bench = Bench::powered();
    let mut settings = Settings::prototype();
    settings.drivers.z.current_ma = 500;
    bench.bus.lost = Some(Register::IholdIrun as usize);
    bench.drivers.want(&settings);
    bench.run_until(|bench| bench.count(0x90) == 2);
    bench.bus.lost = None;
    bench.run(100);
    assert!(bench.drivers.is_configured());
    assert_eq!((bench.count(0x81), bench.news.as_slice()), (0, &[][..]));
}
