//! STEPPER_BUZZ: one motor alone goes a millimetre to and fro, so that a person sees which one it is, and where it
//! brings the tool.
//!
//! Motors that share an axis with it are held, so the tool has one way to go. Of motors that can pull against it some
//! turn freely, as many as it takes ([`Residuals::to_free`]); on a CoreH-bot that is the other motor of its pair. Then
//! the belt is not strained, however the four plugs are swapped: of four motors on one belt, any three may stand where
//! they like. With two residuals, a swapped plug may hold a motor that should be free. Then the way is two full steps,
//! the strain that M915 makes on purpose.
//!
//! A motor that turns freely may settle elsewhere, so all of them lose their power at the end, and the axes their
//! homes. M410 and M108 end it, M112 stops it, and drivers are watched as in every motion.

use crate::kinematics::Residuals;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::words::Facts;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::trim::{end_buzz, turn_alone};
use crate::machine::numbers::Thousandths;
use crate::machine::ports::PortSet;
use crate::machine::state::notices::Notices;
use crate::machine::travel::retraction::forget_retraction;
use crate::motors::{Motor, MotorName, MotorSet};
use crate::port::Wake;
use crate::settings::Settings;
use crate::units::{Mm, StepRate};
use core::fmt;

/// The way of the motor, the parts of a second that it takes, the pauses in ms after going and coming back: those of
/// Klipper, `BUZZ_DISTANCE`, `BUZZ_VELOCITY` and `cmd_STEPPER_BUZZ` (klippy/extras/force_move.py).
const WAY: Mm = Mm::ONE;
const PART_OF_SECOND: u32 = 4;
const AWAY_MS: u32 = 300;
const BACK_MS: u32 = 700;

/// Half as often as in Klipper: 8 s are enough to look, and the guide may repeat it.
const ROUNDS: u8 = 5;

/// Full steps that may strain a belt: M915 trims a motor by as many (`machine::belt::align`).
const STRAINING: i32 = 2;

/// Which motors take part.
struct Cast {
    held: MotorSet,
    free: MotorSet,
}

/// Motors that share an axis with this one.
fn companions(s: &Settings, motor: Motor) -> MotorSet {
    let axes = (0..4).map(|axis| s.mechanism.motors_of(axis)).filter(|motors| motors.has(motor));
    axes.fold(MotorSet::NONE, MotorSet::with).without(MotorSet::of(motor))
}

/// Motors with the same row as this one, or with the opposite one.
fn pair(s: &Settings, motor: Motor) -> MotorSet {
    let row = s.mechanism.rows.get(motor.index()).copied().unwrap_or_default();
    let is_alike = |other: [i8; 4]| other == row || other == row.map(i8::wrapping_neg);
    let alike = s.mechanism.motors().filter(|(_, other)| is_alike(*other));
    alike.fold(MotorSet::NONE, |set, (other, _)| set.with(MotorSet::of(other)))
}

/// Who takes part when `motor` moves and `free` is to turn freely; `None` if the belt would be strained.
fn cast(s: &Settings, residuals: &Residuals, motor: Motor, free: Option<Motor>) -> Option<Cast> {
    let free = free.map_or_else(|| residuals.to_free(motor, pair(s, motor)), MotorSet::of);
    let is_strained = free.has(motor) || residuals.without(free).motors().has(motor);
    (!is_strained).then(|| Cast { held: companions(s, motor).without(free), free })
}

/// How far it goes, in its steps.
fn way(s: &Settings, residuals: &Residuals, motor: Motor) -> i32 {
    let steps = (WAY * s.steps_per_mm(motor)).to_num::<i32>();
    if residuals.iter().len() > 1 && residuals.motors().has(motor) {
        steps.min(STRAINING * i32::from(s.driver_of(motor).microsteps))
    } else {
        steps
    }
}

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

