//! The motors: M17 and M84 for the motors of named axes, and M122 for drivers, belt, overload and heat.

use crate::driver::Job;
use crate::gcode::AxisFlags;
use crate::kinematics::Groups;
use crate::machine::answers::answer::Answer;
use crate::machine::belt::report::report_belt;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::{Motor, MotorSet, Pend};

/// The motors that move the named axes; all if none is named.
pub(super) fn motors_of(groups: &Groups, flags: AxisFlags) -> MotorSet {
    let AxisFlags { x, y, z, e, .. } = flags;
    let mechanism = groups.mechanism();
    let named = [x, y, z, e].into_iter().enumerate().filter(|(_, named)| *named);
    let set = named.fold(MotorSet::NONE, |set, (axis, _)| set.with(mechanism.motors_of(axis)));
    if set.is_empty() { groups.fitted() } else { set }
}

/// M122.
pub(super) async fn diagnose<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Answer<'static>, Interrupt> {
    let fitted = main_loop.groups().fitted();
    for motor in Motor::ALL.into_iter().filter(|motor| fitted.has(*motor)) {
        let has_uart = main_loop.power.uarts().has(motor);
        let reading = if has_uart { Some(main_loop.ask_driver(Job::Read, motor).await?) } else { None };
        main_loop.reply(Answer::Driver(motor, reading)).await?;
    }
    report_belt(main_loop).await?;
    main_loop.reply(Answer::Overload).await?;
    Ok(Answer::Heat)
}
