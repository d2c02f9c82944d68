//! Pauses: M25, M125, M0, M1, M600, M601, lines that are held because they cannot be carried out for now, and the end
//! of a pause.
//!
//! ```text
//!   to the pause:  save the program ▶ filament back (hot) ▶ lift (z homed) ▶ parking place (all homed)
//!                  ▶ filament out (M600 U)
//!   and back:      heat, and wait ▶ filament in (M600 L) ▶ restore the program ▶ over its place ▶ down
//!                  ▶ filament forth ▶ action:resumed
//! ```
//!
//! The nozzle does not rest on the part. A host that has retracted, lifted and parked by itself leaves nothing to do,
//! and its own script finds the firmware's pause done. The distance from the part is known from the end of the last
//! printing move. The pause's own retraction and lift count for a later script (`Commanded::leave_park`). The tool may
//! jog or home during the pause: it returns to the place where the print stopped. Which state follows which is in
//! [`job`](crate::machine::state::job).

use super::park_words::ParkWords;
use super::parking::{change, go_back, park};
use crate::connectors::Heater;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::heat::heating::heat_again;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::held_line::{Answered, HoldReason};
use crate::machine::state::job::{Break, any_of};
use crate::machine::state::modal::Modal;
use crate::machine::state::program::{Dynamics, Program};
use crate::machine::states::States;
use crate::port::Wake;
use crate::protocol::Action;
use crate::text::{Packed, Text};
use crate::units::{Celsius, Instant, Mm, MmPerSec};
use core::pin::pin;

/// Speeds of filament that is changed: Marlin's `FILAMENT_CHANGE_UNLOAD_FEEDRATE` and
/// `FILAMENT_CHANGE_FAST_LOAD_FEEDRATE` (Configuration_adv.h 2.1).
pub(in crate::machine) const UNLOAD_SPEED: MmPerSec = MmPerSec::const_from_int(10);
pub(in crate::machine) const LOAD_SPEED: MmPerSec = MmPerSec::const_from_int(6);

/// Prompt to the user.
const PAUSED: &str = "Paused";
const FILAMENT: &str = "Change the filament";
const COLD: &str = "Hotend is too cold to print";
const FAILED: &str = "Mend what failed to go on";
const LOST: &str = "Home the axes to go on";

/// Said when a line or M24 finds axes that have lost their place.
const HELD_UNTIL_HOMED: Packed = packed!("echo:print held: axes are no longer homed. Home them (G28), then send M24");

/// The result of continuing a print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Going {
    /// It continues.
    On,
    /// The axes are not homed, or the hotend is too cold for the line that is held.
    Not(HoldReason),
}

/// Says actions to all hosts.
pub(in crate::machine) fn announce<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    actions: &[Action<'static>],
) {
    for action in actions {
        tell_all(main_loop, text!("{action}"));
    }
}

/// Says a line to all hosts. One that is not being served and has no room for it misses it.
fn tell_all<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, line: Text<'_>) {
    main_loop.hosts.notify_others(format_args!("{line}"));
    main_loop.say(line);
}

/// Asks the user to continue.
fn ask<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, first: Action<'static>, question: &'static str) {
    let question = Action::PromptBegin(question);
    announce(main_loop, &[first, question, Action::PromptButton("Continue"), Action::PromptShow]);
}

/// M25, M125. The hosts are told first, so that they stop sending while the motion ends.
pub(in crate::machine) async fn pause<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    parks: bool,
    words: &ParkWords,
) -> Result<Answer<'static>, Interrupt> {
    announce(main_loop, &[Action::PausedAtOnce]);
    if main_loop.job.is_paused() {
        main_loop.finish().await?;
        return Ok(Answer::Nothing);
    }
    apart(pin!(save_and_park(main_loop, states, parks, words))).await?;
    Ok(tell_of_other(main_loop, "M125", words))
}

/// M0, M1, M600, M601: the line is held until M108, M24, M602 or an answer comes, or for `ms`; 0 is for ever.
pub(in crate::machine) async fn await_user<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    (ms, filament): (u32, bool),
    words: &ParkWords,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.job.line().reason().is_some() {
        return Ok(Answer::Line(packed!("echo:ignored, the print is paused already: send M24 or M108 first")));
    }
    main_loop.finish().await?;
    ask(main_loop, Action::Paused, if filament { FILAMENT } else { PAUSED });
    if !main_loop.job.is_paused() {
        apart(pin!(save_and_park(main_loop, states, false, words))).await?;
    }
    tell_of_other(main_loop, "M600", words);
    let until: Option<Instant> = (ms > 0).then(|| main_loop.now().after_ms(ms));
    main_loop.job.line_mut().hold(HoldReason::User(until), &main_loop.pauses);
    Ok(Answer::Held)
}

