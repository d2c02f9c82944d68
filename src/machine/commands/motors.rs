//! Motors, their drivers and belts, each by its command; and M122 for drivers, belt, overload and heat.

use super::belt::{align_belt, examine_belt};
use super::buzz::buzz;
use super::drivers::change_mode;
use super::job::end_by_line;
use super::retraction::forget_retraction;
use super::screws::{level_screws, tell_hand_screws};
use super::states::States;
use crate::driver::DriverJob;
use crate::gcode::{AxisFlags, MotorCommand};
use crate::kinematics::Groups;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::belt::report::report_belt;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::{Motor, MotorSet, Wake};
use crate::settings::{AxisEnd, HomedAxis};
use core::pin::pin;

/// Carries out a command about motors.
pub(super) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &MotorCommand,
) -> Result<Answer<'static>, Interrupt> {
    Ok(match *command {
        MotorCommand::EnableMotors(flags) => {
            main_loop.power_up(motors_of(main_loop.motion.groups(), flags)).await?;
            Answer::Nothing
        }
        MotorCommand::DisableMotors(flags) => return release(main_loop, states, flags).await,
        MotorCommand::IdleTimeout { seconds } => {
            main_loop.power.set_idle_timeout(seconds, main_loop.now());
            Answer::Nothing
        }
        MotorCommand::Stealth { on, axes } => return change_mode(main_loop, states, on, axes).await,
        MotorCommand::AlignBelt { diagnoses: false, repairs: false } => {
            return align_belt(main_loop, &mut states.notices).await;
        }
        MotorCommand::AlignBelt { diagnoses: _, repairs } => {
            return apart(pin!(examine_belt(main_loop, &mut states.notices, repairs))).await;
        }
        MotorCommand::LevelScrews(ref words) => {
            return apart(pin!(level_screws(main_loop, &mut states.clamps, words))).await;
        }
        MotorCommand::HandScrews { thread } => return apart(pin!(tell_hand_screws(main_loop, thread))).await,
        MotorCommand::Buzz { motor, free } => return buzz(main_loop, &mut states.notices, motor, free).await,
    })
}

/// M18, M84.
async fn release<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    flags: AxisFlags,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.finish().await?;
    main_loop.unpower(motors_of(main_loop.motion.groups(), flags));
    states.notices.renew_for_position();
    let all = !(flags.x || flags.y || flags.z || flags.e);
    if all || flags.e {
        forget_retraction(main_loop);
    }
    if all || flags.x || flags.y || flags.z {
        let job = &main_loop.job;
        if job.is_paused() && (job.printed_at().is_some() || job.line().kept().is_some()) {
            tell_of_pause(main_loop);
        } else {
            end_by_line(main_loop, &mut states.modal).await?;
        }
    }
    Ok(Answer::Nothing)
}

/// The print stays paused. Z goes down to a bed that the print covers, unless its switch is above.
fn tell_of_pause<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    let s = &*main_loop.settings;
    let goes_down = s.homes_z_by_probe() || s.endstops.of(HomedAxis::Z).end == AxisEnd::Min;
    let is_risky = goes_down && main_loop.homed.lacks_one_of([false, false, true]);
    let risk = if is_risky { ". Homing Z may hit the part: then end the print" } else { "" };
    main_loop.hosts.notify_all(text!(
        "echo:the print stays paused. To go on, home the axes (G28) and send M24; M524 ends it{risk}"
    ));
}

/// The motors that move the named axes; all if none is named.
pub(super) fn motors_of(groups: &Groups, flags: AxisFlags) -> MotorSet {
    let AxisFlags { x, y, z, e, .. } = flags;
    let mechanism = groups.mechanism();
    let named = [x, y, z, e].into_iter().enumerate().filter(|(_, named)| *named);
    let set = named.fold(MotorSet::NONE, |set, (axis, _)| set.with(mechanism.motors_of(axis)));
    if set.is_empty() { groups.fitted() } else { set }
}

/// M122.
pub(super) async fn diagnose<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Answer<'static>, Interrupt> {
    let fitted = main_loop.motion.groups().fitted();
    for motor in Motor::ALL.into_iter().filter(|motor| fitted.has(*motor)) {
        let has_uart = main_loop.power.uarts().has(motor);
        let reading = if has_uart { Some(main_loop.ask_driver(DriverJob::Read, motor).await?) } else { None };
        main_loop.reply(Answer::Driver(motor, reading)).await?;
    }
    report_belt(main_loop).await?;
    main_loop.tell(Answer::Overload);
    Ok(Answer::Heat)
}
