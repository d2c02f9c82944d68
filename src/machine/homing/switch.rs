//! Switches: an axis finds its endstop fast, backs off, and finds it again slowly. The result homes the axis or only
//! measures the switch.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::name_home;
use crate::machine::main_loop::shift_axis::shift_axis;
use crate::machine::ports::PortSet;
use crate::machine::state::job::{HomingFailure, JobEnd};
use crate::port::{EndstopSet, MotorSet, Wake};
use crate::settings::{Endstop, HomedAxis, Homing, Range};
use crate::units::{Mm, MmPerSec};

/// Search distance beyond an axis' length: the machine may stand a little outside.
const BEYOND: Mm = Mm::const_from_int(10);

/// The farthest that skipped steps may have moved a tool with a known place: 25 electrical turns of 0.8 mm.
const ASIDE: Mm = Mm::const_from_int(20);

/// An axis that can be homed.
#[derive(Clone, Copy)]
struct Axis {
    axis: HomedAxis,
    index: usize,
    switch: EndstopSet,
    endstop: Endstop,
    /// Where the planner has the axis at its switch.
    place: Mm,
    homing: Homing,
    reach: Range<Mm>,
}

/// Homes an axis. If that fails the job ends: hosts get the reason.
pub(in crate::machine) async fn home_named<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: HomedAxis,
) -> Result<(), Interrupt> {
    let axis = facts(main_loop, axis);
    let was_homed = main_loop.homed.axes().get(axis.index) == Some(&true);
    main_loop.homed.begin(axis.index);
    home_axis(main_loop, &axis, was_homed).await?;
    main_loop.homed.stop();
    Ok(())
}

/// The axis stays where it is, and its place is not known: the job ends.
#[cold]
#[inline(never)]
fn give_up<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, axis: &Axis, why: HomingFailure) -> Interrupt {
    main_loop.homed.stop();
    let mechanism = main_loop.motion.groups().mechanism();
    // A search in vain ends where the frame stops the axis.
    let is_pressed = matches!(why, HomingFailure::NotMet { .. });
    let pressed = if is_pressed { mechanism.motors_of(axis.index) } else { MotorSet::NONE };
    main_loop.homed.fail(axis.index, pressed, mechanism);
    if main_loop.settings.residuals().motors().intersects(pressed) {
        main_loop.trimming.forget();
    }
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    main_loop.job.note_end(JobEnd::NotHomed { axis: axis.axis, why });
    Interrupt::EndJob
}

/// Meets the switch of an axis once more, and backs off. Returns the distance in steps from the expected position: the
/// tool is off by that much.
pub(in crate::machine) async fn touch<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: HomedAxis,
) -> Result<i32, Interrupt> {
    let axis = &facts(main_loop, axis);
    // The place is known: where the switch is dead, the axis does not press on along its whole length.
    let at = main_loop.motion.end_mm().get(axis.index).copied().unwrap_or_default();
    let back_off = find_switch(main_loop, axis, axis.endstop.towards(axis.place.saturating_sub(at)) + ASIDE).await?;
    let aside = steps_aside(main_loop, axis);
    shift_axis(main_loop, axis.index, -axis.endstop.towards(back_off), axis.homing.fast, EndstopSet::NONE).await?;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    main_loop.homed.stop();
    Ok(aside)
}

/// Distance in steps of the switch that was just met from its expected position.
fn steps_aside<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, axis: &Axis) -> i32 {
    let (places, met) = (main_loop.motion.to_steps([axis.place; 4]), main_loop.motion.real_steps());
    let aside = places.get(axis.index).zip(met.get(axis.index)).map(|(place, met)| place.wrapping_sub(*met));
    aside.unwrap_or_default().wrapping_round().to_num()
}

/// The input of an axis' switch.
pub(in crate::machine) const fn switch_of(axis: HomedAxis) -> EndstopSet {
    match axis {
        HomedAxis::X => EndstopSet::X,
        HomedAxis::Y => EndstopSet::Y,
        HomedAxis::Z => EndstopSet::Z,
    }
}