/// Says that a word is not supported, as the answer: letters of M125 and M600 in Marlin 2.1 and Prusa's firmware (AUTO,
/// colour, name).
fn tell_of_other<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    code: &'static str,
    words: &ParkWords,
) -> Answer<'static> {
    let Some(other) = words.other.filter(|other| b"EUACDN".contains(other)) else { return Answer::Nothing };
    main_loop.say(text!("echo:{code} {} is not supported by this firmware", other as char));
    Answer::Said
}

/// A line that prints cannot be carried out for now: the host is asked to pause, and the line is held. Nothing moves,
/// because the nozzle may have frozen to the part, or its place is unknown.
pub(in crate::machine) async fn hold<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    why: HoldReason,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    if !main_loop.job.is_paused() {
        save(main_loop, modal, Mm::ZERO);
    }
    report_reason(main_loop, why, Action::Pause);
    main_loop.job.line_mut().hold(why, &main_loop.pauses);
    Ok(())
}

/// Reports why a line is held, and how to continue.
fn report_reason<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, why: HoldReason, first: Action<'static>) {
    let (line, question) = match why {
        HoldReason::Lost(axes) if !main_loop.homed.lacks_one_of(axes) => {
            (packed!("echo:print held: its motors were off. M24 goes on with it, M524 ends it"), LOST)
        }
        HoldReason::Lost(_) => (HELD_UNTIL_HOMED, LOST),
        HoldReason::Failed => {
            (packed!("echo:print held: mend what failed, then send M24 to try the line again"), FAILED)
        }
        HoldReason::Cold | HoldReason::User(_) => {
            (packed!("echo:print held: the hotend is too cold. Heat it, then send M24"), COLD)
        }
    };
    tell_all(main_loop, text!("{line}"));
    ask(main_loop, first, question);
}

/// The job is paused, and the state of the program saved; `load` of filament is pushed in before it continues.
fn save<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, modal: &Modal, load: Mm) {
    let program = Program {
        modal: *modal,
        commanded: main_loop.commanded,
        fans: main_loop.heat.commanded_fans(),
        dynamics: Dynamics::of(&main_loop.settings),
    };
    let targets = Heater::ALL.map(|heater| main_loop.heat.target(heater));
    let (host, homed) = (main_loop.hosts.serving(), main_loop.homed.axes());
    main_loop.job.pause(host, Break { program, homed, load }, targets);
    main_loop.stream.begin(program);
    if main_loop.job.printed_at().is_none() {
        // Only this line can tell.
        main_loop.stream.note_number(main_loop.hosts.window().0.is_some());
    }
    main_loop.heat.note_used(main_loop.now());
}

/// The same, and the tool leaves the part if it printed, or if `parks` or a word of the line says so.
async fn save_and_park<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    parks: bool,
    words: &ParkWords,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    let was_printing = main_loop.job.is_printing();
    let [load, other] =
        [words.load, words.unload].map(|number| number.map_or(Mm::ZERO, |number| states.modal.length(number)));
    save(main_loop, &states.modal, load.max(Mm::ZERO));
    if let Some(target) = words.target {
        let most = main_loop.settings.thermal.heater(Heater::Hotend).most;
        let target = Celsius::saturating_from_num(target.value()).clamp(Celsius::ZERO, most);
        let least = main_loop.settings.thermal.min_extrude;
        main_loop.job.note_target(Heater::Hotend, target, least);
    }
    let says = [words.x, words.y, words.z, words.e].iter().any(Option::is_some);
    if was_printing || parks || says {
        apart(pin!(park(main_loop, states, words))).await?;
    }
    let unload = other.saturating_abs().max(load.saturating_neg());
    change(main_loop, states, unload.saturating_neg(), UNLOAD_SPEED).await
}

