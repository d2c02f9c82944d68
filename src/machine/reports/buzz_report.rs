//! The reports of STEPPER_BUZZ: which motor moved how far, and which ones were held.

use crate::machine::answers::buzz_answer::BuzzAnswer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::Thousandths;
use crate::port::MotorSet;
use crate::settings::Settings;
use core::fmt;

/// Motors by their names; `none` if there are none.
struct Names<'s>(MotorSet, &'s Settings);

impl fmt::Display for Names<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(motors, s) = self;
        if motors.is_empty() {
            return put!(f, " none");
        }
        motors.iter().try_for_each(|motor| write!(f, " {}", s.name_of(motor)))
    }
}

/// The line of an answer.
pub(in crate::machine) fn report_buzz(to: &mut ReplyWriter<'_>, answer: &BuzzAnswer, s: &Settings) {
    match *answer {
        BuzzAnswer::NoMotor(name) => {
            let all = Names(s.mechanism.fitted(), s);
            to.say(text!("echo:STEPPER_BUZZ ignored: there is no motor {name}; STEPPER= is one of{all}"));
        }
        BuzzAnswer::Strains(motor, others) => {
            let (name, others) = (s.name_of(motor), Names(others, s));
            to.say(text!("echo:STEPPER_BUZZ ignored: {name} would strain its belt; FREE= is one of{others}"));
        }
        BuzzAnswer::Done { motor, steps, held, free } => {
            let (name, way) = (s.name_of(motor), Thousandths(s.steps_per_mm(motor).length_of(steps.into())));
            let (held, free) = (Names(held, s), Names(free, s));
            to.say(text!("echo:{name} moved {way} mm to and fro; held:{held}; free:{free}; home again"));
        }
    }
}
