//! Commands that wait for time (G4). Waits for heat are in [`heating`](super::heating), those for the user in
//! [`pause`](super::pause).

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// G4: lets time pass in the motion itself; M108 ends it.
pub(in crate::machine) async fn dwell<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    ms: u32,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    if ms == 0 {
        return Ok(());
    }
    main_loop.let_pass(ms).await
}
