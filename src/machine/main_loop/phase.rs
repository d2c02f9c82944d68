//! Phase: the motors of one belt are aligned as they get power, by the places of their drivers in their sine tables.
//!
//! A rotor rests where the sine table of its driver says, up to whole electrical turns of four full steps. So the sum
//! of a residual over the places in these tables (MSCNT; TMC2209 datasheet rev 1.09, section 5.4) is constant while no
//! motor strains the belt. It depends neither on the tool's place nor on the belt's circulation. It is a mark of the
//! machine: it depends on how rotors and pulleys sit on their shafts and on the belt. M915 finds it by load; it is kept
//! as a setting (`belt.phases`).
//!
//! ```text
//!   power for 1, 4, 8, in turn ──▶ read all four places ──▶ step 11 until the sum is right ──▶ power for 11 ──▶ read
//!                                                           (its rotor is free, the belt slack)                 again
//! ```
//!
//! A rotor without power strains nothing. So its field is brought to the rotor's rest, and not the rotor to the field.
//! If a driver does not count steps without power the sum is still wrong then, and the motor is trimmed with power.

use super::trim::{preload_of, trim, trimmed};
use crate::driver::DriverJob;
use crate::kinematics::{Residual, Residuals};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::Thousandths;
use crate::machine::ports::PortSet;
use crate::machine::reports::residual_sum::ResidualSum;
use crate::machine::state::pulleys::{Shift, TURN, difference, shift_of};
use crate::machine::state::trimming::Found;
use crate::port::{Motor, MotorSet, Wake};
use crate::settings::{Belt, PHASES, Settings};
use crate::units::Mm;

/// Places of a full step.
const FULL_STEP: i32 = TURN / 4;

/// Tolerance of the belt's strain, in thousandths of a step. It is half a step that no trim can remove, and the error
/// of M915 when it found the phase (half a step, and 0.4).
const WITHIN: i64 = 1400;

/// The direction of a motor's place when it steps forward. The place falls while the direction line is high (Klipper,
/// klippy/extras/tmc.py, where a phase is `1023 - MSCNT` if the line is not inverted).
fn way(s: &Settings, motor: Motor) -> i32 {
    if s.wiring.of(motor).is_reversed { 1 } else { -1 }
}

/// The motor of `motors` that a residual takes, and how often, if there is just one.
fn only_one(residual: &Residual, motors: MotorSet) -> Option<(Motor, i32)> {
    let mut found = Motor::ALL.into_iter().zip(*residual).filter(|(motor, times)| *times != 0 && motors.has(*motor));
    found.next().filter(|_| found.next().is_none())
}

/// The sum of a residual over the places in the sine tables; `None` if a driver does not answer.
async fn phase_sum<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residual: &Residual,
) -> Result<Option<i32>, Interrupt> {
    let mut sum = 0;
    for (motor, times) in Motor::ALL.into_iter().zip(*residual).filter(|(_, times)| *times != 0) {
        let reading = main_loop.ask_driver(DriverJob::Phase, motor).await?;
        let Some(phase) = reading.ok().and_then(|reading| reading.phase()) else { return Ok(None) };
        sum += times * way(&main_loop.settings, motor) * i32::from(phase);
    }
    Ok(Some(sum.rem_euclid(TURN)))
}

/// Error of this residual's strain in steps against a phase, or `None` if a driver does not answer.
pub(in crate::machine) async fn strain<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    phase: i32,
    residual: &Residual,
) -> Result<Option<i32>, Interrupt> {
    let Some(sum) = phase_sum(main_loop, residual).await? else { return Ok(None) };
    let microsteps = i32::from(main_loop.settings.drivers.belt.microsteps);
    let strained =
        difference(sum, phase) * microsteps - preload_of(residual, main_loop.settings.preload_steps()) * FULL_STEP;
    // To the nearest step, half a step being a half; a preload may have led beyond half a turn.
    let steps = (2 * strained + FULL_STEP).div_euclid(2 * FULL_STEP);
    let turn = 4 * microsteps;
    Ok(Some((steps + turn / 2).rem_euclid(turn) - turn / 2))
}

