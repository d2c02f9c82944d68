//! The end of a job by the firmware or by M524: the one place for every end of a print that leaves the machine usable.

use super::pause::{announce, hold};
use crate::connectors::Heater;
use crate::gcode::{Command, Nature};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::tell_of_z_offset;
use crate::machine::ports::PortSet;
use crate::machine::probe::touch::end_touch;
use crate::machine::state::held_line::HoldReason;
use crate::machine::state::job::JobEnd;
use crate::machine::state::modal::Modal;
use crate::port::Wake;
use crate::protocol::Action;
use crate::settings::OnFailure;
use crate::text::Packed;
use crate::units::Celsius;

/// M108.
const CONTINUE: u16 = 108;

/// Sent once to the host of a print that the firmware ended.
const ENDED: Answer<'static> =
    Answer::Line(packed!("echo:the print was ended: moves and heating are ignored until G28, M108 or M110"));

/// The same if a condition has ended it.
const ENDED_BY_CONDITION: Answer<'static> =
    Answer::Line(packed!("echo:the print was ended: its lines are ignored until M108 or M110"));

/// Said when homing or probing fails in a pause: the print can wait for its cure.
const STAYS_PAUSED: Packed = packed!("The print stays paused: home again (G28), then continue it");

/// Hosts are asked to cancel, heaters go off, planned moves are made, and the machine is as before a print. A pause
/// during which homing or probing fails stays a pause. A refused line ends a print alone: without one, nothing changes.
/// But a line with a number is one of a file: hosts number these, and no line of a button.
pub(in crate::machine) async fn end_job<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    why: JobEnd,
) -> Result<Answer<'static>, Interrupt> {
    let can_be_mended = matches!(why, JobEnd::NotHomed { .. } | JobEnd::ProbeFailed { .. } | JobEnd::NotLevel(_));
    if can_be_mended && main_loop.job.is_paused() {
        main_loop.hosts.notify_all(text!("echo:{why}. {STAYS_PAUSED}"));
        return Ok(Answer::Nothing);
    }
    if why.is_refusal() && !main_loop.job.is_under_way() && main_loop.hosts.window().0.is_none() {
        main_loop.hosts.notify_all(text!("echo:{why}"));
        return Ok(Answer::Nothing);
    }
    let settings = main_loop.settings.job;
    if can_be_mended && settings.on_failure == OnFailure::Pause && main_loop.job.is_printing() {
        main_loop.hosts.notify_all(text!("echo:{why}"));
        hold(main_loop, modal, HoldReason::Failed).await?;
        return Ok(Answer::Held);
    }
    main_loop.pauses.end_command();
    end_touch(main_loop).await?;
    // A job that has ended may have kept its heat.
    let has_heat = Heater::ALL.into_iter().any(|heater| main_loop.heat.target(heater) > Celsius::ZERO);
    let keeps_heat = can_be_mended && settings.keeps_heat;
    if !keeps_heat {
        main_loop.heat.switch_off(&main_loop.settings.thermal);
    }
    let is_wanted = matches!(why, JobEnd::Cancelled);
    // A command that was cancelled may belong to the start of a print, which is not known from its lines.
    let is_command = main_loop.hosts.owes_ok() && !main_loop.job.is_ended();
    let is_print = !is_wanted || main_loop.job.is_under_way() || is_command;
    if is_wanted && (has_heat || !main_loop.job.is_ended()) {
        let what = if is_print { "print " } else { "" };
        main_loop.hosts.notify_all(text!("echo:{what}cancelled, heaters are off"));
    }
    if is_print {
        main_loop.job.end_early(why);
        if !is_wanted {
            let heat = if keeps_heat { "stay on" } else { "are off" };
            main_loop.hosts.notify_all(text!("echo:print ended, heaters {heat}: {why}"));
        }
        announce(main_loop, &[Action::Cancel]);
    }
    main_loop.finish().await?;
    clean_up(main_loop, modal).await?;
    tell_of_z_offset(main_loop);
    Ok(Answer::Nothing)
}

