//! The mesh of the bed, and the area that a print needs (M555, EXCLUDE_OBJECT_DEFINE).

use super::levelling::{level, report, use_mesh};
use super::measure::measure;
use super::mesh_points::{change_point, go_to_point};
use super::settings::kept_mesh::{forget_kept_mesh, keep_mesh};
use super::states::States;
use crate::gcode::{BedCommand, Forgets};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::mesh_answer::{MeshAnswer, MeshForm};
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::known_bed::PrintArea;
use crate::port::Wake;
use core::pin::pin;

/// Carries out a command about the bed.
pub(super) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &BedCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    Ok(match *command {
        BedCommand::Measure(ref words) => return apart(pin!(measure(main_loop, states, words))).await,
        BedCommand::Forget(which) => {
            let was_there = main_loop.bed.mesh().is_some();
            use_mesh(main_loop, false).await?;
            main_loop.bed.forget(which == Forgets::PresentThenKept);
            match which {
                Forgets::Kept => Answer::Mesh(forget_kept_mesh(main_loop).await?),
                Forgets::PresentThenKept if was_there => {
                    Answer::Line(packed!("echo:mesh forgotten, and by M500 the stored one too"))
                }
                Forgets::Present | Forgets::PresentThenKept => Answer::Nothing,
            }
        }
        BedCommand::CleanNozzle => {
            Answer::Line(packed!("echo:G29 P9 ignored: this firmware does not clean the nozzle"))
        }
        BedCommand::Tilt => {
            Answer::Line(packed!("echo:G29 J ignored: this firmware does not tilt a mesh. G29 measures it again"))
        }
        BedCommand::Levelling(ref words) => return apart(pin!(level(main_loop, states, words))).await,
        BedCommand::Report => report(main_loop, MeshForm::Grid),
        BedCommand::Save if main_loop.bed.mesh().is_none() => Answer::Mesh(MeshAnswer::None),
        BedCommand::Save => Answer::Mesh(keep_mesh(main_loop).await?.unwrap_or(MeshAnswer::State)),
        BedCommand::Point(ref words) => return change_point(main_loop, states, words).await,
        BedCommand::GoTo { point, by_probe, feed } => {
            return go_to_point(main_loop, states, point, by_probe, feed).await;
        }
        BedCommand::Object { outline } => {
            states.area.add_object(outline);
            Answer::Nothing
        }
        BedCommand::NoObjects => {
            states.area = PrintArea::NONE;
            Answer::Nothing
        }
    })
}
