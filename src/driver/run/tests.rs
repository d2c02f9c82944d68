//! Tests of run.

use super::*;
use crate::motors::prototype;
use crate::settings::Settings;

fn run(job: Job) -> Run {
    Run::new(prototype::M1, job, Config::new(prototype::M1, &Settings::prototype()), false)
}

#[test]
fn every_bit_of_a_register_must_be_as_written_and_those_that_size_a_step_are_told_apart() {
    let run = run(Job::Verify);
    for register in [Register::Gconf, Register::Chopconf, Register::Pwmconf, Register::Tpwmthrs] {
        let wanted = run.config.value(register);
        assert_eq!(run.difference(register, wanted), None);
        for bit in 0..32 {
            // Section 5.1: mstep_reg_select; section 5.5.1: MRES.
            let sizes = matches!((register, bit), (Register::Gconf, 7) | (Register::Chopconf, 24..=27));
            let expected = if sizes { DriverError::Microsteps } else { DriverError::Differs(register) };
            assert_eq!(run.difference(register, wanted ^ 1 << bit), Some(expected), "{register:?}, bit {bit}");
        }
    }
    // A driver that was reset (CHOPCONF 0x1000_0053) differs in all of it.
    assert_eq!(run.difference(Register::Chopconf, 0x1000_0053), Some(DriverError::Microsteps));
}

#[test]
fn a_configuration_is_begun_anew_three_times_and_only_where_that_may_help() {
    let again = |job, error| {
        let mut run = run(job);
        (0..10).take_while(|_| run.fail(error) == Next::Exchange).count()
    };
    let written = [DriverError::NotTaken, DriverError::Differs(Register::Gconf), DriverError::Microsteps];
    for error in written {
        assert_eq!((again(Job::Verify, error), again(Job::Adjust, error)), (3, 3), "{error:?}");
        assert_eq!((again(Job::Poll, error), again(Job::Read, error)), (0, 0), "{error:?}");
    }
    // The flags of a driver with power are not cleared, so they remain; without power they may be old.
    for error in [DriverError::LostConfiguration, DriverError::ShortCircuit] {
        assert_eq!((again(Job::Verify, error), again(Job::Adjust, error)), (3, 0), "{error:?}");
    }
    assert_eq!(again(Job::Verify, DriverError::WrongChip(0x20)), 0, "it stays another chip");
}
