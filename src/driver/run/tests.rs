//! Tests of run.

use super::*;
use crate::driver::tmc2209::Tmc2209;
use crate::motors::prototype;
use crate::settings::Settings;

fn run(job: DriverJob) -> Run<Tmc2209> {
    Run::new(prototype::M1, job, Tmc2209::config(prototype::M1, &Settings::prototype()), false)
}

#[test]
fn a_configuration_is_begun_anew_three_times_and_only_where_that_may_help() {
    let again = |job, error| {
        let mut run = run(job);
        (0..10).take_while(|_| run.fail(error) == Next::Exchange).count()
    };
    let written = [DriverError::NotTaken, DriverError::Differs("GCONF"), DriverError::Microsteps];
    for error in written {
        assert_eq!((again(DriverJob::Verify, error), again(DriverJob::Adjust, error)), (3, 3), "{error:?}");
        assert_eq!((again(DriverJob::Poll, error), again(DriverJob::Read, error)), (0, 0), "{error:?}");
    }
    // The flags of a driver with power are not cleared, so they remain; without power they may be old.
    for error in [DriverError::LostConfiguration, DriverError::ShortCircuit] {
        assert_eq!((again(DriverJob::Verify, error), again(DriverJob::Adjust, error)), (3, 0), "{error:?}");
    }
    assert_eq!(again(DriverJob::Verify, DriverError::WrongChip("TMC2209", 0x20)), 0, "it stays another chip");
}