/// Before a motor gets power that is the last one of its residual, brings its field to its rotor.
pub(super) async fn meet_phases<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
    next: MotorSet,
) -> Result<(), Interrupt> {
    let missing = residuals.motors().without(main_loop.power.powered());
    for (number, residual) in residuals.iter().enumerate() {
        let Some((motor, times)) = only_one(residual, missing).filter(|(motor, _)| next.has(*motor)) else {
            continue;
        };
        if let [Some(strain), Some(left)] = unstrain(main_loop, number, residual, motor, times).await?
            && strain != 0
            && left / times == 0
        {
            note_strain(main_loop, number, strain);
        }
    }
    Ok(())
}

/// Trims a motor until the strain of a residual is as wanted. If its driver does not count steps, as may be so
/// without power, trims it back. Returns the strain before and after.
async fn unstrain<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    residual: &Residual,
    motor: Motor,
    times: i32,
) -> Result<[Option<i32>; 2], Interrupt> {
    let Some(phase) = main_loop.settings.known_phase(number) else { return Ok([None; 2]) };
    let found = strain(main_loop, phase, residual).await?;
    let Some(steps) = found.filter(|steps| steps / times != 0) else { return Ok([found; 2]) };
    trim(main_loop, motor, -steps / times).await?;
    let left = strain(main_loop, phase, residual).await?;
    if left.is_none_or(|left| left / times != 0) {
        trim(main_loop, motor, steps / times).await?;
    }
    Ok([found, left])
}

/// After motors have power: they are aligned if their phases are known, or the host gets a message that they are
/// not.
pub(super) async fn align_by_phases<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
) -> Result<(), Interrupt> {
    let is_known = residuals.iter().enumerate().all(|(number, _)| main_loop.settings.known_phase(number).is_some());
    if residuals.is_empty()
        || !is_known
        || main_loop.trimming.is_aligned()
        || !main_loop.power.is_on(residuals.motors())
    {
        return Ok(());
    }
    for (number, residual) in residuals.iter().enumerate() {
        if !is_in_phase(main_loop, number, residual).await? {
            main_loop.trimming.forget();
            main_loop.say(text!(
                "echo:belt motors not aligned: their drivers do not count microsteps as they should (M915 aligns by \
                load)"
            ));
            return Ok(());
        }
    }
    main_loop.trimming.align();
    Ok(())
}

/// Whether a residual is as it should be; it is trimmed once if it is not.
async fn is_in_phase<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    residual: &Residual,
) -> Result<bool, Interrupt> {
    let Some((motor, times)) = trimmed(residual) else { return Ok(true) };
    let [found, left] = unstrain(main_loop, number, residual, motor, times).await?;
    if main_loop.trimming.found(number).is_none() {
        note_strain(main_loop, number, found.unwrap_or_default());
    }
    Ok(left.is_some_and(|left| left / times == 0))
}

/// Notes the steps by which fields would strain a residual, or have strained it.
fn note_strain<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, number: usize, steps: i32) {
    let (was, within) = (i64::from(steps) * 1000, WITHIN);
    let [was, within] = [was, within].map(|thousandths| main_loop.settings.belt_length(thousandths));
    let phase = main_loop.settings.known_phase(number).and_then(|phase| u16::try_from(phase).ok());
    main_loop.trimming.note(number, Found { was, within, readings_per_mm: None, phase, is_contradicted: false });
}

/// The phase of a residual while its motors strain nothing, given how far beside their place (in 256ths of a step) that
/// is.
pub(in crate::machine) async fn phase_at_apex<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residual: &Residual,
    beside: i64,
) -> Result<Option<u16>, Interrupt> {
    let Some((_, times)) = trimmed(residual) else { return Ok(None) };
    let here = phase_sum(main_loop, residual).await?;
    // A turn is 1024 places and 4 full steps, so a 256th of a microstep is a place over the number of microsteps.
    let beside = (beside / i64::from(main_loop.settings.drivers.belt.microsteps)) as i32;
    Ok(here.and_then(|here| u16::try_from((here + times * beside).rem_euclid(TURN)).ok()))
}

