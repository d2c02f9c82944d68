//! Levelling: whether z follows the mesh (M420), and how a mesh that was measured or changed comes into use.

use super::settings::kept_mesh::take_kept_mesh;
use super::states::States;
use crate::gcode::{LevellingWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::mesh_answer::{MeshAnswer, MeshForm};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::surface::take_known_mesh;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::settings::ranges;
use crate::surface::{Heights, Mesh, MeshError, UNITS_PER_MM};
use crate::units::Mm;

/// The mesh as a report, if there is one.
pub(super) fn report<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, form: MeshForm) -> Answer<'static> {
    match main_loop.bed.mesh() {
        Some(_) => Answer::Mesh(MeshAnswer::Heights(form)),
        None => Answer::Mesh(MeshAnswer::None),
    }
}

/// Uses the mesh from now on, or not; motion rests before.
pub(super) async fn use_mesh<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    on: bool,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    main_loop.live_settings().set_mesh_on(on);
    take_known_mesh(main_loop).await
}

/// M420.
pub(super) async fn level<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    words: &LevellingWords,
) -> Result<Answer<'static>, Interrupt> {
    let LevellingWords { on, reports, form, fade, centres, loads } = *words;
    if loads && let Some(news) = take_kept_mesh(main_loop).await? {
        main_loop.tell(Answer::Mesh(news));
    }
    if let Some(fade) = fade {
        let (old, clamps) = (main_loop.settings.mesh.fade, &mut states.clamps);
        // 0 is no fade.
        let fade = if fade == Number::ZERO {
            Some(Mm::ZERO)
        } else {
            clamps.length_of(&states.modal, ["M420", "Z"], fade, ranges::MESH_FADE, Some(old))
        };
        let Some(fade) = fade else { return Ok(Answer::Nothing) };
        main_loop.live_settings().set_fade(fade);
    }
    if let Some(known) = main_loop.bed.mesh()
        && (centres || known.mesh.fade() != main_loop.settings.mesh.fade)
    {
        let mut heights = *known.mesh.heights();
        if centres {
            centre(&mut heights);
        }
        change_heights(main_loop, &heights);
    }
    if reports {
        let form = if form == Some(Number::from(1)) { MeshForm::Table } else { MeshForm::Grid };
        let answer = report(main_loop, form);
        main_loop.reply(answer).await?;
    } else if on == Some(true) && main_loop.bed.mesh().is_none() {
        main_loop.tell(Answer::Mesh(MeshAnswer::None));
    }
    let on = on.unwrap_or(main_loop.settings.mesh.is_on) && main_loop.bed.mesh().is_some();
    if words.changes() {
        use_mesh(main_loop, on).await?;
    }
    Ok(Answer::Mesh(MeshAnswer::State))
}

/// Heights are counted from their mean.
fn centre(heights: &mut Heights) {
    let mean = heights.mean();
    let mean = if mean < 0.0 { mean - 0.5 } else { mean + 0.5 } as i16;
    for row in 0..heights.rows() {
        for column in 0..heights.columns() {
            heights.set(column, row, heights.get(column, row).saturating_sub(mean));
        }
    }
}

/// The mesh has other heights, and the fade of the settings.
pub(super) fn change_heights<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, heights: &Heights) {
    let Some(known) = main_loop.bed.mesh() else { return };
    let (first, last) = (known.mesh.first(), known.mesh.last());
    let mesh = mesh_of(main_loop, heights, first, last);
    main_loop.bed.change(mesh.as_ref());
}

/// A mesh with the fade of the settings; none if these heights make none. If the fade is too short for it, it does not
/// fade, and the host gets to know.
pub(super) fn mesh_of<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    heights: &Heights,
    first: [Mm; 2],
    last: [Mm; 2],
) -> Option<Mesh> {
    match Mesh::new(*heights, first, last, main_loop.settings.mesh.fade) {
        Ok(mesh) => {
            if mesh.has_short_fade() {
                main_loop.tell(Answer::Mesh(MeshAnswer::ShortFade(deviation(&mesh))));
            }
            Some(mesh)
        }
        Err(MeshError::FadesTooFast) => {
            let flat = Mesh::new(*heights, first, last, Mm::ZERO).ok()?;
            main_loop.tell(Answer::Mesh(MeshAnswer::NoFade(deviation(&flat))));
            Some(flat)
        }
        Err(_) => None,
    }
}

fn deviation(mesh: &Mesh) -> Mm {
    Mm::saturating_from_num(mesh.deviation())
}

/// A height in the units of a mesh.
pub(super) fn units(height: Mm) -> i16 {
    let bits = i64::from(UNITS_PER_MM) * (height.to_bits() >> 8);
    ((bits + (1 << 23)) >> 24).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}
