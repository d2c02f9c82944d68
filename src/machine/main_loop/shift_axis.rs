//! A move of one axis alone that a switch or the probe may end.

use super::MainLoop;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::units::{Mm, MmPerSec, Steps};

/// Moves one axis, and waits until it arrives or triggers the watched endstop. Where four coordinates hold three axes,
/// the move takes them to whole steps, where all counts agree. From there an axis alone moves all its motors at once,
/// and the counts agree wherever a switch ends the move.
pub(in crate::machine) async fn shift_axis<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: usize,
    by: Mm,
    speed: MmPerSec,
    watch: EndstopSet,
) -> Result<(), Interrupt> {
    let mut steps = main_loop.motion.end();
    if main_loop.motion.groups().is_redundant() {
        steps = steps.map(Steps::wrapping_round);
    }
    let mut position = main_loop.motion.to_mm(steps);
    if let Some(at) = position.get_mut(axis) {
        *at = at.saturating_add(by);
    }
    main_loop.plan(Target { position, speed: speed.into(), has_overrides: false, watch }).await?;
    main_loop.finish().await
}
