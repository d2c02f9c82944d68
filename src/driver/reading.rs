//! A reading: the values that a driver reports of itself.

use super::config::microsteps;
use super::error::DriverError;
use super::registers::{Register, chopconf, drv_status, gconf};

/// Number of stored load readings.
pub(super) const LOADS: usize = 4;

/// The bits of MSCNT (section 5.4): positions in its sine table.
const PLACES: u32 = 0x3FF;

/// The bits of SG_RESULT (datasheet rev 1.09, section 5.3).
const STALL: u16 = 0x3FF;

/// The values of one driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Reading {
    pub(super) flags: u32,
    gconf: u32,
    chopconf: u32,
    pub(super) status: u32,
    /// SG_RESULT, ten bits: the last readings, the newest first.
    stalls: [u16; LOADS],
    count: u32,
    /// MSCNT: the last two readings.
    places: [Option<u16>; 2],
}

impl Reading {
    pub(super) fn note(&mut self, register: Register, value: u32) {
        match register {
            Register::Gstat => self.flags = value,
            Register::Gconf => self.gconf = value,
            Register::Chopconf => self.chopconf = value,
            Register::DrvStatus => self.status = value,
            Register::SgResult => {
                self.stalls.rotate_right(1);
                let [newest, ..] = &mut self.stalls;
                *newest = value as u16 & STALL;
            }
            Register::Ifcnt => self.count = value,
            Register::Mscnt => {
                let [newest, before] = &mut self.places;
                (*before, *newest) = (*newest, Some((value & PLACES) as u16));
            }
            _ => {}
        }
    }

    /// Microsteps of a full step; `None` if its pins decide.
    #[must_use]
    pub const fn microsteps(&self) -> Option<u32> {
        if self.gconf & gconf::MSTEP_REG_SELECT == 0 { None } else { Some(microsteps(self.chopconf)) }
    }

    /// Whether it interpolates its microsteps to 256.
    #[must_use]
    pub const fn interpolates(&self) -> bool {
        self.chopconf & chopconf::INTPOL != 0
    }

