//! The state of a driver as its registers show it.

use super::Tmc2209;
use super::config::microsteps;
use super::registers::{Register, chopconf, drv_status, gconf};
use crate::driver::chip::{Chip as _, Shown};
use crate::driver::reading::Reading;

/// The bits of MSCNT (datasheet rev 1.09, section 5.4): positions in its sine table.
const PLACES: u32 = 0x3FF;

/// The bits of SG_RESULT (section 5.3).
const STALL: u16 = 0x3FF;

/// Takes down a value. Values that no report uses are dropped.
pub(super) const fn note(reading: &mut Reading, register: Register, value: u32) {
    match register {
        Register::Gstat => reading.registers.flags = value,
        Register::Gconf => reading.registers.mode = value,
        Register::Chopconf => reading.registers.chopper = value,
        Register::DrvStatus => reading.registers.status = value,
        Register::SgResult => reading.note_load(value as u16 & STALL),
        Register::Ifcnt => reading.writes = value,
        Register::Mscnt => reading.note_phase((value & PLACES) as u16),
        _ => {}
    }
}

/// What a reading shows.
pub(super) fn shown(reading: &Reading) -> Shown {
    let r = &reading.registers;
    let is_quiet = r.mode & gconf::EN_SPREADCYCLE == 0;
    Shown {
        microsteps: (r.mode & gconf::MSTEP_REG_SELECT != 0).then(|| microsteps(r.chopper)),
        interpolates: r.chopper & chopconf::INTPOL != 0,
        mode: if is_quiet { "stealthChop" } else { "spreadCycle" },
        is_quiet,
        temperature: match r.status {
            s if s & drv_status::T157 != 0 => "above 157 C",
            s if s & drv_status::T150 != 0 => "above 150 C",
            s if s & drv_status::T143 != 0 => "above 143 C",
            s if s & drv_status::T120 != 0 => "above 120 C",
            _ => "below 120 C",
        },
        is_hot: r.status & drv_status::OTPW != 0,
        seems_open: r.status & drv_status::OPEN_LOADS != 0,
        problem: Tmc2209::error_of_status(r.status).or(Tmc2209::error_of_flags(r.flags)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::error::DriverError;

    /// A reading in which one register was read.
    fn with(register: Register, value: u32) -> Reading {
        let mut reading = Reading::default();
        note(&mut reading, register, value);
        reading
    }

    #[test]
    fn microsteps_and_mode_are_told_by_the_bits_of_the_datasheet() {
        // GCONF, 5.1: mstep_reg_select is bit 7, en_spreadCycle bit 2. CHOPCONF, 5.5.1: MRES is bits 27 to 24.
        for bit in 0..32 {
            let mut reading = with(Register::Gconf, 1 << bit);
            note(&mut reading, Register::Chopconf, 0x1503_0053);
            let shown = shown(&reading);
            assert_eq!(shown.microsteps, (bit == 7).then_some(8), "GCONF, bit {bit}");
            assert_eq!(shown.mode, if bit == 2 { "spreadCycle" } else { "stealthChop" }, "GCONF, bit {bit}");
        }
    }

    #[test]
    fn every_bit_of_the_status_has_its_meaning() {
        // DRV_STATUS, 5.5.3: otpw is bit 0, ot 1, shorts 2 to 5, ola and olb 6 and 7, t120 to t157 8 to 11.
        for bit in 0..32 {
            let shown = shown(&with(Register::DrvStatus, 1 << bit));
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
            assert_eq!(shown.temperature, temperature, "bit {bit}");
            assert_eq!(shown.problem, problem, "bit {bit}");
            assert_eq!((shown.is_hot, shown.seems_open), (bit == 0, (6..=7).contains(&bit)), "bit {bit}");
        }
        // The hotter it is, the more bits are set: the highest counts.
        for (status, temperature) in [
            (0, "below 120 C"),
            (0x100, "above 120 C"),
            (0x300, "above 143 C"),
            (0x700, "above 150 C"),
            (0xF00, "above 157 C"),
        ] {
            assert_eq!(shown(&with(Register::DrvStatus, status)).temperature, temperature);
        }
    }

    #[test]
    fn what_the_status_says_comes_before_what_the_flags_say() {
        // GSTAT, 5.1: reset, drv_err and uv_cp are bits 0 to 2.
        let mut reading = with(Register::Gstat, 0b010);
        assert_eq!(shown(&reading).problem, Some(DriverError::ShutDown));
        note(&mut reading, Register::DrvStatus, 1 << 1);
        assert_eq!(shown(&reading).problem, Some(DriverError::OverTemperature), "which is why it is off");
        assert_eq!(shown(&with(Register::Gstat, 0b100)).problem, Some(DriverError::LowSupply));
        assert_eq!(shown(&Reading::default()).problem, None);
    }

    #[test]
    fn numbers_are_told_as_they_were_read() {
        // SG_RESULT, 5.3: ten bits. MSCNT, 5.4: the other bits are undefined.
        let mut reading = with(Register::SgResult, 0xFFFF_FC00 | 510);
        assert_eq!((reading.load(), reading.writes), (510, 0));
        note(&mut reading, Register::Ifcnt, 255);
        note(&mut reading, Register::Ioin, 0x2100_0000);
        assert_eq!((reading.load(), reading.writes), (510, 255));
        note(&mut reading, Register::Mscnt, 0xFC00 | 0x2F1);
        note(&mut reading, Register::Mscnt, 0x2F1);
        assert_eq!(reading.phase(), Some(0x2F1));
    }
}
