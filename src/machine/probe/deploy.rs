//! Putting the probe out, and taking it in.

use super::error::ProbeError;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// Puts the probe out. One without a servo is always out.
pub(super) async fn put_out<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), ProbeError> {
    main_loop.probing.note_out(true);
    Ok(())
}

/// Takes it in.
pub(super) async fn take_in<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), ProbeError> {
    main_loop.probing.note_out(false);
    Ok(())
}
