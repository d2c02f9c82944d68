//! Reports of motors that can pull against each other: whether they are aligned (M122, M915), and the result of a touch
//! (M915 D, R).

use crate::kinematics::{Residual, Residuals};
use crate::machine::answers::belt_answer::{AlignError, BeltAnswer, Diagnosis};
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::Thousandths;
use crate::machine::state::pulleys::{Shift, TURN};
use crate::machine::state::trimming::{Found, Trimming};
use crate::port::Motor;
use crate::settings::Settings;
use crate::units::{Mm, StepsPerMm};
use core::fmt;

/// A residual as a sum of motors: `m1 - m4 + m8 - m11`.
struct Sum<'r>(&'r Residual, &'r Settings);

impl fmt::Display for Sum<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut is_first = true;
        let Self(residual, s) = self;
        for (motor, times) in Motor::ALL.into_iter().zip(*residual).filter(|(_, times)| **times != 0) {
            let sign = match (is_first, *times < 0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            is_first = false;
            f.write_str(sign)?;
            if times.abs() > 1 {
                write!(f, "{} ", times.abs())?;
            }
            f.write_str(s.name_of(motor).as_str())?;
        }
        Ok(())
    }
}

/// Why belt motors were not aligned, with the names of the machine's motors.
struct Why<'r>(&'r AlignError, &'r Settings);

impl fmt::Display for Why<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(error, s) = self;
        match error {
            AlignError::NoUart => put!(f, "its drivers cannot be asked for loads"),
            AlignError::Driver(fault) => fault.fmt(f),
            AlignError::TooFewReadings => put!(f, "the drivers were hardly read while the tool moved"),
            AlignError::Flat => put!(f, "the loads that the drivers measure do not change with the belt's strain"),
            AlignError::TooFar => put!(f, "more strain than three turns explain"),
            AlignError::Phase => {
                put!(f, "their drivers do not count microsteps as they should (M915 aligns by load)")
            }
            AlignError::Changed => put!(f, "a motor has skipped meanwhile"),
            AlignError::Strained(by) => {
                put!(f, "measured again, it is strained by {} mm: ", Thousandths(*by))?;
                put!(f, "a motor has skipped meanwhile, or something drags (a roller, a pulley)")
            }
            AlignError::Drags(by) => {
                put!(f, "strain differs by {} mm with direction or motor: something drags ", Thousandths(*by))?;
                put!(f, "(a roller, a pulley, a motor); see that all turn freely, then M915")
            }
            AlignError::AtLimit(motor) => {
                put!(
                    f,
                    "motor {} has no torque left: it, its pulley or a roller of its belt drags, ",
                    s.name_of(*motor)
                )?;
                put!(f, "or its current is too low (M906); see that all turn freely, then M915")
            }
            AlignError::Unsure => put!(f, "the loads that the drivers measure do not agree"),
        }
    }
}

/// Steps of belt in mm.
fn length(steps: i32, resolution: StepsPerMm) -> Thousandths {
    Thousandths(resolution.length_of(steps.into()))
}

