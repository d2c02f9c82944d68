//! Pauses: M25, M125, M0, M1, M600, M601, lines that are kept because they cannot be carried out for now, and the end
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

use super::cold_extrusion::ColdExtrusion;
use super::heating::heat_again;
use crate::connectors::Heater;
use crate::gcode::ParkWords;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::z_offset::z_reach;
use crate::machine::ports::PortSet;
use crate::machine::state::job::{Break, any_of};
use crate::machine::state::kept_line::{Answered, Kept};
use crate::machine::state::modal::Modal;
use crate::machine::state::program::{Dynamics, Program};
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::protocol::Action;
use crate::settings::HomedAxis;
use crate::text::Packed;
use crate::units::{Celsius, Instant, Mm, MmPerSec};
use core::pin::pin;

/// At this distance above the end of the last printing move the tool is off the part: a slicer's z-hop is less (0.2 to
/// 0.8 mm).
const OFF_PART: Mm = Mm::const_from_int(1);

/// Speeds of filament that is changed: Marlin's `FILAMENT_CHANGE_UNLOAD_FEEDRATE` and
/// `FILAMENT_CHANGE_FAST_LOAD_FEEDRATE` (Configuration_adv.h 2.1).
const UNLOAD_SPEED: MmPerSec = MmPerSec::const_from_int(10);
const LOAD_SPEED: MmPerSec = MmPerSec::const_from_int(6);

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
    /// The axes are not homed, or the hotend is too cold for the line that is kept.
    Not(Kept),
}

/// Says the same to all hosts. One that is not being served and has no room for it misses it.
pub(in crate::machine) async fn announce<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    actions: &[Action<'static>],
) -> Result<(), Interrupt> {
    for &action in actions {
        main_loop.hosts.notify_others(format_args!("{action}"));
        main_loop.reply(Answer::Action(action)).await?;
    }
    Ok(())
}

/// Asks the user to continue.
async fn ask<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    first: Action<'static>,
    question: &'static str,
) -> Result<(), Interrupt> {
    let question = Action::PromptBegin(question);
    announce(main_loop, &[first, question, Action::PromptButton("Continue"), Action::PromptShow]).await
}

/// M25, M125. The hosts are told first, so that they stop sending while the motion ends.
pub(in crate::machine) async fn pause<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    cold: &ColdExtrusion,
    parks: bool,
    words: &ParkWords,
) -> Result<Answer<'static>, Interrupt> {
    announce(main_loop, &[Action::PausedAtOnce]).await?;
    if main_loop.job.is_paused() {
        main_loop.finish().await?;
        return Ok(Answer::Nothing);
    }
    apart(pin!(save_and_park(main_loop, modal, cold, parks, words))).await?;
    Ok(not_obeyed("M125", words))
}

/// M0, M1, M600, M601: the line is kept until M108, M24, M602 or an answer comes, or for `ms`; 0 is for ever.
pub(in crate::machine) async fn await_user<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    cold: &ColdExtrusion,
    (ms, filament): (u32, bool),
    words: &ParkWords,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.job.line().kept().is_some() {
        return Ok(Answer::Line(packed!("echo:ignored, the print is paused already: send M24 or M108 first")));
    }
    main_loop.finish().await?;
    ask(main_loop, Action::Paused, if filament { FILAMENT } else { PAUSED }).await?;
    if !main_loop.job.is_paused() {
        apart(pin!(save_and_park(main_loop, modal, cold, false, words))).await?;
    }
    if let told @ Answer::NotObeyed(..) = not_obeyed("M600", words) {
        main_loop.reply(told).await?;
    }
    let until: Option<Instant> = (ms > 0).then(|| main_loop.now().after_ms(ms));
    main_loop.job.line_mut().keep(Kept::User(until), &main_loop.pauses);
    Ok(Answer::Kept)
}

