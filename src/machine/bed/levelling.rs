//! Levelling: whether z follows the mesh (M420), and how a mesh that was measured or changed comes into use.

use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::surface::use_mesh;
use crate::machine::numbers::{Thousandths, exact};
use crate::machine::ports::PortSet;
use crate::machine::reports::mesh_report::{NO_MESH, report_grid, report_levelling, report_table};
use crate::machine::setup::kept_mesh::take_kept_mesh;
use crate::machine::states::States;
use crate::port::Wake;
use crate::settings::ranges;
use crate::surface::{Heights, Mesh, MeshError, UNITS_PER_MM};
use crate::units::Mm;

/// The words of M420.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct LevellingWords {
    /// S: whether the mesh is used.
    pub on: Option<bool>,
    /// V: reports the mesh.
    pub reports: bool,
    /// T1: as a table for programs.
    pub form: Option<Number>,
    /// Z: the height up to which it fades; 0 is no fade.
    pub fade: Option<Number>,
    /// C: its mean becomes 0.
    pub centres: bool,
    /// L: takes the mesh that was kept.
    pub loads: bool,
}

impl LevellingWords {
    /// S1 alone.
    pub const USE: Self = Self { on: Some(true), reports: false, form: None, fade: None, centres: false, loads: false };

    /// Whether it does more than report.
    const fn changes(&self) -> bool {
        self.on.is_some() || self.fade.is_some() || self.centres || self.loads
    }
}

/// The mesh as a report, if there is one: for people, or as a table for programs.
pub(in crate::machine) fn report<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    is_table: bool,
) -> Answer<'static> {
    match main_loop.bed.mesh() {
        None => Answer::Line(NO_MESH),
        Some(_) if is_table => Answer::words(&report_table),
        Some(_) => Answer::words(&report_grid),
    }
}

/// Forgets the mesh; then M500 forgets the kept one too, if it is so wanted. Returns whether there was one.
pub(in crate::machine) async fn forget<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    kept_too: bool,
) -> Result<bool, Interrupt> {
    let was_there = main_loop.bed.mesh().is_some();
    use_mesh(main_loop, false).await?;
    main_loop.bed.forget(kept_too);
    Ok(was_there)
}

/// M420.
pub(in crate::machine) async fn level<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    words: &LevellingWords,
) -> Result<Answer<'static>, Interrupt> {
    let LevellingWords { on, reports, form, fade, centres, loads } = *words;
    if loads && let Some(news) = take_kept_mesh(main_loop).await? {
        main_loop.say(text!("{news}"));
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
        let answer = report(main_loop, form == Some(Number::from(1)));
        main_loop.reply(answer).await?;
    } else if on == Some(true) && main_loop.bed.mesh().is_none() {
        main_loop.say(text!("{NO_MESH}"));
    }
    let on = on.unwrap_or(main_loop.settings.mesh.is_on) && main_loop.bed.mesh().is_some();
    if words.changes() {
        use_mesh(main_loop, on).await?;
    }
    Ok(Answer::words(&report_levelling))
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
pub(in crate::machine) fn change_heights<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, heights: &Heights) {
    let Some(known) = main_loop.bed.mesh() else { return };
    let (first, last) = (known.mesh.first(), known.mesh.last());
    let mesh = mesh_of(main_loop, heights, first, last);
    main_loop.bed.change(mesh.as_ref());
}

/// A mesh with the fade of the settings; none if these heights make none. If the fade is too short for it, it does not
/// fade, and the host gets to know.
pub(in crate::machine) fn mesh_of<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    heights: &Heights,
    first: [Mm; 2],
    last: [Mm; 2],
) -> Option<Mesh> {
    match Mesh::new(*heights, first, last, main_loop.settings.mesh.fade) {
        Ok(mesh) => {
            if mesh.has_short_fade() {
                let (fade, deviation) = (exact(main_loop.settings.mesh.fade), deviation(&mesh));
                main_loop.say(text!(
                    "echo:Fade height {fade} is short for a mesh of {deviation} mm: layers differ by a tenth"
                ));
            }
            Some(mesh)
        }
        Err(MeshError::FadesTooFast) => {
            let flat = Mesh::new(*heights, first, last, Mm::ZERO).ok()?;
            let (fade, deviation) = (exact(main_loop.settings.mesh.fade), deviation(&flat));
            main_loop.say(text!("echo:Fade height {fade} is too short for a mesh of {deviation} mm: it does not fade"));
            Some(flat)
        }
        Err(_) => None,
    }
}

fn deviation(mesh: &Mesh) -> Thousandths {
    Thousandths(Mm::saturating_from_num(mesh.deviation()))
}

/// A height in the units of a mesh.
pub(in crate::machine) fn units(height: Mm) -> i16 {
    let bits = i64::from(UNITS_PER_MM) * (height.to_bits() >> 8);
    ((bits + (1 << 23)) >> 24).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}
