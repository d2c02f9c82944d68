//! Motion: moves, modes for later lines, overrides, retraction.

use super::homing::home;
use super::levelling::use_mesh;
use super::moves::Moves;
use super::states::States;
use super::waits::dwell;
use crate::gcode::{AxisWords, MotionCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::mesh_answer::MeshAnswer;
use crate::machine::answers::says::Facts;
use crate::machine::answers::speaker::Speaker;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::{FARTHEST, Modal, PERCENT};
use crate::port::Pend;
use crate::units::Mm;
use core::pin::pin;

/// Carries out a command of motion.
pub(super) async fn carry_out<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &MotionCommand,
) -> Result<Answer<'static>, Interrupt> {
    let States { modal, retraction, clamps, notices, pieces: _, cold, area: _ } = states;
    match *command {
        MotionCommand::Line { rapid: _, ref to, feed } => {
            return Moves { main_loop, modal, clamps, notices, cold }.line(to, feed).await;
        }
        MotionCommand::Circulate { ref to, belt, feed } => {
            return apart(pin!(Moves { main_loop, modal, clamps, notices, cold }.circulate(to, belt, feed))).await;
        }
        MotionCommand::Arc(ref words) => {
            return apart(pin!(Moves { main_loop, modal, clamps, notices, cold }.arc(words))).await;
        }
        MotionCommand::Dwell { ms } => dwell(main_loop, ms).await?,
        MotionCommand::Retract => return Moves { main_loop, modal, clamps, notices, cold }.retract(retraction).await,
        MotionCommand::Recover => return Moves { main_loop, modal, clamps, notices, cold }.recover(retraction).await,
        MotionCommand::Home(words) => {
            // In the units of the line (G20), which `home` does not know.
            let raise = words.raise.map(|raise| modal.length(raise));
            apart(pin!(home(main_loop, notices, words, raise))).await?;
            if words.drops_mesh && main_loop.settings.mesh.is_on {
                use_mesh(main_loop, false).await?;
                return Ok(Answer::Mesh(MeshAnswer::State));
            }
        }
        MotionCommand::Finish => main_loop.finish().await?,
        // The receive path has acted on it.
        MotionCommand::QuickStop => {}
        MotionCommand::Absolute => modal.absolute = true,
        MotionCommand::Relative => modal.absolute = false,
        MotionCommand::AbsoluteExtrusion => modal.absolute_extrusion = true,
        MotionCommand::RelativeExtrusion => modal.absolute_extrusion = false,
        MotionCommand::SetPosition(ref words) => set_position(main_loop, modal, clamps, words),
        MotionCommand::FeedPercent(None) => {
            return Ok(Answer::says(say_feed, i32::from(main_loop.motion.feed_percent())));
        }
        MotionCommand::FeedPercent(Some(number)) => {
            if let Some(percent) = clamps.whole_of(["M220", "S"], number, PERCENT, None) {
                main_loop.override_feed(percent).await?;
            }
        }
        MotionCommand::BackUpFeedPercent => modal.kept_feed_percent = main_loop.motion.feed_percent(),
        MotionCommand::RestoreFeedPercent => main_loop.override_feed(modal.kept_feed_percent).await?,
        MotionCommand::Babystep { by, is_kept } => {
            return Moves { main_loop, modal, clamps, notices, cold }.babystep(by, is_kept).await;
        }
        MotionCommand::ZOffset(words) => {
            return Moves { main_loop, modal, clamps, notices, cold }.z_offset(words).await;
        }
        MotionCommand::NoOffset(command, word) => return Ok(Answer::NotObeyed(command, word)),
        MotionCommand::Tool => {}
    }
    Ok(Answer::Nothing)
}

/// M220.
fn say_feed(to: &mut Speaker<'_>, facts: &Facts<'_>) {
    to.say(text!("FR:{}%", facts.number));
}

/// G92.
fn set_position<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    clamps: &mut Clamps,
    words: &AxisWords,
) {
    for (axis, word) in [("X", words.x), ("Y", words.y), ("Z", words.z)] {
        if let Some(number) = word {
            clamps.length_of::<Mm>(modal, ["G92", axis], number, FARTHEST, None);
        }
    }
    if !clamps.refuses_line() {
        main_loop.commanded.rename(words, modal);
    }
}
