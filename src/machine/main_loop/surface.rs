//! The surface of the bed under the machine: which mesh it has, and whether z follows it.
//!
//! Positions of planner and program count z from the surface; motors stand at real z. A change is made at rest, and
//! nothing moves: the present position gets another z (as Marlin's M420 does), and the next move goes by it.
//!
//! | | |
//! |---|---|
//! | [`use_mesh`] | for commands: z follows the mesh, or not |
//! | [`take_known_mesh`] | for commands: another mesh; they have set whether z follows it |
//! | [`leave_surface`] | at the begin of a command that goes in real z, as homing and probing do |
//! | [`keep_to_surface`] | after each command, however it ended: the Console calls it |
//!
//! While the belt or a motor has the place of z ([`regroup`](super::regroup)), z stands still at its real place.

use super::MainLoop;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::surface::Mesh;

/// Before the first turn: the bed has this mesh, and z is to follow it.
pub(in crate::machine) fn lay_mesh<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, mesh: &Mesh) {
    main_loop.motion.set_mesh(Some(mesh));
    main_loop.live_settings().set_mesh_on(true);
}

/// Takes the mesh that is known of the bed now, or none. The settings say whether z follows it.
pub(in crate::machine) async fn take_known_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    leave_surface(main_loop).await?;
    main_loop.motion.set_mesh(main_loop.bed.mesh().map(|known| &known.mesh));
    keep_to_surface(main_loop).await
}

/// Uses the mesh from now on, or not; motion rests before.
pub(in crate::machine) async fn use_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    on: bool,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    main_loop.live_settings().set_mesh_on(on);
    take_known_mesh(main_loop).await
}

/// Until the end of the command, positions are real ones.
pub(in crate::machine) async fn leave_surface<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    if main_loop.motion.is_on_surface() { stand_on_surface(main_loop, false).await } else { Ok(()) }
}

/// Z follows the mesh, or does not, as the settings say.
pub(in crate::machine) async fn keep_to_surface<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let is_wanted = main_loop.settings.mesh.is_on && main_loop.motion.mesh().is_some();
    if is_wanted == main_loop.motion.is_on_surface() { Ok(()) } else { stand_on_surface(main_loop, is_wanted).await }
}

#[inline(never)]
async fn stand_on_surface<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    is_on: bool,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    let stands = main_loop.motion.use_surface(is_on, &main_loop.settings);
    main_loop.adopt_position(stands).await?;
    let commanded = &mut main_loop.commanded;
    let ([x, y, _, e], [_, _, z, _]) = (commanded.of_machine(commanded.position()), main_loop.motion.end_mm());
    commanded.stand_at([x, y, z, e]);
    Ok(())
}
