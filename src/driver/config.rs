//! Configuration: what a driver's registers must hold, given the settings. Which of them are read back is `AFTER` in `run`.

use super::registers::{Register, chopconf, gconf, gstat};
use crate::motors::Motor;
use crate::settings::{DriverSettings, Settings};
use crate::units::{StepsPerMm, mul_div};

/// Frequency of the driver's own clock (datasheet rev 1.09, electrical characteristics: 12 MHz, give or take some
/// percent, which a threshold of speed can bear).
const CLOCK_HZ: u64 = 12_000_000;

/// Steps of the driver's own scale in a full step: TSTEP and its thresholds count those (section 5.2).
const FINEST: u64 = 256;

/// Greatest value of a threshold that TSTEP is compared with: 20 bits (section 5.2).
const SLOWEST: u32 = 0xF_FFFF;

/// Sense resistor of every common TMC2209 module, and what the chip adds to it (section 9: R_SENSE + 20 mOhm).
const SENSE_MILLIOHM: u64 = 110 + 20;

/// Full-scale voltage in mV with high and with low sensitivity (section 9: V_FS).
const FULL_SCALE_MV: [u64; 2] = [180, 325];

/// Off time, blank time, hysteresis start; hysteresis end is 0. The defaults of Klipper's tmc2209.
const CHOPPER: u32 = 3 | 5 << chopconf::HSTRT | 2 << chopconf::TBL;

/// PWM_LIM 12, PWM_REG 8, autograd, autoscale, PWM_FREQ 1, PWM_GRAD 14, PWM_OFS 36: the defaults of Klipper's
/// tmc2209. They differ from those of the chip, so that reading them back says something.
const PWMCONF: u32 = 0xC80D_0E24;

/// Steps of 2^18 clocks, 22 ms, in which the current falls at rest (section 5.2; Klipper's default).
const IHOLDDELAY: u32 = 8;

/// Time at rest until it falls: 20 * 2^18 clocks, 0.44 s (section 5.2: power-up value).
const TPOWERDOWN: u32 = 20;

/// What a driver's registers hold.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Config {
    gconf: u32,
    currents: u32,
    tpwmthrs: u32,
    sgthrs: u32,
    chopconf: u32,
}

/// Registers to be written. Those that could spoil a step come with what another firmware may have left:
/// coolStep and the pulse generator.
pub(super) const WRITTEN: [Register; 10] = [
    Register::Gconf,
    Register::IholdIrun,
    Register::Tpowerdown,
    Register::Tpwmthrs,
    Register::Tcoolthrs,
    Register::Vactual,
    Register::Sgthrs,
    Register::Coolconf,
    Register::Chopconf,
    Register::Pwmconf,
];

impl Config {
    /// What the driver of `motor` must hold.
    #[must_use]
    pub fn new(motor: Motor, settings: &Settings) -> Self {
        Self::of(settings.drivers.of(motor).0, settings.steps_per_mm(motor))
    }

    fn of(d: &DriverSettings, steps_per_mm: StepsPerMm) -> Self {
        let (vsense, run) = current_scale(d.current_ma);
        let hold = ((run + 1) * u32::from(d.hold_percent) / 100).saturating_sub(1);
        let mode = if d.stealth { 0 } else { gconf::EN_SPREADCYCLE };
        let mres = 8 - d.microsteps.ilog2().min(8);
        Self {
            gconf: gconf::PDN_DISABLE | gconf::MSTEP_REG_SELECT | gconf::MULTISTEP_FILT | mode,
            currents: IHOLDDELAY << 16 | run << 8 | hold,
            tpwmthrs: hybrid_threshold(d, steps_per_mm),
            sgthrs: u32::from(d.stall_threshold),
            chopconf: CHOPPER | vsense | mres << chopconf::MRES | chopconf::INTPOL,
        }
    }

    /// What `register` must hold; registers that are not written hold what they like.
    #[must_use]
    pub const fn value(&self, register: Register) -> u32 {
        match register {
            Register::Gconf => self.gconf,
            Register::IholdIrun => self.currents,
            Register::Tpowerdown => TPOWERDOWN,
            Register::Tpwmthrs => self.tpwmthrs,
            // DIAG tells of stalls down to the slowest speed, or never.
            Register::Tcoolthrs => {
                if self.sgthrs == 0 {
                    0
                } else {
                    SLOWEST
                }
            }
            Register::Sgthrs => self.sgthrs,
            Register::Chopconf => self.chopconf,
            Register::Pwmconf => PWMCONF,
            // A 1 clears a flag.
            Register::Gstat => gstat::ALL,
            // No motion of the driver's own, no coolStep, no delay of replies.
            Register::Vactual | Register::Coolconf | Register::Slaveconf => 0,
            // Counted or measured by the driver.
            Register::Ifcnt | Register::Ioin | Register::SgResult | Register::Mscnt | Register::DrvStatus => 0,
        }
    }

    /// Microsteps of a full step.
    #[must_use]
    pub const fn microsteps(&self) -> u32 {
        microsteps(self.chopconf)
    }

    /// The run current that comes of it, in mA.
    #[must_use]
    pub fn run_current_ma(&self) -> u32 {
        rms_ma((self.currents >> 8) & 0x1F, self.chopconf & chopconf::VSENSE != 0)
    }
}

/// Microsteps that a value of CHOPCONF makes, if GCONF lets it.
pub(super) const fn microsteps(chopconf: u32) -> u32 {
    256 >> ((chopconf >> chopconf::MRES) & 0xF)
}

/// VSENSE and the current scale (0 to 31) that come nearest to a root mean square.
///
/// Section 9: I_RMS = (CS + 1) / 32 * V_FS / (R_SENSE + 20 mOhm) / sqrt 2. High sensitivity is taken as far as it
/// reaches, for a scale above 16 makes finer microsteps.
fn current_scale(ma: u16) -> (u32, u32) {
    let wanted = u64::from(ma);
    for (full_scale, vsense) in FULL_SCALE_MV.into_iter().zip([chopconf::VSENSE, 0]) {
        // CS + 1 = 32 * I * R * sqrt 2 / V; mA times mOhm is uV. 1.41421 is sqrt 2.
        let divisor = full_scale * 1000 * 100_000;
        let scale = (wanted * 32 * SENSE_MILLIOHM * 141_421 + divisor / 2) / divisor;
        if scale <= 32 || vsense == 0 {
            return (vsense, scale.clamp(1, 32) as u32 - 1);
        }
    }
    (0, 0)
}

/// The root mean square of a current scale, in mA.
fn rms_ma(scale: u32, is_sensitive: bool) -> u32 {
    let [sensitive, coarse] = FULL_SCALE_MV;
    let full_scale = if is_sensitive { sensitive } else { coarse };
    mul_div(u64::from(scale + 1) * full_scale * 1000, 100_000, 32 * SENSE_MILLIOHM * 141_421) as u32
}

/// TPWMTHRS: clocks between two finest steps at the threshold; 0 leaves stealthChop on at any speed.
fn hybrid_threshold(d: &DriverSettings, steps_per_mm: StepsPerMm) -> u32 {
    // Both factors carry 16 bits after the point.
    let steps_a_second = u64::from(d.hybrid_threshold.to_bits()) * u64::from(steps_per_mm.to_bits());
    let finest_a_second = mul_div(steps_a_second, FINEST, u64::from(d.microsteps)) >> 32;
    if steps_a_second == 0 {
        return 0;
    }
    mul_div(CLOCK_HZ, 1, finest_a_second).clamp(1, u64::from(SLOWEST)) as u32
}

#[cfg(test)]
mod tests;
