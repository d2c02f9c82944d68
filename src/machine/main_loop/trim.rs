//! Trim: one motor of a belt turns against the others, which strains the belt or takes strain from it.
//!
//! The motor takes the place of z during a trim, as a circulating belt does (`belt::circulate`). The position in the
//! firmware stays the same, though the tool moves by about a quarter of the trim.

use super::regroup::couple;
use crate::kinematics::{Grouping, Residual};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::{Motor, Wake};
use crate::units::{MmPerSec, Steps};

/// The motor of a residual that is turned against the others, and its part of the sum.
pub(in crate::machine) fn trimmed(residual: &Residual) -> Option<(Motor, i32)> {
    Motor::ALL.into_iter().zip(*residual).find(|(_, times)| *times != 0)
}

/// Residual caused by a preload in steps: the trimmed motor turns by it.
pub(in crate::machine) fn preload_of(residual: &Residual, preload: i32) -> i32 {
    trimmed(residual).map_or(0, |(_, times)| preload * times.abs())
}

/// Turns one motor by `by` steps, and no other, when motion rests. All motors of the belt have power.
pub(in crate::machine) async fn trim<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    motor: Motor,
    by: i32,
) -> Result<(), Interrupt> {
    let speed = main_loop.settings.belt.max_speed;
    turn_alone(main_loop, motor, by, speed).await
}

/// The same at a speed in mm/s of x. Whoever calls it decides which motors have power.
pub(in crate::machine) async fn turn_alone<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    motor: Motor,
    by: i32,
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    turn_in(main_loop, Grouping::Trim, motor, by, speed).await
}

/// Turns one motor of z alone, within the limits of z: z counts steps as if it had not.
pub(in crate::machine) async fn turn_screw<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    motor: Motor,
    by: i32,
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    turn_in(main_loop, Grouping::Screw, motor, by, speed).await
}

async fn turn_in<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    grouping: Grouping,
    motor: Motor,
    by: i32,
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    // A stroke may still be moving if its driver did not answer.
    main_loop.finish().await?;
    if by == 0 {
        return Ok(());
    }
    let ([x, y, real_z, _], [.., z, e]) = (main_loop.motion.real_steps(), main_loop.motion.end());
    // On a surface, where the motors of x and y stand is at another height than the end of the last move.
    let z = if main_loop.motion.is_on_surface() { real_z } else { z };
    main_loop.trimming.begin([x, y, z, e]);
    let coupling = main_loop.motion.groups_in(grouping).trim_coupling(motor);
    let [x, y] = [x, y].map(Steps::wrapping_round);
    couple(main_loop, grouping, &coupling, [x, y, Steps::ZERO, e]).await?;
    main_loop.motion.plan_whole(
        [x, y, Steps::wrapping_from_num(i64::from(by)), e],
        speed.into(),
        false,
        &main_loop.settings,
    );
    main_loop.finish().await?;
    end_trim(main_loop).await
}

/// The motor has finished its turn, or was stopped: z has its place again. Motion rests.
pub(in crate::machine) async fn end_trim<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    if !matches!(main_loop.motion.grouping(), Grouping::Trim | Grouping::Screw) {
        return Ok(());
    }
    let held = main_loop.trimming.held();
    let coupling = main_loop.motion.groups_in(Grouping::Tool).coupling();
    couple(main_loop, Grouping::Tool, &coupling, held).await?;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    Ok(())
}

/// Takes the power from motors that had it for a buzz, without others of their belt. Motion rests.
pub(in crate::machine) fn end_buzz<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    let motors = main_loop.trimming.end_buzz();
    if !motors.is_empty() {
        main_loop.unpower(motors);
    }
}