/// The answer to a word that is not supported: letters of M125 and M600 in Marlin 2.1 and Prusa's firmware (AUTO,
/// colour, name).
const fn not_obeyed(code: &'static str, words: &ParkWords) -> Answer<'static> {
    match words.other {
        Some(b'E') => Answer::NotObeyed(code, b"E"),
        Some(b'U') => Answer::NotObeyed(code, b"U"),
        Some(b'A') => Answer::NotObeyed(code, b"A"),
        Some(b'C') => Answer::NotObeyed(code, b"C"),
        Some(b'D') => Answer::NotObeyed(code, b"D"),
        Some(b'N') => Answer::NotObeyed(code, b"N"),
        Some(_) | None => Answer::Nothing,
    }
}

/// A line that prints cannot be carried out for now: the host is asked to pause, and the line is kept. Nothing moves,
/// because the nozzle may have frozen to the part, or its place is unknown.
pub(in crate::machine) async fn hold<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    why: Kept,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.finish().await?;
    if !main_loop.job.is_paused() {
        save(main_loop, modal, Mm::ZERO);
    }
    report_reason(main_loop, why, Action::Pause).await?;
    main_loop.job.line_mut().keep(why, &main_loop.pauses);
    Ok(Answer::Kept)
}

/// Reports why a line is kept, and how to continue.
async fn report_reason<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    why: Kept,
    first: Action<'static>,
) -> Result<(), Interrupt> {
    let (line, question) = match why {
        Kept::Lost(axes) if !main_loop.homed.lacks_one_of(axes) => {
            (packed!("echo:print held: its motors were off. M24 goes on with it, M524 ends it"), LOST)
        }
        Kept::Lost(_) => (HELD_UNTIL_HOMED, LOST),
        Kept::Failed => (packed!("echo:print held: mend what failed, then send M24 to try the line again"), FAILED),
        Kept::Cold | Kept::User(_) => {
            (packed!("echo:print held: the hotend is too cold. Heat it, then send M24"), COLD)
        }
    };
    main_loop.hosts.notify_others(format_args!("{line}"));
    main_loop.reply(Answer::Line(line)).await?;
    ask(main_loop, first, question).await
}

/// The job is paused, and the state of the program saved; `load` of filament is pushed in before it continues.
fn save<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, modal: &Modal, load: Mm) {
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
async fn save_and_park<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    cold: &ColdExtrusion,
    parks: bool,
    words: &ParkWords,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    let was_printing = main_loop.job.is_printing();
    let [load, other] = [words.load, words.unload].map(|number| number.map_or(Mm::ZERO, |number| modal.length(number)));
    save(main_loop, modal, load.max(Mm::ZERO));
    if let Some(target) = words.target {
        let most = main_loop.settings.thermal.heater(Heater::Hotend).most;
        let target = Celsius::saturating_from_num(target.value()).clamp(Celsius::ZERO, most);
        let least = main_loop.settings.thermal.min_extrude;
        main_loop.job.note_target(Heater::Hotend, target, least);
    }
    let says = [words.x, words.y, words.z, words.e].iter().any(Option::is_some);
    if was_printing || parks || says {
        apart(pin!(park(main_loop, modal, cold, words))).await?;
    }
    let unload = other.saturating_abs().max(load.saturating_neg());
    change(main_loop, modal, cold, unload.saturating_neg(), UNLOAD_SPEED).await
}

/// Filament comes out or goes in, as by a line in the pause. The length is limited to one line's maximum; with a cold
/// hotend it is zero.
async fn change<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    cold: &ColdExtrusion,
    length: Mm,
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    if length == Mm::ZERO || modal.dry_run {
        return Ok(());
    }
    if cold.is_too_cold(main_loop) {
        return main_loop.reply(Answer::Line(packed!("echo:filament is not moved: the hotend is too cold"))).await;
    }
    let most = main_loop.settings.axes.e.length;
    let mut to = main_loop.commanded.position();
    let [.., e] = &mut to;
    *e = e.wrapping_add(length.clamp(most.saturating_neg(), most));
    travel(main_loop, main_loop.commanded.of_machine(to), speed).await?;
    main_loop.commanded.go_to(to);
    main_loop.finish().await
}

/// One straight move in machine coordinates, independent of the program's state.
pub(super) async fn travel<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    position: [Mm; 4],
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    main_loop.plan(Target { position, speed: speed.into(), has_overrides: false, watch: EndstopSet::NONE }).await
}