    /// Its chopper mode at low speed.
    #[must_use]
    pub const fn mode(&self) -> &'static str {
        if self.is_stealthy() { "stealthChop" } else { "spreadCycle" }
    }

    /// Whether it runs in stealthChop at low speed.
    #[must_use]
    pub const fn is_stealthy(&self) -> bool {
        self.gconf & gconf::EN_SPREADCYCLE == 0
    }

    /// Whether it is near the temperature at which it switches itself off.
    #[must_use]
    pub const fn is_hot(&self) -> bool {
        self.status & drv_status::OTPW != 0
    }

    /// Its temperature range.
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

    /// Whether a coil seems to be open; valid only while the motor turns slowly.
    #[must_use]
    pub const fn seems_open(&self) -> bool {
        self.status & drv_status::OPEN_LOADS != 0
    }

    /// StallGuard's result: the smaller, the greater the load. Valid only in stealthChop.
    #[must_use]
    pub const fn stall(&self) -> u32 {
        let [newest, ..] = self.stalls;
        newest as u32
    }

    /// All stored load readings; after a job that reads loads, its results.
    #[must_use]
    pub const fn loads(&self) -> [u16; LOADS] {
        self.stalls
    }

    /// The driver's position in its sine table, in 1024ths of an electrical turn. `None` if two readings differ,
    /// because a damaged one may pass its checksum.
    #[must_use]
    pub fn phase(&self) -> Option<u16> {
        let [newest, before] = self.places;
        newest.filter(|_| newest == before)
    }

    /// Writes that it has accepted, modulo 256.
    #[must_use]
    pub const fn writes(&self) -> u32 {
        self.count
    }

    /// Its error, apart from its registers.
    #[must_use]
    pub const fn problem(&self) -> Option<DriverError> {
        match DriverError::from_status(self.status) {
            None => DriverError::from_flags(self.flags),
            found => found,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reading in which one register was read.
    fn with(register: Register, value: u32) -> Reading {
        let mut reading = Reading::default();
        reading.note(register, value);
        reading
    }

    #[test]
    fn microsteps_and_mode_are_told_by_the_bits_of_the_datasheet() {
        // GCONF, 5.1: mstep_reg_select is bit 7, en_spreadCycle bit 2. CHOPCONF, 5.5.1: MRES is bits 27 to 24.
        for bit in 0..32 {
            let mut reading = with(Register::Gconf, 1 << bit);
            reading.note(Register::Chopconf, 0x1503_0053);
            assert_eq!(reading.microsteps(), (bit == 7).then_some(8), "GCONF, bit {bit}");
            assert_eq!(reading.mode(), if bit == 2 { "spreadCycle" } else { "stealthChop" }, "GCONF, bit {bit}");
        }
    }

    #[test]
    fn every_bit_of_the_status_has_its_meaning() {
        // DRV_STATUS, 5.5.3: otpw is bit 0, ot 1, shorts 2 to 5, ola and olb 6 and 7, t120 to t157 8 to 11.
        for bit in 0..32 {
            let reading = with(Register::DrvStatus, 1 << bit);
            let temperature = match bit {
                8 => "above 120 C",
                9 => "above 143 C",
                10 => "above 150 C",
                11 => "above 157 C",
                _ => "below 120 C",
            };
            let problem = match bit {
                1 => Some(DriverError::OverTemperature),
                2..=5 => Some(DriverError::ShortCircuit),
                _ => None,
            };
            assert_eq!(reading.temperature(), temperature, "bit {bit}");
            assert_eq!(reading.problem(), problem, "bit {bit}");
            assert_eq!((reading.is_hot(), reading.seems_open()), (bit == 0, (6..=7).contains(&bit)), "bit {bit}");
        }
        // The hotter it is, the more bits are set: the highest counts.
        for (status, temperature) in [
            (0, "below 120 C"),
            (0x100, "above 120 C"),
            (0x300, "above 143 C"),
            (0x700, "above 150 C"),
            (0xF00, "above 157 C"),
        ] {
            assert_eq!(with(Register::DrvStatus, status).temperature(), temperature);
        }
    }

    #[test]
    fn what_the_status_says_comes_before_what_the_flags_say() {
        // GSTAT, 5.1: reset, drv_err and uv_cp are bits 0 to 2.
        let mut reading = with(Register::Gstat, 0b010);
        assert_eq!(reading.problem(), Some(DriverError::ShutDown));
        reading.note(Register::DrvStatus, 1 << 1);
        assert_eq!(reading.problem(), Some(DriverError::OverTemperature), "which is why it is off");
        assert_eq!(with(Register::Gstat, 0b100).problem(), Some(DriverError::LowSupply));
        assert_eq!(Reading::default().problem(), None);
    }

    #[test]
    fn a_phase_is_believed_when_it_was_read_twice() {
        let mut reading = with(Register::Mscnt, 0x2F0);
        assert_eq!(reading.phase(), None);
        reading.note(Register::Mscnt, 0x2F1);
        assert_eq!(reading.phase(), None);
        // The other bits are undefined.
        reading.note(Register::Mscnt, 0xFC00 | 0x2F1);
        assert_eq!(reading.phase(), Some(0x2F1));
    }

    #[test]
    fn the_last_four_loads_are_kept_and_the_newest_comes_first() {
        let mut reading = Reading::default();
        // SG_RESULT, 5.3: ten bits.
        for load in [510, 400, 300, 200, 0xFFFF_FC00 | 100] {
            reading.note(Register::SgResult, load);
        }
        assert_eq!((reading.loads(), reading.stall()), ([100, 200, 300, 400], 100));
    }

    #[test]
    fn numbers_are_told_as_they_were_read() {
        let mut reading = with(Register::SgResult, 510);
        assert_eq!((reading.stall(), reading.writes()), (510, 0));
        reading.note(Register::Ifcnt, 255);
        // Values that no report uses are dropped.
        reading.note(Register::Ioin, 0x2100_0000);
        assert_eq!((reading.stall(), reading.writes()), (510, 255));
    }
}
