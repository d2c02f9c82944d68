//! Tests of the TMC2209.

use super::*;
use crate::motors::prototype;

#[test]
fn every_bit_of_a_register_must_be_as_written_and_those_that_size_a_step_are_told_apart() {
    let config = Config::new(prototype::M1, &Settings::prototype());
    for register in [Register::Gconf, Register::Chopconf, Register::Pwmconf, Register::Tpwmthrs] {
        let wanted = config.value(register);
        assert_eq!(Tmc2209::difference(register, wanted, wanted), None);
        for bit in 0..32 {
            // Section 5.1: mstep_reg_select; section 5.5.1: MRES.
            let sizes = matches!((register, bit), (Register::Gconf, 7) | (Register::Chopconf, 24..=27));
            let expected = if sizes { DriverError::Microsteps } else { DriverError::Differs(register.name()) };
            let found = Tmc2209::difference(register, wanted ^ 1 << bit, wanted);
            assert_eq!(found, Some(expected), "{register:?}, bit {bit}");
        }
    }
    // A driver that was reset (CHOPCONF 0x1000_0053) differs in all of it.
    let wanted = config.value(Register::Chopconf);
    assert_eq!(Tmc2209::difference(Register::Chopconf, 0x1000_0053, wanted), Some(DriverError::Microsteps));
}

#[test]
fn the_cause_that_explains_the_others_is_reported() {
    assert_eq!(Tmc2209::error_of_flags(7), Some(DriverError::LostConfiguration));
    assert_eq!(Tmc2209::error_of_flags(6), Some(DriverError::ShutDown));
    assert_eq!(Tmc2209::error_of_flags(4), Some(DriverError::LowSupply));
    assert_eq!(Tmc2209::error_of_flags(0), None);
    for bit in 0..32 {
        let expected = match bit {
            1 => Some(DriverError::OverTemperature),
            2..=5 => Some(DriverError::ShortCircuit),
            _ => None,
        };
        assert_eq!(Tmc2209::error_of_status(1 << bit), expected, "bit {bit}");
    }
}