/// Filament back, up, and away.
async fn park<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    cold: &ColdExtrusion,
    words: &ParkWords,
) -> Result<(), Interrupt> {
    let (s, axes, soft) = (main_loop.settings.pause, main_loop.settings.axes, main_loop.settings.soft_endstops);
    let commanded = main_loop.commanded;
    let [.., z_now, e_now] = commanded.position();
    let [lifted, pulled] = commanded.retracted();
    // The lift and retraction by the program itself since it last printed.
    let (lifted, pulled) = match main_loop.job.printed_at() {
        Some([.., z, e]) => {
            let back = e.wrapping_sub(e_now).max(Mm::ZERO);
            (lifted.saturating_add(z_now.saturating_sub(z)), pulled.saturating_add(back))
        }
        None => (lifted, pulled),
    };
    let is_off_part = lifted >= OFF_PART;
    let length = |number| modal.length(number);
    let mut machine = commanded.of_machine(commanded.position());
    let back = words.e.map_or(s.retract, |number| length(number).saturating_abs()).saturating_sub(pulled);
    if back > Mm::ZERO && !modal.dry_run && !cold.is_too_cold(main_loop) {
        let [.., e] = &mut machine;
        *e = e.wrapping_sub(back);
        travel(main_loop, machine, s.retract_speed).await?;
        main_loop.commanded.park_at(machine);
    }
    let [x_homed, y_homed, z_homed] = main_loop.homed.axes();
    let lift = match words.z {
        Some(number) => length(number).max(Mm::ZERO),
        None if is_off_part => Mm::ZERO,
        None => s.lift,
    };
    if lift > Mm::ZERO && z_homed {
        let [_, _, z, _] = &mut machine;
        let top = if soft { z_reach(main_loop).most.max(*z) } else { Mm::MAX };
        *z = z.saturating_add(lift).min(top);
        travel(main_loop, machine, axes.z.max_speed).await?;
        main_loop.commanded.park_at(machine);
    }
    let is_named = words.x.is_some() || words.y.is_some();
    if (is_named || s.park && !is_off_part) && x_homed && y_homed && z_homed {
        let [x, y, ..] = &mut machine;
        let [x_reach, y_reach] = [HomedAxis::X, HomedAxis::Y].map(|axis| main_loop.settings.reach(axis));
        for (at, word, place, reach) in [(x, words.x, s.x, x_reach), (y, words.y, s.y, y_reach)] {
            if word.is_some() || s.park {
                *at = reach.clamp(word.map_or(place, length));
            }
        }
        travel(main_loop, machine, s.travel_speed).await?;
        main_loop.commanded.park_at(machine);
    }
    main_loop.finish().await
}

/// The tool moves from its present place to the commanded position: first above it, then down. Then the filament goes
/// forward that the pause has pulled back. In a cold hotend it stays back, until a kept line that prints continues.
async fn go_back<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    cold: &ColdExtrusion,
    from: [Mm; 4],
) -> Result<(), Interrupt> {
    let (s, axes) = (main_loop.settings.pause, main_loop.settings.axes);
    let commanded = main_loop.commanded;
    let ([x, y, z, e], [from_x, from_y, from_z, from_e]) = (commanded.of_print(commanded.position()), from);
    // Move above any part on the bed if a user has lowered the tool.
    let is_beside = (x, y) != (from_x, from_y);
    let top = z_reach(main_loop).most.max(z);
    let over = if is_beside && from_z < z { z.saturating_add(s.lift).min(top) } else { from_z };
    travel(main_loop, [from_x, from_y, over, from_e], axes.z.max_speed).await?;
    travel(main_loop, [x, y, over, from_e], s.travel_speed).await?;
    travel(main_loop, [x, y, z, from_e], axes.z.max_speed).await?;
    if e != from_e && cold.is_too_cold(main_loop) {
        main_loop.commanded.unpark(from_e.wrapping_sub(e));
    } else {
        travel(main_loop, [x, y, z, e], s.unretract_speed).await?;
        main_loop.commanded.unpark(Mm::ZERO);
    }
    main_loop.finish().await
}

