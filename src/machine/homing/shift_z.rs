//! Moves that a command makes by itself, and after which the program stands where they end: the tool goes up before it
//! crosses a print, or over a place.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::units::{Mm, MmPerSec};

/// Moves z alone at a speed, and waits until it stands or a switch in `watch` is met.
pub(in crate::machine) async fn shift_z<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    by: Mm,
    speed: MmPerSec,
    watch: EndstopSet,
) -> Result<(), Interrupt> {
    if by == Mm::ZERO {
        return Ok(());
    }
    let mut position = main_loop.motion.end_mm();
    let [_, _, z, _] = &mut position;
    *z = z.saturating_add(by);
    go_to(main_loop, position, speed, watch).await
}

/// Goes straight to a place, and waits until the tool stands or a switch in `watch` is met.
pub(in crate::machine) async fn go_to<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    position: [Mm; 4],
    speed: MmPerSec,
    watch: EndstopSet,
) -> Result<(), Interrupt> {
    main_loop.plan(Target { position, speed: speed.into(), has_overrides: false, watch }).await?;
    main_loop.finish().await?;
    if watch != EndstopSet::NONE {
        main_loop.drop_motion().await?;
    }
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    Ok(())
}