/// The same, if the driver of the trimmed motor counts correctly.
pub(in crate::machine) async fn find_phase<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residual: &Residual,
    beside: i64,
) -> Result<Option<u16>, Interrupt> {
    let Some((motor, times)) = trimmed(residual) else { return Ok(None) };
    let phase = phase_at_apex(main_loop, residual, beside).await?;
    let full_step = i32::from(main_loop.settings.drivers.belt.microsteps);
    let here = phase_sum(main_loop, residual).await?;
    trim(main_loop, motor, full_step).await?;
    let there = phase_sum(main_loop, residual).await?;
    trim(main_loop, motor, -full_step).await?;
    let counts = here.zip(there).filter(|(here, there)| difference(*there, *here) == difference(times * FULL_STEP, 0));
    Ok(counts.and(phase))
}

/// Keeps the proved findings, phases as the settings of the belt, and tells what the phases say of the pulleys. With
/// `after_work`, as M915 is due after work on the belt, every phase is kept. Otherwise not one of a pulley that slips
/// on its shaft: it may slip again.
pub(in crate::machine) fn keep_findings<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, after_work: bool) {
    let residuals = main_loop.settings.residuals();
    for (number, residual) in residuals.iter().enumerate().take(PHASES) {
        let Some(found) = main_loop.trimming.found(number) else { continue };
        if let Some(load) = found.readings_per_mm.filter(|_| !found.is_contradicted) {
            main_loop.trimming.keep_load(number, load);
        }
        let Some(phase) = found.phase else { continue };
        let by = main_loop.settings.known_phase(number).map_or(0, |known| difference(phase.into(), known));
        let shift = shift_of(&main_loop.settings, residual, by);
        let is_kept = after_work || shift != Shift::Slipped;
        let kept = if is_kept { phase } else { Belt::NO_PHASE };
        // What a repair finds within the errors of two findings is no news.
        let is_news = after_work || shift != Shift::None;
        if is_news && main_loop.settings.keep_phase(number, kept) {
            main_loop.trimming.note_phase(is_kept);
        }
        if shift != Shift::None {
            tell_of_pulley(main_loop, residual, by, shift, is_kept);
        }
    }
}

/// A diagnosis has found that a pulley has moved on the belt or its shaft, and nothing has proved the new phase. So
/// none is known, and motors are not aligned by the old one when they get power.
pub(in crate::machine) fn drop_phase<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    by: i32,
    shift: Shift,
) {
    main_loop.settings.keep_phase(number, Belt::NO_PHASE);
    if let Some(residual) = main_loop.settings.residuals().iter().nth(number) {
        tell_of_pulley(main_loop, residual, by, shift, false);
    }
}

/// Tells that the phase of a residual has changed by so many 1024ths of an electrical turn.
fn tell_of_pulley<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residual: &Residual,
    by: i32,
    shift: Shift,
    is_kept: bool,
) {
    let turns = Thousandths(Mm::ONE.saturating_mul_int(by.into()) / i64::from(TURN));
    let kept = if is_kept {
        packed!("the new phase is used, M500 stores it")
    } else {
        packed!("no phase is kept (M915 finds it)")
    };
    main_loop.tell(|to, facts| {
        let sum = ResidualSum(residual, facts.settings);
        match shift {
            Shift::Teeth(number) => {
                let teeth = if number == 1 { "tooth" } else { "teeth" };
                to.say(text!(
                    "echo:phase of {sum} is off by {turns} of an electrical turn, as a jump of at least {number} \
                    {teeth} makes it: check the belt's tension; {kept}"
                ));
            }
            _ => to.say(text!(
                "echo:phase of {sum} is off by {turns} of an electrical turn, which no jump of teeth makes: a pulley \
                has slipped on its shaft, tighten its screw; {kept}"
            )),
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motors::{per_motor, prototype};

    #[test]
    fn the_last_motor_of_a_residual_is_found() {
        let residual = per_motor(&[1, -1, 1, -1], 0);
        let of = |motors: &[Motor]| motors.iter().fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(*motor)));
        assert_eq!(only_one(&residual, of(&[prototype::M11, prototype::Z1])), Some((prototype::M11, -1)));
        assert_eq!(only_one(&residual, of(&[prototype::M8, prototype::M11])), None);
        assert_eq!(only_one(&residual, MotorSet::NONE), None);
    }
}
