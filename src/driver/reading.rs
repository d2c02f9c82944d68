//! A reading: what a driver says of itself, for a report.

use super::config::microsteps;
use super::error::DriverError;
use super::registers::{Register, drv_status, gconf};

/// What a driver said.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Reading {
    pub(super) flags: u32,
    gconf: u32,
    chopconf: u32,
    pub(super) status: u32,
    stall: u32,
    count: u32,
}

impl Reading {
    pub(super) fn note(&mut self, register: Register, value: u32) {
        match register {
            Register::Gstat => self.flags = value,
            Register::Gconf => self.gconf = value,
            Register::Chopconf => self.chopconf = value,
            Register::DrvStatus => self.status = value,
            Register::SgResult => self.stall = value,
            Register::Ifcnt => self.count = value,
            _ => {}
        }
    }

    /// Microsteps of a full step; `None` if its pins decide.
    #[must_use]
    pub const fn microsteps(&self) -> Option<u32> {
        if self.gconf & gconf::MSTEP_REG_SELECT == 0 { None } else { Some(microsteps(self.chopconf)) }
    }

    /// Its chopper mode at low speed.
    #[must_use]
    pub const fn mode(&self) -> &'static str {
        if self.gconf & gconf::EN_SPREADCYCLE == 0 { "stealthChop" } else { "spreadCycle" }
    }

    /// Whether it is so hot that it may soon switch itself off.
    #[must_use]
    pub const fn is_hot(&self) -> bool {
        self.status & drv_status::OTPW != 0
    }

    /// How warm it is.
    #[must_use]
    pub const fn temperature(&self) -> &'static str {
        match self.status {
            s if s & drv_status::T157 != 0 => "above 157 C",
            s if s & drv_status::T150 != 0 => "above 150 C",
            s if s & drv_status::T143 != 0 => "above 143 C",
            s if s & drv_status::T120 != 0 => "above 120 C",
            _ => "below 120 C",
        }
    }

    /// Whether a coil seems to be open, which is true only of a motor that turns slowly.
    #[must_use]
    pub const fn seems_open(&self) -> bool {
        self.status & drv_status::OPEN_LOADS != 0
    }

    /// StallGuard's result: the smaller, the greater the load. It means something in stealthChop only.
    #[must_use]
    pub const fn stall(&self) -> u32 {
        self.stall
    }

    /// Writes that it has accepted, modulo 256.
    #[must_use]
    pub const fn writes(&self) -> u32 {
        self.count
    }

    /// What is wrong with it, apart from its registers.
    #[must_use]
    pub const fn problem(&self) -> Option<DriverError> {
        match DriverError::from_status(self.status) {
            None => DriverError::from_flags(self.flags),
            found => found,
        }
    }
}
