//! The TMC2209 by Trinamic, on a UART with one wire (datasheet rev 1.09).

mod config;
mod datagram;
mod registers;
mod scripts;
mod shown;

pub use config::Config;
pub use registers::Register;

use super::chip::{Chip, Held, Scripts, Shown};
use super::error::DriverError;
use super::reading::Reading;
use crate::motors::Motor;
use crate::port::Frame;
use crate::settings::Settings;
use registers::{chopconf, drv_status, gconf, gstat, ioin};

/// The TMC2209.
#[derive(Clone, Copy, Debug)]
pub struct Tmc2209;

impl Chip for Tmc2209 {
    type Register = Register;
    type Config = Config;

    const SCRIPTS: Scripts<Register> = scripts::SCRIPTS;

    fn config(motor: Motor, settings: &Settings) -> Config {
        Config::new(motor, settings)
    }

    fn value(config: &Config, register: Register) -> u32 {
        config.value(register)
    }

    fn held(config: &Config) -> Held {
        config.held()
    }

    fn read(register: Register) -> (Frame, usize) {
        (datagram::read(register), datagram::REPLY)
    }

    fn write(register: Register, value: u32) -> (Frame, usize) {
        (datagram::write(register, value), 0)
    }

    fn reply(reply: &[u8], register: Register) -> Option<u32> {
        datagram::value(reply, register)
    }

    fn other_chip(value: u32) -> Option<DriverError> {
        let version = value >> ioin::VERSION;
        (version != ioin::TMC2209).then_some(DriverError::WrongChip("TMC2209", version as u8))
    }

    fn error_of_flags(flags: u32) -> Option<DriverError> {
        if flags & gstat::RESET != 0 {
            Some(DriverError::LostConfiguration)
        } else if flags & gstat::DRV_ERR != 0 {
            Some(DriverError::ShutDown)
        } else if flags & gstat::UV_CP != 0 {
            Some(DriverError::LowSupply)
        } else {
            None
        }
    }

    fn error_of_status(status: u32) -> Option<DriverError> {
        if status & drv_status::SHORTS != 0 {
            Some(DriverError::ShortCircuit)
        } else if status & drv_status::OT != 0 {
            Some(DriverError::OverTemperature)
        } else {
            None
        }
    }

    fn difference(register: Register, value: u32, wanted: u32) -> Option<DriverError> {
        let decides = match register {
            Register::Gconf => gconf::MSTEP_REG_SELECT,
            Register::Chopconf => 0xF << chopconf::MRES,
            _ => 0,
        };
        if value == wanted {
            None
        } else if (value ^ wanted) & decides != 0 {
            Some(DriverError::Microsteps)
        } else {
            Some(DriverError::Differs(register.name()))
        }
    }

    fn note(reading: &mut Reading, register: Register, value: u32) {
        shown::note(reading, register, value);
    }

    fn shown(reading: &Reading) -> Shown {
        shown::shown(reading)
    }
}

#[cfg(test)]
mod tests;
