//! Configuration: the required contents of a driver's registers, from the settings. `AFTER` in `scripts` lists those
//! that are read back.

use super::registers::{Register, chopconf, gconf, gstat};
use crate::driver::chip::Held;
use crate::motors::Motor;
use crate::settings::{DriverSettings, Settings};
use crate::units::{StepRate, StepsPerMm, mul_div};

/// Frequency of the driver's own clock (datasheet rev 1.09, electrical characteristics: 12 MHz with a tolerance of some
/// percent, which is enough for a speed threshold).
const CLOCK_HZ: u64 = 12_000_000;

/// Finest steps in a full step: TSTEP and its thresholds count those (section 5.2).
const FINEST: u64 = 256;

/// Greatest value of a threshold that TSTEP is compared with: 20 bits (section 5.2).
const SLOWEST: u32 = 0xF_FFFF;

/// Sense resistor of every common TMC2209 module, and the chip's own part (section 9: R_SENSE + 20 mOhm).
const SENSE_MILLIOHM: u64 = 110 + 20;

/// Full-scale voltage in mV with high and with low sensitivity (section 9: V_FS).
const FULL_SCALE_MV: [u64; 2] = [180, 325];

/// Off time, blank time, hysteresis start; hysteresis end is 0. The defaults of Klipper's tmc2209.
const CHOPPER: u32 = 3 | 5 << chopconf::HSTRT | 2 << chopconf::TBL;

/// PWM_LIM 12, PWM_REG 8, autograd, autoscale, PWM_FREQ 1, PWM_GRAD 14, PWM_OFS 36: the defaults of Klipper's tmc2209.
/// They differ from the chip's, so reading them back proves the write.
const PWMCONF: u32 = 0xC80D_0E24;

/// Steps of 2^18 clocks, 22 ms, in which the current falls at rest (section 5.2; Klipper's default).
const IHOLDDELAY: u32 = 8;

/// Time at rest until it falls: 20 * 2^18 clocks, 0.44 s (section 5.2: power-up value).
const TPOWERDOWN: u32 = 20;

/// The contents of a driver's registers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Config {
    gconf: u32,
    currents: u32,
    tpwmthrs: u32,
    sgthrs: u32,
    chopconf: u32,
}

/// Registers to be written. They include coolStep and the pulse generator, because another firmware may have left
/// values there that spoil steps.
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
    /// The required configuration of `motor`'s driver.
    #[must_use]
    pub fn new(motor: Motor, settings: &Settings) -> Self {
        Self::of(&settings.driver_of(motor), settings.steps_per_mm(motor))
    }

    fn of(d: &DriverSettings, steps_per_mm: StepsPerMm) -> Self {
        let (vsense, run) = current_scale(d.current_ma);
        // The current goes with CS + 1 (section 9), so the share is of that.
        let hold = ((run + 1) * u32::from(d.hold_percent) / 100).saturating_sub(1);
        let mode = if d.stealth { 0 } else { gconf::EN_SPREADCYCLE };
        let mres = 8 - d.microsteps.ilog2().min(8);
        let intpol = if d.interpolate { chopconf::INTPOL } else { 0 };
        Self {
            gconf: gconf::PDN_DISABLE | gconf::MSTEP_REG_SELECT | gconf::MULTISTEP_FILT | mode,
            currents: IHOLDDELAY << 16 | run << 8 | hold,
            tpwmthrs: hybrid_threshold(d, steps_per_mm),
            sgthrs: u32::from(d.stall_threshold),
            chopconf: CHOPPER | vsense | mres << chopconf::MRES | intpol,
        }
    }

    /// The required value of `register`; `None` for registers that are not written.
    #[must_use]
    pub const fn value(&self, register: Register) -> u32 {
        match register {
            Register::Gconf => self.gconf,
            Register::IholdIrun => self.currents,
            Register::Tpowerdown => TPOWERDOWN,
            Register::Tpwmthrs => self.tpwmthrs,
            // DIAG signals stalls down to the slowest speed, or never.
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

    /// The effect of these contents.
    pub(super) fn held(&self) -> Held {
        let is_sensitive = self.chopconf & chopconf::VSENSE != 0;
        let microsteps = microsteps(self.chopconf);
        let clocks = u64::from(self.tpwmthrs) * FINEST;
        Held {
            microsteps,
            run_ma: rms_ma((self.currents >> 8) & 0x1F, is_sensitive),
            hold_ma: rms_ma(self.currents & 0x1F, is_sensitive),
            // Above that, spreadCycle replaces stealthChop.
            quiet_steps_per_s: (clocks > 0).then(|| mul_div(CLOCK_HZ, u64::from(microsteps), clocks) as u32),
        }
    }
}

/// Microsteps of a CHOPCONF value, if GCONF enables it.
pub(super) const fn microsteps(chopconf: u32) -> u32 {
    256 >> ((chopconf >> chopconf::MRES) & 0xF)
}

/// VSENSE and the current scale (0 to 31) nearest to a root mean square.
///
/// Section 9: I_RMS = (CS + 1) / 32 * V_FS / (R_SENSE + 20 mOhm) / sqrt 2. High sensitivity is used as far as it
/// reaches, because a scale above 16 makes finer microsteps.
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
    let rate = d.hybrid_threshold * steps_per_mm;
    if rate == StepRate::ZERO {
        return 0;
    }
    let finest = rate.scaled(FINEST, u64::from(d.microsteps)).whole();
    mul_div(CLOCK_HZ, 1, u64::from(finest)).clamp(1, u64::from(SLOWEST)) as u32
}

#[cfg(test)]
mod tests;