/// Heaters get their targets back, and are waited for; the program is as it was, the tool goes back, and the print
/// continues.
async fn go_on<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    cold: &ColdExtrusion,
    kept: Option<Kept>,
) -> Result<Going, Interrupt> {
    let Some(&mut Break { program, homed, .. }) = main_loop.job.paused_mut() else { return Ok(Going::On) };
    let wanted = match kept {
        Some(Kept::Lost(axes)) => axes,
        Some(Kept::User(_) | Kept::Cold | Kept::Failed) | None => [false; 3],
    };
    let needed = main_loop.job.to_home(any_of(homed, wanted), true);
    if main_loop.homed.lacks_one_of(needed) {
        return Ok(Going::Not(Kept::Lost(needed)));
    }
    apart(pin!(heat_again(main_loop))).await?;
    if kept == Some(Kept::Cold) && cold.is_too_cold(main_loop) {
        return Ok(Going::Not(Kept::Cold));
    }
    main_loop.finish().await?;
    // Pushed in once.
    let load = main_loop.job.paused_mut().map(|paused| core::mem::replace(&mut paused.load, Mm::ZERO));
    change(main_loop, modal, cold, load.unwrap_or(Mm::ZERO), LOAD_SPEED).await?;
    let now = main_loop.commanded;
    let from = now.of_machine(now.position());
    main_loop.commanded = program.commanded;
    // Filament moved during the pause, as in a filament change, does not count for the print.
    main_loop.commanded.count_filament_as(&now);
    put_modes(main_loop, modal, &program);
    // Where an axis is that was lost then and is homed now, the program has never been. The line finds its place
    // itself.
    if kept == Some(Kept::Failed) && main_loop.homed.axes() != homed {
        main_loop.commanded.stand_at(from);
    } else {
        go_back(main_loop, cold, from).await?;
    }
    blow_again(main_loop, &program).await?;
    main_loop.job.go_on();
    announce(main_loop, &[Action::Resumed]).await?;
    Ok(Going::On)
}

/// Modes and limits are those of the program.
pub(super) fn put_modes<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, modal: &mut Modal, program: &Program) {
    *modal = modal.restored(&program.modal);
    main_loop.live_settings().set_dynamics(&program.dynamics);
}

/// Fans that were switched off during the pause, by a script or by the user, run as in the print. A fan speed set
/// during the pause stays, as does a heater target that is hot enough to print.
async fn blow_again<P: PortSet, W: Pend>(
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

/// M24, M602. If it has ended the wait of a kept line, that wait reports it.
pub(in crate::machine) async fn resume<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    cold: &ColdExtrusion,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.job.line().kept().is_some() {
        return Ok(Answer::Nothing);
    }
    Ok(match go_on(main_loop, modal, cold, None).await? {
        Going::On => Answer::Nothing,
        Going::Not(_) => Answer::Line(HELD_UNTIL_HOMED),
    })
}

/// The stream goes on without M24, from where it has come in the pause.
pub(in crate::machine) async fn resume_stream<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    cold: &ColdExtrusion,
) -> Result<Going, Interrupt> {
    if let (Some(paused), Some(program)) = (main_loop.job.paused_mut(), main_loop.stream.program()) {
        paused.program = *program;
    }
    // Without numbers, it may be another file.
    let lost = main_loop.job.to_home([false; 3], false);
    if lost != [false; 3] && main_loop.stream.may_hold(false) {
        return Ok(Going::Not(Kept::Lost(lost)));
    }
    go_on(main_loop, modal, cold, None).await
}

/// A line that is kept was answered by the user, by its time or by the end of its print. True if it is to be carried
/// out now; false if it needs its `ok`; `None` if it stays kept.
pub(in crate::machine) async fn end_keeping<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    cold: &ColdExtrusion,
    kept: Kept,
    answered: Answered,
) -> Result<Option<bool>, Interrupt> {
    if !main_loop.job.is_paused() {
        announce(main_loop, &[Action::PromptEnd]).await?;
        return Ok(Some(false));
    }
    // The end of the line's wait does not end the wait for heat.
    main_loop.pauses.end_command();
    let is_for_user = matches!(kept, Kept::User(_));
    if is_for_user {
        announce(main_loop, &[Action::PromptEnd]).await?;
    }
    match go_on(main_loop, modal, cold, Some(kept)).await? {
        Going::On if is_for_user => Ok(Some(false)),
        Going::On => {
            announce(main_loop, &[Action::PromptEnd]).await?;
            Ok(Some(true))
        }
        Going::Not(why) if is_for_user || answered == Answered::Resume => {
            report_reason(main_loop, why, Action::Paused).await?;
            // Its time is over.
            main_loop.job.line_mut().keep_on(if is_for_user { Kept::User(None) } else { kept });
            Ok(None)
        }
        Going::Not(_) => {
            announce(main_loop, &[Action::PromptEnd]).await?;
            main_loop
                .reply(Answer::Line(packed!("echo:line left out, the print is still paused: see above, then send M24")))
                .await?;
            Ok(Some(false))
        }
    }
}
