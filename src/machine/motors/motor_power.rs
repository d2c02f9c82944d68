//! M17, M18, M84: power of motors.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{AxisFlags, Grammar, NO_AXES, Number, Part};
use crate::kinematics::Groups;
use crate::machine::print::job::end_by_line;
use crate::machine::travel::retraction::forget_retraction;
use crate::port::MotorSet;
use crate::settings::{AxisEnd, HomedAxis};

pub(in crate::machine) const ON: Entry = Entry::m("Motors and drivers", &[17])
    .grammar(&Grammar::numbers(b"").no_axes(NO_AXES).parts(&[(b'E', Part::Extruder)]))
    .does("X Y Z E", "power for the named axes, all without words")
    .examples(&[("M17", &[])]);

/// With S the seconds without motion after which motors lose power; 0 is never.
pub(in crate::machine) const OFF: Entry = Entry::m("Motors and drivers", &[18, 84])
    .grammar(&Grammar::numbers(b"S").no_axes(NO_AXES).not_negative(b"S").parts(&[(b'E', Part::Extruder)]))
    .does("X Y Z E, S", "power off; S sets the idle time in s, 0 is never")
    .examples(&[("M18", &[]), ("M84 X Y E", &[]), ("M84 S0", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let flags = command.flags();
    if command.code() == 17 {
        main_loop.power_up(motors_of(main_loop.motion.groups(), flags)).await?;
    } else if let Some(seconds) = command.number(b'S').map(Number::to_u32) {
        main_loop.power.set_idle_timeout(seconds, main_loop.now());
    } else {
        release(main_loop, states, flags).await?;
    }
    Ok(Answer::Nothing)
}

/// M18, M84.
async fn release<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    flags: AxisFlags,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    main_loop.unpower(motors_of(main_loop.motion.groups(), flags));
    states.notices.renew_for_position();
    let all = !(flags.x || flags.y || flags.z || flags.e);
    if all || flags.e {
        forget_retraction(main_loop);
    }
    if all || flags.x || flags.y || flags.z {
        let job = &main_loop.job;
        if job.is_paused() && (job.printed_at().is_some() || job.line().reason().is_some()) {
            tell_of_pause(main_loop);
        } else {
            end_by_line(main_loop, &mut states.modal).await?;
        }
    }
    Ok(())
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
fn motors_of(groups: &Groups, flags: AxisFlags) -> MotorSet {
    let AxisFlags { x, y, z, e, .. } = flags;
    let mechanism = groups.mechanism();
    let named = [x, y, z, e].into_iter().enumerate().filter(|(_, named)| *named);
    let set = named.fold(MotorSet::NONE, |set, (axis, _)| set.with(mechanism.motors_of(axis)));
    if set.is_empty() { groups.fitted() } else { set }
}