/// The lines of an answer.
pub(in crate::machine) fn report_belt(
    to: &mut ReplyWriter<'_>,
    answer: &BeltAnswer,
    trimming: &Trimming,
    s: &Settings,
) {
    let per_mm = s.axes.x.steps_per_mm;
    match *answer {
        BeltAnswer::State => {
            let state = match trimming.is_aligned() {
                false => packed!("not aligned since motors got power (M915)"),
                true if trimming.is_by_phases() => {
                    packed!("aligned by stored phases alone: no load was measured (M915 D measures)")
                }
                true => packed!("aligned"),
            };
            to.say(text!("Belt: motors {state}"));
            for (number, residual) in Residuals::new(&s.mechanism, s.belt.is_closed).iter().enumerate() {
                let Some(Found { was, within, readings_per_mm, .. }) = trimming.found(number) else { continue };
                let (sum, was, within) = (Sum(residual, s), Thousandths(was), Thousandths(within));
                match readings_per_mm {
                    None => to.say(text!("Belt: {sum} was {was} mm from its stored phase")),
                    Some(readings) => {
                        to.say(text!("Belt: {sum} was {was} mm, then measured within {within} mm"));
                        to.say(text!("Belt: {sum}: a mm of strain takes {readings} of SG_RESULT"));
                    }
                }
            }
        }
        // M915 R leaves a motor where loads say, which may be a step or two from the phase that M915 found before.
        BeltAnswer::Fields(-2..=2) => to.say(text!("Belt: drivers have made the steps that are counted")),
        BeltAnswer::Fields(steps) => {
            to.say(text!("Belt: drivers stand {steps} steps apart: steps were lost on their lines (M915 aligns)"));
        }
        BeltAnswer::Met([Some(x), Some(y)]) => {
            to.say(text!("Belt: x met its switch {x} mm of path ago, y {y} (M915 D meets them again)"));
        }
        BeltAnswer::Met(_) => to.say(text!("Belt: x and y have not met their switches (G28)")),
        BeltAnswer::Load { number, now, before } => {
            if let Some(residual) = Residuals::new(&s.mechanism, s.belt.is_closed).iter().nth(number) {
                to.say(text!(
                    "echo:{}: a mm of strain takes {now} of SG_RESULT, {before} before: a roller or motor drags, the \
                    belt has changed, or currents (M906)",
                    Sum(residual, s)
                ));
            }
        }
        BeltAnswer::Pulley { number, by, shift, is_kept } => {
            let Some(residual) = Residuals::new(&s.mechanism, s.belt.is_closed).iter().nth(number).copied() else {
                return;
            };
            let turns = Thousandths(Mm::ONE.saturating_mul_int(by.into()) / i64::from(TURN));
            let kept = if is_kept {
                packed!("the new phase is used, M500 stores it")
            } else {
                packed!("no phase is kept (M915 finds it)")
            };
            let sum = Sum(&residual, s);
            match shift {
                Shift::Teeth(number) => {
                    let teeth = if number == 1 { "tooth" } else { "teeth" };
                    to.say(text!(
                        "echo:phase of {sum} is off by {turns} of an electrical turn, as a jump of at least \
                        {number} {teeth} makes it: check the belt's tension; {kept}"
                    ));
                }
                _ => to.say(text!(
                    "echo:phase of {sum} is off by {turns} of an electrical turn, which no jump of teeth makes: a \
                    pulley has slipped on its shaft, tighten its screw; {kept}"
                )),
            }
        }
        BeltAnswer::Untold => to.say(text!(
            "echo:a tooth is whole electrical turns on this machine: jumped teeth cannot be told from skips"
        )),
        BeltAnswer::Aligned => {
            report_found(to, "echo:belt motors aligned: ", trimming, s);
            if trimming.has_new_phase() {
                to.say(text!(
                    "echo:stored settings lack the new phase of the belt: M500 stores it, and motors \
                    align when they get power"
                ));
            }
        }
        BeltAnswer::NotAligned(error) => {
            to.say(text!("echo:belt motors not aligned: {}", Why(&error, s)));
        }
        BeltAnswer::NoResidual => to.say(text!("echo:no motors of this machine can pull against each other")),
        BeltAnswer::Needed => to.say(text!("echo:move ignored: align the belt motors first (M915)")),
        BeltAnswer::NothingToCompare => {
            to.say(text!("echo:nothing to compare with: align the belt motors first (M915)"));
        }
        BeltAnswer::Touched([x, y]) => {
            let (x, y) = (length(x, per_mm), length(y, per_mm));
            to.say(text!("echo:the tool is off its position by X{x} Y{y} mm"));
        }
        BeltAnswer::Diagnosis(Diagnosis::Nothing) => to.say(text!("echo:no motor has skipped")),
        BeltAnswer::Diagnosis(Diagnosis::Aside) => {
            to.say(text!(
                "echo:the belt is not strained, and no skip moves the tool so far: a switch has moved, or something \
                drags"
            ));
        }
        BeltAnswer::Diagnosis(Diagnosis::Moved) => {
            to.say(text!("echo:no skip strains the belt like this (M915 aligns)"));
        }
        BeltAnswer::Diagnosis(Diagnosis::Alike) => {
            to.say(text!(
                "echo:all motors have skipped equally, or a switch has moved: the belt is not \
                strained"
            ));
        }
        BeltAnswer::Diagnosis(Diagnosis::Skip { motor, full_steps }) => {
            let name = s.name_of(motor);
            to.say(text!("echo:motor {name} has skipped by {full_steps:+} full steps"));
        }
        BeltAnswer::Diagnosis(Diagnosis::Several) => {
            to.say(text!("echo:more than one skip: which motors cannot be told (M915 aligns)"));
        }
        BeltAnswer::NotRepaired(error) => {
            to.say(text!("echo:belt not repaired: {}", Why(&error, s)));
        }
        BeltAnswer::Repaired([x, y]) => {
            let (x, y) = (length(x, per_mm), length(y, per_mm));
            to.say(text!("echo:belt repaired, x and y homed; touched again: X{x} Y{y} mm"));
        }
    }
}

/// Reports the finding for each residual.
fn report_found(to: &mut ReplyWriter<'_>, begin: &str, trimming: &Trimming, s: &Settings) {
    let residuals = Residuals::new(&s.mechanism, s.belt.is_closed);
    for (number, residual) in residuals.iter().enumerate() {
        let Some(Found { was, within, .. }) = trimming.found(number) else { continue };
        let (sum, was, within) = (Sum(residual, s), Thousandths(was), Thousandths(within));
        to.say(text!("{begin}{sum} was {was} mm, is correct now within {within} mm"));
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::kinematics::Mechanism;
    use crate::motors::per_motor;
    use std::string::ToString;

    #[test]
    fn a_residual_reads_as_a_sum_of_motors() {
        let s = Settings::prototype();
        let of = |closed| Residuals::new(&Mechanism::corehbot(), closed);
        assert_eq!(Sum(of(true).iter().next().unwrap(), &s).to_string(), "m1 - m4 + m8 - m11");
        assert_eq!(Sum(&per_motor(&[-1, 0, 2], 0), &s).to_string(), "-m1 + 2 m8");
    }

    #[test]
    fn steps_are_told_as_lengths() {
        assert_eq!(length(64, StepsPerMm::from_num(80)).to_string(), "0.800");
        assert_eq!(length(-7, StepsPerMm::from_num(80)).to_string(), "-0.087");
    }
}