/// STEPPER_BUZZ.
pub(in crate::machine) async fn buzz<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    motor: MotorName,
    free: Option<MotorName>,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.job.is_under_way() {
        return Ok(Answer::Line(packed!("echo:STEPPER_BUZZ ignored: a print is under way")));
    }
    main_loop.finish().await?;
    let s: &Settings = &main_loop.settings;
    let called = |name: MotorName| {
        let motor = s.motors().find(|(motor, known)| *known == name && s.mechanism.fitted().has(*motor));
        motor.map(|(motor, _)| motor).ok_or(name)
    };
    let (motor, free) = match (called(motor), free.map(called).transpose()) {
        (Ok(motor), Ok(free)) => (motor, free),
        (Err(name), _) | (_, Err(name)) => {
            main_loop.tell(|to, Facts { settings: s, .. }| {
                let all = Names(s.mechanism.fitted(), s);
                to.say(text!("echo:STEPPER_BUZZ ignored: there is no motor {name}; STEPPER= is one of{all}"));
            });
            return Ok(Answer::Said);
        }
    };
    let residuals = main_loop.settings.residuals();
    let Some(Cast { held, free }) = cast(s, &residuals, motor, free) else {
        let others = residuals.to_free(motor, pair(s, motor));
        main_loop.tell(|to, Facts { settings: s, .. }| {
            let (name, others) = (s.name_of(motor), Names(others, s));
            to.say(text!("echo:STEPPER_BUZZ ignored: {name} would strain its belt; FREE= is one of{others}"));
        });
        return Ok(Answer::Said);
    };
    let steps = way(s, &residuals, motor);
    if let Err(interrupt) = main_loop.power_for_buzz(held.with(MotorSet::of(motor))).await {
        end_buzz(main_loop);
        return Err(interrupt);
    }
    notices.renew_for_position();
    if main_loop.motion.groups().mechanism().motors_of(3).has(motor) {
        forget_retraction(main_loop);
    }
    go_to_and_fro(main_loop, motor, steps).await?;
    end_buzz(main_loop);
    main_loop.tell(|to, Facts { settings: s, .. }| {
        let (name, way) = (s.name_of(motor), Thousandths(s.steps_per_mm(motor).length_of(steps.into())));
        let (held, free) = (Names(held, s), Names(free, s));
        to.say(text!("echo:{name} moved {way} mm to and fro; held:{held}; free:{free}; home again"));
    });
    Ok(Answer::Said)
}

async fn go_to_and_fro<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    motor: Motor,
    steps: i32,
) -> Result<(), Interrupt> {
    let rate = StepRate::of_whole(steps.unsigned_abs().saturating_mul(PART_OF_SECOND));
    for stroke in 0..2 * ROUNDS {
        let comes_back = stroke % 2 == 1;
        let (by, pause_ms) = if comes_back { (-steps, BACK_MS) } else { (steps, AWAY_MS) };
        let speed = rate / main_loop.settings.axes.x.steps_per_mm;
        turn_alone(main_loop, motor, by, speed).await?;
        main_loop.let_pass(pause_ms).await?;
        main_loop.pauses.end();
        if comes_back && main_loop.pauses.is_over() {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::Mechanism;
    use crate::motors::prototype::{BELT, E0, M1, M4, M8, M11, Z1, Z2};

    fn settings(rows: &[[i8; 4]], is_closed: bool) -> Settings {
        let mut s = Settings::prototype();
        s.mechanism = Mechanism::of(rows);
        s.belt.is_closed = is_closed;
        s
    }

    fn cast_of(s: &Settings, motor: Motor, free: Option<Motor>) -> Option<(MotorSet, MotorSet)> {
        let residuals = Residuals::new(&s.mechanism, s.belt.is_closed);
        cast(s, &residuals, motor, free).map(|Cast { held, free }| (held, free))
    }

    /// So swapped plugs strain nothing: whichever of the four is free, no residual is left.
    #[test]
    fn any_motor_of_one_belt_may_be_the_free_one() {
        let s = Settings::prototype();
        for motor in BELT.iter() {
            for free in BELT.iter() {
                let expected = (motor != free).then(|| {
                    let both = MotorSet::of(motor).with(MotorSet::of(free));
                    (BELT.without(both), MotorSet::of(free))
                });
                assert_eq!(cast_of(&s, motor, Some(free)), expected);
            }
        }
        assert_eq!(cast_of(&s, M1, None), Some((MotorSet::of(M4).with(MotorSet::of(M11)), MotorSet::of(M8))));
        assert_eq!(cast_of(&s, M1, Some(E0)), None, "the extruder does not loosen the belt");
        assert_eq!(cast_of(&s, Z2, None), Some((MotorSet::of(Z1), MotorSet::NONE)));
        assert_eq!(cast_of(&s, E0, None), Some((MotorSet::NONE, MotorSet::NONE)));
    }

    #[test]
    fn motors_of_a_belt_of_their_own_free_each_other_and_go_less_far() {
        // Two motors on each belt of a CoreXY.
        let all_wheel = settings(&[[1, 1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], [-1, 1, 0, 0], [0, 0, 1, 0]], false);
        let residuals = Residuals::new(&all_wheel.mechanism, false);
        assert_eq!(cast_of(&all_wheel, M1, None), Some((MotorSet::of(M4).with(MotorSet::of(M11)), MotorSet::of(M8))));
        assert_eq!(cast_of(&all_wheel, M1, Some(M4)), None);
        assert_eq!(way(&all_wheel, &residuals, M1), 2 * i32::from(all_wheel.drivers.belt.microsteps));
        assert_eq!(way(&all_wheel, &residuals, Z1), 800, "z has no residual");
        let two = settings(&[[1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, 0]], false);
        assert_eq!(cast_of(&two, M1, None), Some((MotorSet::of(M4), MotorSet::NONE)));
        assert_eq!(way(&two, &Residuals::new(&two.mechanism, false), M1), 80);
    }
}
