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
use crate::machine::state::modal::{FARTHEST, PERCENT};
use crate::port::Wake;
use crate::units::Mm;
use core::pin::pin;

/// Carries out a command of motion.
pub(super) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &MotionCommand,
) -> Result<Answer<'static>, Interrupt> {
    match *command {
        MotionCommand::Line { rapid: _, ref to, feed } => {
            return Moves { main_loop, states }.line(to, feed).await;
        }
        MotionCommand::Circulate { ref to, belt, feed } => {
            return apart(pin!(Moves { main_loop, states }.circulate(to, belt, feed))).await;
        }
        MotionCommand::Arc(ref words) => {
            return apart(pin!(Moves { main_loop, states }.arc(words))).await;
        }
        MotionCommand::Dwell { ms } => dwell(main_loop, ms).await?,
        MotionCommand::Retract | MotionCommand::Recover => {
            return Moves { main_loop, states }.retract(*command == MotionCommand::Recover).await;
        }
        MotionCommand::Home(words) => {
            // In the units of the line (G20), which `home` does not know.
            let raise = words.raise.map(|raise| states.modal.length(raise));
            apart(pin!(home(main_loop, &mut states.notices, words, raise))).await?;
            if words.drops_mesh && main_loop.settings.mesh.is_on {
                use_mesh(main_loop, false).await?;
                return Ok(Answer::Mesh(MeshAnswer::State));
            }
        }
        // The receive path has acted on it.
        MotionCommand::QuickStop => {}
        MotionCommand::Absolute => states.modal.absolute = true,
        MotionCommand::Relative => states.modal.absolute = false,
        MotionCommand::AbsoluteExtrusion => states.modal.absolute_extrusion = true,
        MotionCommand::RelativeExtrusion => states.modal.absolute_extrusion = false,
        MotionCommand::SetPosition(ref words) => set_position(main_loop, states, words),
        MotionCommand::FeedPercent(None) => {
            return Ok(Answer::says(say_feed, i32::from(main_loop.motion.feed_percent())));
        }
        MotionCommand::FeedPercent(Some(number)) => {
            if let Some(percent) = states.clamps.whole_of(["M220", "S"], number, PERCENT, None) {
                main_loop.override_feed(percent).await?;
            }
        }
        MotionCommand::BackUpFeedPercent => states.modal.kept_feed_percent = main_loop.motion.feed_percent(),
        MotionCommand::RestoreFeedPercent => main_loop.override_feed(states.modal.kept_feed_percent).await?,
        MotionCommand::Babystep { .. } | MotionCommand::ZOffset(_) => {
            return Moves { main_loop, states }.offset_z(command).await;
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
fn set_position<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
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
