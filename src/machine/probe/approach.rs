//! One approach of the probe, and moves up after it.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::main_loop::shift_axis::shift_axis;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::settings::HomedAxis;
use crate::units::{Mm, MmPerSec};

/// Moves down by at most `way`; true if the probe has triggered, and then the tool stands where it did.
pub(super) async fn approach<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    way: Mm,
    speed: MmPerSec,
) -> Result<bool, Interrupt> {
    shift_axis(main_loop, HomedAxis::Z as usize, -way, speed, EndstopSet::PROBE).await?;
    let has_met = !main_loop.status.triggered().is_empty();
    main_loop.drop_motion().await?;
    Ok(has_met)
}

/// Distance up to `z`, as far as the axis goes; negative if the nozzle is higher already.
pub(super) fn up_to<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, z: Mm) -> Mm {
    let [_, _, at, _] = main_loop.motion.end_mm();
    z.min(z_reach(main_loop).most).saturating_sub(at)
}

/// Raises the nozzle by a distance; it does not go down.
pub(super) async fn raise_by<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, by: Mm) -> Result<(), Interrupt> {
    if by <= Mm::ZERO {
        return Ok(());
    }
    let speed = main_loop.settings.axes.z.max_speed;
    shift_axis(main_loop, HomedAxis::Z as usize, by, speed, EndstopSet::NONE).await
}

/// Takes the nozzle over a place.
pub(super) async fn travel<P: PortSet, W: Wake>(
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