/// The facts of an axis.
fn facts<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, axis: HomedAxis) -> Axis {
    let s = &*main_loop.settings;
    let switch = switch_of(axis);
    let (endstop, homing, reach) = (s.endstops.of(axis), s.homing.of(axis), s.reach(axis));
    // The offset of z is between the switch and the place that the program names.
    let offset = if axis == HomedAxis::Z { s.bed.z_offset } else { Mm::ZERO };
    let place = endstop.position.saturating_sub(offset);
    Axis { axis, index: axis as usize, switch, endstop, place, homing, reach }
}

async fn home_axis<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: &Axis,
    was_homed: bool,
) -> Result<(), Interrupt> {
    find_switch(main_loop, axis, axis.endstop.longest_way(axis.reach) + BEYOND).await?;
    if was_homed {
        let aside = steps_aside(main_loop, axis);
        main_loop.trimming.note_homed(axis.index, aside);
    }
    stand_at(main_loop, axis.index, axis.place).await?;
    main_loop.homed.arrive(axis.index);
    name_home(main_loop, axis.index);
    Ok(())
}

/// Finds the switch fast within this way, backs off and finds it slowly. Returns the distance of its back-off.
async fn find_switch<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: &Axis,
    way: Mm,
) -> Result<Mm, Interrupt> {
    let start = main_loop.motion.real_steps();
    if !approach(main_loop, axis, way, axis.homing.fast).await? {
        return Err(give_up(main_loop, axis, HomingFailure::NotMet { way: way.to_num() }));
    }
    // If the axis did not move, it was at the switch already, or anywhere behind it.
    let depth = if main_loop.motion.real_steps() == start { axis.endstop.depth(axis.reach) } else { Mm::ZERO };
    let back_off = axis.homing.back_off + depth;
    shift_axis(main_loop, axis.index, -axis.endstop.towards(back_off), axis.homing.fast, EndstopSet::NONE).await?;
    // Twice the distance backed off finds any switch that is still there.
    let sought = back_off * 2;
    let before = main_loop.motion.real_steps();
    if !approach(main_loop, axis, sought, axis.homing.slow).await? {
        return Err(give_up(main_loop, axis, HomingFailure::NotMet { way: sought.to_num() }));
    }
    if main_loop.motion.real_steps() == before {
        return Err(give_up(main_loop, axis, HomingFailure::StillPressed { back_off: back_off.to_num() }));
    }
    let path = main_loop.motion.path();
    main_loop.homed.note_met(axis.index, path);
    Ok(back_off)
}

/// Moves towards the switch; true if it was met.
async fn approach<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: &Axis,
    distance: Mm,
    speed: MmPerSec,
) -> Result<bool, Interrupt> {
    if !main_loop.status.inputs().has(axis.switch) {
        return Err(give_up(main_loop, axis, HomingFailure::NotConnected));
    }
    shift_axis(main_loop, axis.index, axis.endstop.towards(distance), speed, axis.switch).await?;
    let met = !main_loop.status.triggered().is_empty();
    main_loop.drop_motion().await?;
    Ok(met)
}

/// The axis stands at a place, such as its switch, or at the whole step next to it. Motors stand on whole steps, so an
/// axis that shares them with this one may lie between two of its own steps. It moves to a whole step, half a step
/// away. Where motors have pulleys of different sizes the step of an axis is long, and no whole step puts all of them
/// on whole steps.
pub(in crate::machine) async fn stand_at<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: usize,
    place: Mm,
) -> Result<(), Interrupt> {
    let mechanism = main_loop.motion.groups().mechanism();
    let mut position = main_loop.motion.real_steps();
    let [x, y, z, _] = main_loop.motion.to_steps([place; 4]);
    for (other, (at, switch)) in position.iter_mut().zip([x, y, z]).enumerate() {
        if other == axis {
            *at = if mechanism.has_multiples() { switch } else { switch.wrapping_round() };
        } else if !mechanism.has_multiples() && mechanism.share(other, axis) {
            *at = at.wrapping_round();
        }
    }
    main_loop.adopt_position(position).await?;
    main_loop.commanded.forget_park(axis);
    let stands = main_loop.motion.to_mm(position);
    main_loop.commanded.stand_at(stands);
    Ok(())
}
