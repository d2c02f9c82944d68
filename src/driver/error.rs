//! Errors of a driver, with their remedies.

use crate::motors::{Motor, MotorName};
use core::fmt;

/// Error of a driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DriverError {
    /// It does not answer.
    Silent,
    /// It replies, but each reply is damaged.
    Garbled,
    /// It did not accept every write.
    NotTaken,
    /// It accepted the writes, but the register of this name has another value.
    Differs(&'static str),
    /// It makes another number of microsteps than the settings require.
    Microsteps,
    /// It was reset, and is configured by its pins.
    LostConfiguration,
    /// It is not the chip of this name, but one with this version.
    WrongChip(&'static str, u8),
    /// A coil is shorted to ground or to the supply.
    ShortCircuit,
    /// It has switched itself off because it is too hot.
    OverTemperature,
    /// It has switched itself off, and no longer reports the reason.
    ShutDown,
    /// Its charge pump fails, so the motor has no current.
    LowSupply,
}

impl fmt::Display for DriverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => put!(f, "does not answer: is the motor supply on, its jumper set to UART?"),
            Self::Garbled => put!(f, "answers, but the answer is damaged: check its UART wire"),
            Self::NotTaken => put!(f, "did not accept its configuration: check its UART wire"),
            Self::Differs(register) => put!(f, "holds a different {register} than the firmware wrote"),
            Self::Microsteps => put!(f, "uses different microsteps than the firmware wrote"),
            Self::LostConfiguration => put!(f, "was reset and lost its configuration: check the motor supply"),
            Self::WrongChip(chip, version) => put!(f, "is not a {chip}: its version is {version:#04x}"),
            Self::ShortCircuit => put!(f, "reports a short circuit: check the motor and its cable"),
            Self::OverTemperature => put!(f, "was too hot and switched itself off: cool it, or lower M906"),
            Self::ShutDown => put!(f, "had switched itself off: heat or a short circuit"),
            Self::LowSupply => put!(f, "reports a low supply voltage: check the motor supply"),
        }
    }
}

impl core::error::Error for DriverError {}

/// An error of one driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Fault {
    /// The driver's motor.
    pub motor: Motor,
    /// The name of that motor.
    pub name: MotorName,
    /// Its error.
    pub error: DriverError,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        put!(f, "driver of motor {} {}", self.name, self.error)
    }
}

impl core::error::Error for Fault {}

/// News that the Console must have at once.
#[must_use]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum News {
    /// A driver failed: the motion must end at once, and then [`Drivers::cut`](super::Drivers::cut) must follow. In
    /// this order no step is made without power.
    Stopped(Fault),
    /// A driver is hot, and still at work. Reported once.
    Hot(Motor),
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::motors::prototype;
    use std::string::ToString;

    #[test]
    fn a_fault_names_the_motor_and_what_to_do() {
        let fault = Fault { motor: prototype::M8, name: MotorName::lit("m8"), error: DriverError::Silent };
        assert_eq!(
            fault.to_string(),
            "driver of motor m8 does not answer: is the motor supply on, its jumper set to UART?"
        );
        let fault = Fault { motor: prototype::Z2, name: MotorName::lit("z2"), error: DriverError::Differs("PWMCONF") };
        assert_eq!(fault.to_string(), "driver of motor z2 holds a different PWMCONF than the firmware wrote");
    }
}
