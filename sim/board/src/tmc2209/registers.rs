//! The registers of a TMC2209 with their addresses, and the bits that tests check (datasheet rev 1.09, section 5).

/// A register's access by UART (section 5, column R/W).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Access {
    Read,
    Write,
    ReadWrite,
    /// Reads; a 1 that is written clears the bit.
    ReadClear,
}

/// Every register of the UART: address, access, bits, value after power-up (section 5).
pub(super) const TABLE: [(u8, Access, u32, u32); 24] = [
    (gconf::ADDRESS, Access::ReadWrite, 10, 0x101),
    (GSTAT, Access::ReadClear, 3, 1),
    (IFCNT, Access::Read, 8, 0),
    (0x03, Access::Write, 12, 0),
    (0x04, Access::Write, 16, 0),
    (0x05, Access::Read, 24, 0),
    (IOIN, Access::Read, 32, 0),
    (0x07, Access::ReadWrite, 10, 0),
    (IHOLD_IRUN, Access::Write, 20, 0x0001_1F10),
    (0x11, Access::Write, 8, 20),
    (0x12, Access::Read, 20, 0xF_FFFF),
    (TPWMTHRS, Access::Write, 20, 0),
    (TCOOLTHRS, Access::Write, 20, 0),
    (VACTUAL, Access::Write, 24, 0),
    (SGTHRS, Access::Write, 8, 0),
    (SG_RESULT, Access::Read, 10, 0),
    (0x42, Access::Write, 16, 0),
    (MSCNT, Access::Read, 10, 0),
    (0x6B, Access::Read, 25, 0),
    (chopconf::ADDRESS, Access::ReadWrite, 32, 0x1000_0053),
    (DRV_STATUS, Access::Read, 32, 0x8000_0000),
    (PWMCONF, Access::ReadWrite, 32, 0xC10D_0024),
    (0x71, Access::Read, 25, 0),
    (0x72, Access::Read, 24, 0),
];

/// The place of a register in [`TABLE`]: looked up, because drivers are asked all the time.
pub(super) fn place(address: u8) -> Option<usize> {
    PLACES.get(usize::from(address)).copied().flatten().map(usize::from)
}

/// Places by address, which has seven bits.
const PLACES: [Option<u8>; 1 << 7] = {
    let mut places = [None; 1 << 7];
    let mut place = 0;
    while place < TABLE.len() {
        places[TABLE[place].0 as usize] = Some(place as u8);
        place += 1;
    }
    places
};

/// GCONF.
pub mod gconf {
    /// Address.
    pub const ADDRESS: u8 = 0x00;
    /// spreadCycle instead of stealthChop.
    pub const EN_SPREADCYCLE: u32 = 1 << 2;
    /// MRES instead of the pins MS1 and MS2.
    pub const MSTEP_REG_SELECT: u32 = 1 << 7;
}

/// CHOPCONF.
pub mod chopconf {
    /// Address.
    pub const ADDRESS: u8 = 0x6C;
    /// High sensitivity of the sense resistors.
    pub const VSENSE: u32 = 1 << 17;
    /// Microsteps are interpolated to 256.
    pub const INTPOL: u32 = 1 << 28;
    /// Where the microstep resolution begins.
    pub const MRES: u32 = 24;
}

/// GSTAT.
pub const GSTAT: u8 = 0x01;
/// IFCNT.
pub const IFCNT: u8 = 0x02;
/// IOIN.
pub const IOIN: u8 = 0x06;
/// IHOLD_IRUN.
pub const IHOLD_IRUN: u8 = 0x10;
/// TPWMTHRS.
pub const TPWMTHRS: u8 = 0x13;
/// TCOOLTHRS.
pub const TCOOLTHRS: u8 = 0x14;
/// VACTUAL.
pub const VACTUAL: u8 = 0x22;
/// SGTHRS.
pub const SGTHRS: u8 = 0x40;
/// SG_RESULT.
pub const SG_RESULT: u8 = 0x41;
/// MSCNT.
pub const MSCNT: u8 = 0x6A;
/// DRV_STATUS.
pub const DRV_STATUS: u8 = 0x6F;
/// PWMCONF.
pub const PWMCONF: u8 = 0x70;
