//! The sweep of a resonance test, which no shaper changes.

use super::MainLoop;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::motion::{Sweep, Work};
use crate::port::Wake;
use crate::settings::{Shaper, ShaperKind, Shapers};

/// Begins a sweep, at rest. When it is over, motion is dropped, which brings the shapers back.
pub(in crate::machine) async fn sweep<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    sweep: Sweep,
) -> Result<(), Interrupt> {
    let off = |shaper: Shaper| Shaper { kind: ShaperKind::None, ..shaper };
    let Shapers { x, y } = main_loop.settings.shapers;
    main_loop.follow_through(Shapers { x: off(x), y: off(y) }).await?;
    main_loop.until(|c| c.motion.has_room_for_work()).await?;
    main_loop.motion.send(Work::Sweep(sweep));
    Ok(())
}
