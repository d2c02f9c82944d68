//! Registers: the few of the TMC2209 that the firmware uses (datasheet rev 1.09, section 5).

/// A register by its name in the datasheet.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Register {
    /// Global configuration (5.1).
    Gconf = 0x00,
    /// Global status; a 1 that is written clears a flag (5.1).
    Gstat = 0x01,
    /// Counts the writes that were accepted, modulo 256 (5.1).
    Ifcnt = 0x02,
    /// Time between request and reply (5.1).
    Slaveconf = 0x03,
    /// Inputs and version (5.1).
    Ioin = 0x06,
    /// Hold and run current (5.2).
    IholdIrun = 0x10,
    /// Time at rest until the current falls (5.2).
    Tpowerdown = 0x11,
    /// Speed above which stealthChop changes to spreadCycle (5.2).
    Tpwmthrs = 0x13,
    /// Speed below which StallGuard is inactive (5.3).
    Tcoolthrs = 0x14,
    /// Speed of the driver's own pulse generator (5.2).
    Vactual = 0x22,
    /// StallGuard threshold (5.3).
    Sgthrs = 0x40,
    /// StallGuard result (5.3).
    SgResult = 0x41,
    /// coolStep (5.3).
    Coolconf = 0x42,
    /// The driver's position in its sine table: 1024 are an electrical turn (5.4).
    Mscnt = 0x6A,
    /// Chopper and microsteps (5.5.1).
    Chopconf = 0x6C,
    /// Shorts, heat, standstill (5.5.3).
    DrvStatus = 0x6F,
    /// stealthChop (5.5.2).
    Pwmconf = 0x70,
}

impl Register {
    /// Its address on the wire.
    #[must_use]
    pub const fn address(self) -> u8 {
        self as u8
    }

    /// Its name in the datasheet.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gconf => "GCONF",
            Self::Gstat => "GSTAT",
            Self::Ifcnt => "IFCNT",
            Self::Slaveconf => "SLAVECONF",
            Self::Ioin => "IOIN",
            Self::IholdIrun => "IHOLD_IRUN",
            Self::Tpowerdown => "TPOWERDOWN",
            Self::Tpwmthrs => "TPWMTHRS",
            Self::Tcoolthrs => "TCOOLTHRS",
            Self::Vactual => "VACTUAL",
            Self::Sgthrs => "SGTHRS",
            Self::SgResult => "SG_RESULT",
            Self::Coolconf => "COOLCONF",
            Self::Mscnt => "MSCNT",
            Self::Chopconf => "CHOPCONF",
            Self::DrvStatus => "DRV_STATUS",
            Self::Pwmconf => "PWMCONF",
        }
    }
}

/// Bits of GCONF (5.1).
pub(super) mod gconf {
    /// spreadCycle; without it stealthChop.
    pub const EN_SPREADCYCLE: u32 = 1 << 2;
    /// PDN_UART is the UART and no longer a power-down input.
    pub const PDN_DISABLE: u32 = 1 << 6;
    /// Microsteps by MRES instead of the pins.
    pub const MSTEP_REG_SELECT: u32 = 1 << 7;
    /// Filters step pulses at speeds above 750 full steps a second.
    pub const MULTISTEP_FILT: u32 = 1 << 8;
}

/// Bits of GSTAT (5.1).
pub(super) mod gstat {
    /// It was reset, and has lost its registers.
    pub const RESET: u32 = 1;
    /// It switched itself off: heat or a short.
    pub const DRV_ERR: u32 = 1 << 1;
    /// The charge pump is too low, so the motor has no current.
    pub const UV_CP: u32 = 1 << 2;
    /// All of them.
    pub const ALL: u32 = 7;
}

/// Fields of IOIN (5.1).
pub(super) mod ioin {
    /// First bit of the version.
    pub const VERSION: u32 = 24;
    /// The version of a TMC2209.
    pub const TMC2209: u32 = 0x21;
}

/// Fields of CHOPCONF (5.5.1).
pub(super) mod chopconf {
    /// First bit of HSTRT; TOFF begins at 0.
    pub const HSTRT: u32 = 4;
    /// First bit of TBL.
    pub const TBL: u32 = 15;
    /// High sensitivity of the sense resistors: 180 mV at full scale instead of 325.
    pub const VSENSE: u32 = 1 << 17;
    /// First bit of MRES; 0 is 256 microsteps, 8 is a full step.
    pub const MRES: u32 = 24;
    /// Steps are interpolated to 256 microsteps.
    pub const INTPOL: u32 = 1 << 28;
}

/// Bits of DRV_STATUS (5.5.3).
pub(super) mod drv_status {
    /// Over-temperature pre-warning.
    pub const OTPW: u32 = 1;
    /// Over-temperature; the driver is off.
    pub const OT: u32 = 1 << 1;
    /// Shorts to ground (2, 3) and to the supply (4, 5) of either coil.
    pub const SHORTS: u32 = 0xF << 2;
    /// Coil A or B seems open; not reliable at rest or at high speed.
    pub const OPEN_LOADS: u32 = 3 << 6;
    /// The temperature is above 120, 143, 150, 157 degrees.
    pub const T120: u32 = 1 << 8;
    /// See [`T120`].
    pub const T143: u32 = 1 << 9;
    /// See [`T120`].
    pub const T150: u32 = 1 << 10;
    /// See [`T120`].
    pub const T157: u32 = 1 << 11;
}

#[cfg(test)]
mod tests {
    use super::Register;

    #[test]
    fn a_register_has_the_address_and_the_name_of_the_datasheet() {
        // Rev 1.09, sections 5.1 to 5.5.
        for (register, address, name) in [
            (Register::Gconf, 0x00, "GCONF"),
            (Register::Gstat, 0x01, "GSTAT"),
            (Register::Ifcnt, 0x02, "IFCNT"),
            (Register::Slaveconf, 0x03, "SLAVECONF"),
            (Register::Ioin, 0x06, "IOIN"),
            (Register::IholdIrun, 0x10, "IHOLD_IRUN"),
            (Register::Tpowerdown, 0x11, "TPOWERDOWN"),
            (Register::Tpwmthrs, 0x13, "TPWMTHRS"),
            (Register::Tcoolthrs, 0x14, "TCOOLTHRS"),
            (Register::Vactual, 0x22, "VACTUAL"),
            (Register::Sgthrs, 0x40, "SGTHRS"),
            (Register::SgResult, 0x41, "SG_RESULT"),
            (Register::Coolconf, 0x42, "COOLCONF"),
            (Register::Mscnt, 0x6A, "MSCNT"),
            (Register::Chopconf, 0x6C, "CHOPCONF"),
            (Register::DrvStatus, 0x6F, "DRV_STATUS"),
            (Register::Pwmconf, 0x70, "PWMCONF"),
        ] {
            assert_eq!((register.address(), register.name()), (address, name));
        }
    }
}
