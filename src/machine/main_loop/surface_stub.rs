use super::MainLoop;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::port::Pend;
use crate::surface::Mesh;

pub(in crate::machine) async fn use_surface<P: PortSet, W: Pend>(
    _main_loop: &mut MainLoop<'_, P, W>,
    _mesh: Option<&Mesh>,
) -> Result<(), Interrupt> {
    Ok(())
}
