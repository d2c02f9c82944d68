//! One approach of the probe, and moves up after it.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::shift_axis::shift_axis;
use crate::machine::main_loop::z_offset::z_reach;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::settings::HomedAxis;
use crate::units::{Mm, MmPerSec};

/// Moves down by at most `way`; true if the probe has triggered, and then the tool stands where it did.
pub(super) async fn approach<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    way: Mm,
    speed: MmPerSec,
) -> Result<bool, Interrupt> {
    shift_axis(main_loop, HomedAxis::Z as usize, -way, speed, EndstopSet::PROBE).await?;
    let has_met = !main_loop.status.triggered().is_empty();
    main_loop.drop_motion().await?;
    Ok(has_met)
}

/// Raises the nozzle to `z`, unless it is higher already, as far as the axis goes.
pub(super) async fn raise_to<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, z: Mm) -> Result<(), Interrupt> {
    let [_, _, at, _] = main_loop.motion.end_mm();
    let top = z_reach(main_loop).most;
    raise_by(main_loop, z.min(top).saturating_sub(at)).await
}

/// Raises the nozzle by a distance; it does not go down.
pub(super) async fn raise_by<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, by: Mm) -> Result<(), Interrupt> {
    if by <= Mm::ZERO {
        return Ok(());
    }
    let speed = main_loop.settings.axes.z.max_speed;
    shift_axis(main_loop, HomedAxis::Z as usize, by, speed, EndstopSet::NONE).await
}

/// Takes the nozzle over a place.
pub(super) async fn travel<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    [to_x, to_y]: [Mm; 2],
) -> Result<(), Interrupt> {
    let mut position = main_loop.motion.end_mm();
    let [x, y, ..] = &mut position;
    (*x, *y) = (to_x, to_y);
    let speed = main_loop.settings.probe.travel;
    main_loop.plan(Target { position, speed: speed.into(), has_overrides: false, watch: EndstopSet::NONE }).await?;
    main_loop.finish().await
}

/// Whether the probe reads as triggered now.
pub(super) async fn is_triggered<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) -> Result<bool, Interrupt> {
    let before = main_loop.status.stepper_beat();
    main_loop.motion.look_at_endstops();
    main_loop.poll().await?;
    // In a simulation the main loop may go round before the Stepper has its turn.
    while main_loop.status.stepper_beat() == before {
        main_loop.poll().await?;
    }
    Ok(main_loop.status.endstops().has(EndstopSet::PROBE))
}