/// Clears every state of a print that would change the next one: retraction, pause, modes, offsets, overrides.
pub(in crate::machine) async fn clean_up<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
) -> Result<(), Interrupt> {
    main_loop.commanded.settle();
    main_loop.commanded.forget_origins(main_loop.settings.home_offsets());
    *modal = Modal { dry_run: modal.dry_run, ..Modal::new() };
    if main_loop.motion.feed_percent() != modal.kept_feed_percent {
        main_loop.override_feed(modal.kept_feed_percent).await?;
    }
    Ok(())
}

/// The print ends by its own line or by its host's: M84, M77. Paused, it was cancelled, and is cleaned up after.
pub(in crate::machine) async fn end_by_line<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
) -> Result<(), Interrupt> {
    let was_paused = main_loop.job.is_paused();
    main_loop.job.end();
    if was_paused {
        main_loop.finish().await?;
        clean_up(main_loop, modal).await?;
    }
    tell_of_z_offset(main_loop);
    Ok(())
}

/// M110: another print begins, if it is of the host that has printed. The state left over from the print before is
/// cleaned up.
pub(in crate::machine) async fn begin_another<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
) -> Result<(), Interrupt> {
    if main_loop.job.is_under_way() && main_loop.job.is_of(main_loop.hosts.serving()) {
        clean_up(main_loop, modal).await?;
        main_loop.job.end();
    }
    main_loop.job.forgive();
    if !main_loop.job.is_under_way() {
        main_loop.commanded.settle();
    }
    Ok(())
}

/// The reply to a line of a print that was ended; `None` if the line is carried out all the same.
pub(in crate::machine) fn refuse<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    command: &Command<'_>,
) -> Option<Answer<'static>> {
    if !main_loop.job.is_ended() {
        return None;
    }
    // Which lines would run, the condition has decided: none does.
    let is_by_condition = matches!(main_loop.job.why_it_ends(), JobEnd::Conditional);
    let is_of_print = match *command {
        Command::Move(_) => true,
        Command::Table(ref command) => {
            if command.is('M', CONTINUE) {
                main_loop.job.forgive();
            }
            match command.nature() {
                Nature::Report => false,
                Nature::Work | Nature::Move => true,
                Nature::Aside | Nature::Mode => is_by_condition,
            }
        }
        Command::Silent => false,
        Command::Condition | Command::Malformed(_) | Command::Unknown(_) => is_by_condition,
    };
    if !is_of_print {
        return None;
    }
    Some(match main_loop.job.tell_of_end() {
        true if is_by_condition => ENDED_BY_CONDITION,
        true => ENDED,
        false => Answer::Nothing,
    })
}

/// Whether an unknown command name starts a print in other firmware (`START_PRINT`) or ends one (false).
pub(in crate::machine) fn starts_print(text: &[u8]) -> Option<bool> {
    let end = text.iter().position(|byte| !(byte.is_ascii_alphanumeric() || *byte == b'_')).unwrap_or(text.len());
    let name = text.get(..end).unwrap_or_default();
    let has = |part: &[u8]| name.windows(part.len()).any(|window| window.eq_ignore_ascii_case(part));
    if has(b"start") {
        Some(true)
    } else if has(b"print") && has(b"end") {
        Some(false)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_begin_and_end_prints() {
        for name in ["START_PRINT BED=60", "print_start", "_START_PRINT_BASE", "PRINT_START EXTRUDER=210 BED=60"] {
            assert_eq!(starts_print(name.as_bytes()), Some(true), "{name}");
        }
        for name in ["END_PRINT", "print_end", "PRINT_END ; start"] {
            assert_eq!(starts_print(name.as_bytes()), Some(false), "{name}");
        }
        for name in ["M1234", "BED_MESH_PROFILE LOAD=start", "", "%", "ENDSTOPS"] {
            assert_eq!(starts_print(name.as_bytes()), None, "{name}");
        }
    }
}