/// Heaters get their targets back, and are waited for; the program is as it was, the tool goes back, and the print
/// continues.
async fn go_on<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    held: Option<HoldReason>,
) -> Result<Going, Interrupt> {
    let Some(&mut Break { program, homed, .. }) = main_loop.job.paused_mut() else { return Ok(Going::On) };
    let wanted = match held {
        Some(HoldReason::Lost(axes)) => axes,
        Some(HoldReason::User(_) | HoldReason::Cold | HoldReason::Failed) | None => [false; 3],
    };
    let needed = main_loop.job.to_home(any_of(homed, wanted), true);
    if main_loop.homed.lacks_one_of(needed) {
        return Ok(Going::Not(HoldReason::Lost(needed)));
    }
    apart(pin!(heat_again(main_loop))).await?;
    if held == Some(HoldReason::Cold) && states.is_too_cold(main_loop) {
        return Ok(Going::Not(HoldReason::Cold));
    }
    main_loop.finish().await?;
    // Pushed in once.
    let load = main_loop.job.paused_mut().map(|paused| core::mem::replace(&mut paused.load, Mm::ZERO));
    change(main_loop, states, load.unwrap_or(Mm::ZERO), LOAD_SPEED).await?;
    let now = main_loop.commanded;
    let from = now.of_machine(now.position());
    main_loop.commanded = program.commanded;
    // Filament moved during the pause, as in a filament change, does not count for the print.
    main_loop.commanded.count_filament_as(&now);
    put_modes(main_loop, &mut states.modal, &program);
    // Where an axis is that was lost then and is homed now, the program has never been. The line finds its place
    // itself.
    if held == Some(HoldReason::Failed) && main_loop.homed.axes() != homed {
        main_loop.commanded.stand_at(from);
    } else {
        go_back(main_loop, states, from).await?;
    }
    blow_again(main_loop, &program).await?;
    main_loop.job.go_on();
    announce(main_loop, &[Action::Resumed]);
    Ok(Going::On)
}

/// Modes and limits are those of the program.
pub(in crate::machine) fn put_modes<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    program: &Program,
) {
    *modal = modal.restored(&program.modal);
    main_loop.live_settings().set_dynamics(&program.dynamics);
}

/// Fans that were switched off during the pause, by a script or by the user, run as in the print. A fan speed set
/// during the pause stays, as does a heater target that is hot enough to print.
async fn blow_again<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    program: &Program,
) -> Result<(), Interrupt> {
    for ((fan, before), now) in (0..).zip(program.fans).zip(main_loop.heat.commanded_fans()) {
        if now == 0 && before > 0 {
            main_loop.set_fan(fan, before).await?;
        }
    }
    Ok(())
}

/// M24, M602. If it has ended the wait of a held line, that wait reports it.
pub(in crate::machine) async fn resume<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.job.line().reason().is_some() {
        return Ok(Answer::Nothing);
    }
    Ok(match go_on(main_loop, states, None).await? {
        Going::On => Answer::Nothing,
        Going::Not(_) => Answer::Line(HELD_UNTIL_HOMED),
    })
}

/// The stream goes on without M24, from where it has come in the pause.
pub(in crate::machine) async fn resume_stream<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
) -> Result<Going, Interrupt> {
    if let (Some(paused), Some(program)) = (main_loop.job.paused_mut(), main_loop.stream.program()) {
        paused.program = *program;
    }
    // Without numbers, it may be another file.
    let lost = main_loop.job.to_home([false; 3], false);
    if lost != [false; 3] && main_loop.stream.may_hold(false) {
        return Ok(Going::Not(HoldReason::Lost(lost)));
    }
    go_on(main_loop, states, None).await
}

/// A line that is held was answered by the user, by its time or by the end of its print. True if it is to be carried
/// out now; false if it needs its `ok`; `None` if it stays held.
pub(in crate::machine) async fn end_holding<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    held: HoldReason,
    answered: Answered,
) -> Result<Option<bool>, Interrupt> {
    if !main_loop.job.is_paused() {
        announce(main_loop, &[Action::PromptEnd]);
        return Ok(Some(false));
    }
    // The end of the line's wait does not end the wait for heat.
    main_loop.pauses.end_command();
    let is_for_user = matches!(held, HoldReason::User(_));
    if is_for_user {
        announce(main_loop, &[Action::PromptEnd]);
    }
    match go_on(main_loop, states, Some(held)).await? {
        Going::On if is_for_user => Ok(Some(false)),
        Going::On => {
            announce(main_loop, &[Action::PromptEnd]);
            Ok(Some(true))
        }
        Going::Not(why) if is_for_user || answered == Answered::Resume => {
            report_reason(main_loop, why, Action::Paused);
            // Its time is over.
            main_loop.job.line_mut().hold_on(if is_for_user { HoldReason::User(None) } else { held });
            Ok(None)
        }
        Going::Not(_) => {
            announce(main_loop, &[Action::PromptEnd]);
            main_loop.say(text!("echo:line left out, the print is still paused: see above, then send M24"));
            Ok(Some(false))
        }
    }
}
