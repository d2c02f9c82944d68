//! The mesh in storage: M500 keeps it beside the settings, M501 and a start take it.

use super::mesh_news::News;
use super::stored::Paced;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::surface::take_known_mesh;
use crate::machine::ports::PortSet;
use crate::port::{StorageError, Wake};
use crate::storage::{self, MeshRejected};

/// Keeps the mesh if there is one that is not kept yet, or forgets the kept one if the present one was forgotten for
/// good. Motion rests.
pub(in crate::machine) async fn keep_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Option<News>, Interrupt> {
    if main_loop.bed.is_part() {
        return Ok(Some(News::Part));
    }
    if main_loop.bed.forgets_kept() {
        return forget_kept_mesh(main_loop).await.map(Some);
    }
    let Some(mesh) = main_loop.bed.unsaved().copied() else { return Ok(None) };
    main_loop.finish().await?;
    let settings = *main_loop.settings;
    let mut paced = Paced::new(main_loop);
    let kept = storage::save_mesh(&mut paced, &mesh, &settings).await;
    paced.into_result()?;
    Ok(Some(match kept {
        Ok(()) => {
            main_loop.bed.note_kept();
            News::Kept
        }
        Err(why) => News::NotKept(why),
    }))
}

/// Forgets the kept mesh. Motion rests.
pub(in crate::machine) async fn forget_kept_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<News, Interrupt> {
    main_loop.finish().await?;
    let mut paced = Paced::new(main_loop);
    let forgotten = storage::forget_mesh(&mut paced).await;
    paced.into_result()?;
    Ok(match forgotten {
        Ok(()) => {
            main_loop.bed.forget(false);
            News::Forgotten
        }
        Err(why) => News::NotKept(why.into()),
    })
}

/// Takes the kept mesh; or why there is none, and then the present one stays. What the settings say of its use comes
/// into force.
pub(in crate::machine) async fn take_kept_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Option<News>, Interrupt> {
    let settings = *main_loop.settings;
    let mut paced = Paced::new(main_loop);
    let found = storage::load_mesh(&mut paced, &settings).await;
    paced.into_result()?;
    let rejected = match found {
        Ok(Ok(mesh)) => {
            main_loop.bed.take_kept(mesh);
            None
        }
        Ok(Err(why)) => Some(why),
        Err(StorageError::Absent) => Some(MeshRejected::Blank),
        Err(StorageError::Failed) => Some(MeshRejected::Damaged),
    };
    if main_loop.bed.mesh().is_some() {
        take_known_mesh(main_loop).await?;
    }
    Ok(rejected.map(News::Rejected))
}

/// The same; no news is worth a line if no mesh is to be used.
pub(in crate::machine) async fn take_mesh_to_use<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Option<News>, Interrupt> {
    Ok(take_kept_mesh(main_loop).await?.filter(|_| main_loop.settings.mesh.is_on))
}
