//! Tests of config.

use super::*;
use crate::motors::prototype;
use crate::settings::ranges;
use crate::units::MmPerSec;

fn config(change: impl FnOnce(&mut DriverSettings)) -> Config {
    let mut s = Settings::prototype();
    change(&mut s.drivers.belt);
    Config::new(prototype::M8, &s)
}

#[test]
fn every_current_is_met_as_well_as_the_chip_can() {
    for ma in ranges::CURRENT_MA.least..=ranges::CURRENT_MA.most {
        let config = config(|d| d.current_ma = ma);
        // Half a step of the scale: 1768 or 979 mA over 64.
        let half = if ma < 980 { 15.4 } else { 27.7 };
        let scale = (config.value(Register::IholdIrun) >> 8) & 0x1F;
        let volts = if config.chopconf & chopconf::VSENSE == 0 { 0.325 } else { 0.180 };
        let exact = f64::from(scale + 1) / 32.0 * volts / 0.130 / 2f64.sqrt() * 1000.0;
        assert!((exact - f64::from(ma)).abs() < half, "{ma} mA became {exact}");
        assert!((exact - f64::from(config.held().run_ma)).abs() < 1.0);
    }
}

#[test]
fn the_fields_are_where_the_datasheet_has_them() {
    let c = config(|_| ());
    assert_eq!(c.value(Register::Gconf), 0b1_1100_0100);
    // INTPOL, MRES 4, VSENSE, TBL 2, HEND 0, HSTRT 5, TOFF 3.
    assert_eq!(c.value(Register::Chopconf), 0x1403_0053);
    // 800 mA: 32 * 0.8 * 0.13 * 1.414 / 0.18 = 26.1, less one; half of it at rest.
    assert_eq!(c.value(Register::IholdIrun), 8 << 16 | 25 << 8 | 12);
    assert_eq!(config(|d| d.stealth = true).value(Register::Gconf), 0b1_1100_0000);
    for (microsteps, mres) in [(1, 8), (2, 7), (16, 4), (128, 1), (256, 0)] {
        let chopconf = config(|d| d.microsteps = microsteps).chopconf;
        assert_eq!((chopconf >> 24) & 0xF, mres);
        assert_eq!(super::microsteps(chopconf), u32::from(microsteps));
    }
    assert_eq!(config(|d| d.interpolate = false).value(Register::Chopconf), 0x0403_0053);
    assert_eq!(config(|d| d.hold_percent = 0).value(Register::IholdIrun) & 0x1F, 0);
    // 13 of the 26 parts of 795 mA.
    assert_eq!((c.held().run_ma, c.held().hold_ma), (795, 397));
    assert_eq!(config(|d| d.stall_threshold = 9).value(Register::Tcoolthrs), SLOWEST);
}

#[test]
fn every_register_that_is_written_has_its_value() {
    let c = config(|d| d.stall_threshold = 9);
    // Section 5.5.2: PWM_LIM 12, PWM_REG 8, no freewheeling, autograd, autoscale, PWM_FREQ 1, PWM_GRAD 14, PWM_OFS 36.
    let pwm = 12 << 28 | 8 << 24 | 1 << 19 | 1 << 18 | 1 << 16 | 14 << 8 | 36;
    for (register, value) in [
        (Register::Tpowerdown, 20),
        (Register::Sgthrs, 9),
        (Register::Pwmconf, pwm),
        // All flags are cleared; the driver steps by its input, without coolStep, and replies at once.
        (Register::Gstat, 0b111),
        (Register::Vactual, 0),
        (Register::Coolconf, 0),
        (Register::Slaveconf, 0),
    ] {
        assert_eq!(c.value(register), value, "{register:?}");
    }
    assert_eq!(config(|_| ()).value(Register::Tcoolthrs), 0, "no stall is looked for");
    assert_eq!(c.held().microsteps, 16);
}

#[test]
fn the_threshold_is_a_time_between_two_of_256_steps() {
    // 100 mm/s are 8,000 steps, 128,000 of the finest: 93.75 clocks.
    let at = |v: u16| config(|d| d.hybrid_threshold = MmPerSec::from_num(v)).value(Register::Tpwmthrs);
    assert_eq!((at(0), at(100), at(3000)), (0, 93, 3));
    // The other way round: 93 clocks are 8,064 steps a second.
    let rate = |v: u16| config(|d| d.hybrid_threshold = MmPerSec::from_num(v)).held().quiet_steps_per_s;
    assert_eq!((rate(0), rate(100)), (None, Some(8064)));
    let slow = config(|d| d.hybrid_threshold = MmPerSec::lit("0.005"));
    assert_eq!(slow.value(Register::Tpwmthrs), SLOWEST);
}

#[test]
fn each_motor_has_the_settings_of_its_group() {
    let s = Settings::prototype();
    assert_eq!(Config::new(prototype::M1, &s), Config::new(prototype::M11, &s));
    assert_ne!(Config::new(prototype::Z1, &s), Config::new(prototype::M1, &s));
    assert_eq!(Config::new(prototype::Z1, &s), Config::new(prototype::Z2, &s));
}
