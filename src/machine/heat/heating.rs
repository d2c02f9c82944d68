//! Heating: targets (M104, M140, M141), waits for them (M109, M116, M190, M191), and everything off (M81).
//!
//! A target acts at once, ahead of queued moves, and moves continue while a command waits for it. M108 ends a wait and
//! leaves the target; M410 does too. A fault of a heater halts the machine, and so ends any wait.

use super::reached::{Cooling, FAR, NEAR, Residency, Rising, Stuck};
use crate::connectors::{HEATERS, Heater};
use crate::fault::Fault;
use crate::gcode::{Number, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::reports::heat_report::Temperatures;
use crate::machine::state::clamps::{Clamps, Word};
use crate::machine::state::job::JobEnd;
use crate::machine::state::notices::{Notice, Notices};
use crate::machine::state::waiting::Waiting;
use crate::machine::states::{States, tell_clamps};
use crate::port::{Storage, Wake};
use crate::settings::{Range, ThermalSettings};
use crate::text::Packed;
use crate::units::{Celsius, Instant};
use core::pin::pin;

/// A heater without a reading for this time has a broken sensor. A working one is read a tenth of a second after the
/// start, and the reason for a missing reading is known after half of one.
pub(super) const UNREAD_MS: u32 = 1000;

/// Interval of temperature lines in every wait.
pub(in crate::machine) const LINE_MS: u32 = 1000;

/// A line of every wait for heat: temperatures, and the seconds that are missing, if they can be told.
pub(in crate::machine) fn report_wait(to: &mut ReplyWriter<'_>, facts: &Facts<'_>, missing: Option<u32>) {
    let temperatures = Temperatures::of(facts);
    match missing {
        Some(missing) => to.say(text!(" {temperatures} W:{missing}")),
        None => to.say(text!(" {temperatures} W:?")),
    }
}

/// Why no target is set.
enum NoTarget {
    /// There is no such heater, and the answer.
    NoHeater(Answer<'static>),
    /// The heater must not heat.
    Refused(Fault),
}

/// The answer to a command for a heater that is not fitted; `None` if it is.
fn missing<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    heater: Heater,
) -> Option<Answer<'static>> {
    let thermal = &main_loop.settings.thermal;
    if thermal.heater(heater).is_fitted {
        return None;
    }
    let has_any = thermal.has_heater();
    Some(match heater {
        // Slicers write M141 and M191 for machines without a chamber's heater too.
        Heater::Chamber => Answer::Nothing,
        Heater::Hotend | Heater::Bed if has_any => {
            let notice = if heater == Heater::Bed { Notice::NoBed } else { Notice::NoHotend };
            if notices.give(notice) { Answer::Line(not_fitted(heater)) } else { Answer::Nothing }
        }
        Heater::Hotend | Heater::Bed if notices.give(Notice::NoHeaters) => {
            Answer::Line(packed!("echo:no heaters configured"))
        }
        Heater::Hotend | Heater::Bed => Answer::Nothing,
    })
}

/// M104, M140, M141, and the first part of M109, M190, M191: true if there is a target. A target beyond the heater's
/// range is refused: the old target stays.
fn set_target<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    clamps: &mut Clamps,
    word: Word,
    (heater, target): (Heater, Option<Number>),
) -> Result<bool, NoTarget> {
    if let Some(answer) = missing(main_loop, notices, heater) {
        return Err(NoTarget::NoHeater(answer));
    }
    let Some(number) = target else { return Ok(false) };
    let range = Range { least: Celsius::ZERO, most: main_loop.settings.thermal.heater(heater).most };
    let Some(target) = clamps.near_of(word, number, range, Some(main_loop.heat.target(heater))) else {
        return Ok(false);
    };
    if target > Celsius::ZERO {
        if let Some(why) = main_loop.heat.refusal(heater, &main_loop.settings.thermal) {
            return Err(NoTarget::Refused(why));
        }
        let image = main_loop.storage.image();
        main_loop.heat.test_before_heating(&main_loop.settings.thermal, image);
    } else if heater == Heater::Hotend && main_loop.job.is_printing() {
        // Nothing is printed without a hotend: files that do not switch the motors off end in this way.
        main_loop.job.end();
    }
    let least = if heater == Heater::Hotend { main_loop.settings.thermal.min_extrude } else { Celsius::ZERO };
    main_loop.job.note_target(heater, target, least);
    main_loop.heat.set_target(heater, target);
    main_loop.heat.note_used(main_loop.now());
    main_loop.heat.send_orders(&main_loop.settings.thermal);
    Ok(true)
}

/// M104, M109 and those of bed and chamber. To set a target R is as good as S; with both it is S, as in Marlin.
pub(in crate::machine) async fn order_heat<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
    code: &'static str,
    (heater, waits): (Heater, bool),
) -> Result<Answer<'static>, Interrupt> {
    let (heats, both) = (command.number(b'S'), command.number(b'R'));
    let cools = waits.then_some(heats.is_none());
    order_target(main_loop, states, [code, "S"], (heater, heats.or(both)), cools).await
}

/// A heater gets a target. It is waited for if `cools` says whether also while it cools.
pub(in crate::machine) async fn order_target<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, notices, .. }: &mut States,
    word: Word,
    (heater, target): (Heater, Option<Number>),
    cools: Option<bool>,
) -> Result<Answer<'static>, Interrupt> {
    match set_target(main_loop, notices, clamps, word, (heater, target)) {
        Err(NoTarget::NoHeater(answer)) => return Ok(answer),
        Err(NoTarget::Refused(why)) if cools.is_some() => {
            note_no_heat(main_loop, heater, why);
            return Err(Interrupt::EndJob);
        }
        Err(NoTarget::Refused(why)) => {
            tell_clamps(main_loop, clamps);
            let [code, _] = word;
            main_loop.say(text!("echo:{code} ignored: {why}"));
            return Ok(Answer::Said);
        }
        Ok(is_set) => {
            if let Some(cools) = cools.filter(|_| is_set) {
                // Report clamped values before the wait, not minutes later.
                tell_clamps(main_loop, clamps);
                let heaters = Heater::ALL.map(|other| other == heater);
                apart(pin!(await_heat(main_loop, heaters, cools))).await?;
            }
        }
    }
    Ok(Answer::Nothing)
}

/// M116: waits for all that are on.
pub(in crate::machine) async fn await_heaters<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
) -> Result<Answer<'static>, Interrupt> {
    if !main_loop.settings.thermal.has_heater() {
        return Ok(missing(main_loop, notices, Heater::Hotend).unwrap_or(Answer::Nothing));
    }
    let heaters = Heater::ALL.map(|heater| main_loop.heat.target(heater) > Celsius::ZERO);
    apart(pin!(await_heat(main_loop, heaters, true))).await?;
    Ok(Answer::Nothing)
}

/// Waits for the first reading of heaters, for as long as a working sensor may take. A machine that was just switched
/// on has none, and none is a number.
pub(in crate::machine) async fn await_readings<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    heaters: [bool; HEATERS],
) -> Result<(), Interrupt> {
    let end = main_loop.now().after_ms(UNREAD_MS);
    let are_unread = |main_loop: &MainLoop<'_, P, W>| {
        let is_unread = |heater| main_loop.heat.is_unread(heater, &main_loop.settings.thermal);
        Heater::ALL.into_iter().zip(heaters).any(|(heater, counts)| counts && is_unread(heater))
    };
    while are_unread(main_loop) && main_loop.now() < end {
        main_loop.poll().await?;
    }
    Ok(())
}

/// The job ends, because a heater that is waited for must not heat.
pub(super) fn note_no_heat<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, heater: Heater, why: Fault) {
    let is_read = main_loop.heat.measured()[heater as usize].is_some();
    main_loop.job.note_end(if is_read { JobEnd::Refused { why } } else { JobEnd::Unread { heater } });
}

/// Follows heaters that are waited for, by the distances below their targets. One that gets no warmer is told, and
/// later ends the job.
pub(super) fn tell_stuck<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    rising: &mut Rising,
    (below, measured): ([Option<Celsius>; HEATERS], [Option<Celsius>; HEATERS]),
    now: Instant,
) -> Result<(), Interrupt> {
    let status = main_loop.status;
    match rising.follow(below, measured, |heater| status.heat().is_slow(heater), now) {
        Some(Stuck::End(heater)) => {
            if let (Some(at), Some(below)) = (measured[heater as usize], below[heater as usize]) {
                let [at, target] = [at, at.saturating_add(below)].map(Celsius::to_num::<i32>);
                main_loop.job.note_end(JobEnd::Unreachable { heater, at, target });
                return Err(Interrupt::EndJob);
            }
        }
        Some(Stuck::Tell(heater)) => main_loop.say(text!(
            "echo:{} does not get warmer; the print ends if this continues. M108 ends this wait",
            heater.name()
        )),
        None => {}
    }
    Ok(())
}

/// Waits until heaters have reached their targets, or if `cools` is not set, have no need to warm up any more.
pub(in crate::machine) async fn await_heat<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    heaters: [bool; HEATERS],
    cools: bool,
) -> Result<(), Interrupt> {
    // A first reading that cannot be right takes the target away, and ends this wait.
    let targets = Heater::ALL.map(|heater| main_loop.heat.target(heater));
    await_readings(main_loop, heaters).await?;
    let begun = main_loop.now();
    let measured = main_loop.heat.measured();
    // A heater that is off has nothing to warm up to, and at 0 C or less it has cooled.
    let off_by = |place: usize, measured: Celsius| {
        let by = measured.saturating_sub(targets[place]);
        if targets[place] > Celsius::ZERO { by } else { by.max(Celsius::ZERO) }
    };
    let mut awaited = heaters;
    for (place, awaited) in awaited.iter_mut().enumerate() {
        let is_on = targets[place] > Celsius::ZERO;
        // Marlin's S waits only upwards, and R both ways.
        *awaited &= cools || is_on && measured[place].is_none_or(|measured| measured < targets[place]);
    }
    if awaited == [false; HEATERS] {
        return Ok(());
    }
    main_loop.pauses.begin(Waiting::Heat);
    let (mut residency, mut cooling) = (Residency { since: None }, Cooling { looked: (begun, measured) });
    let mut rising = Rising::new(measured, begun);
    let (mut read, mut are_read) = ([begun; HEATERS], measured.map(|measured| measured.is_some()));
    let (mut next_line, mut moves) = (begun, true);
    main_loop.come_again();
    while !main_loop.pauses.is_over() {
        let (now, measured) = (main_loop.now(), main_loop.heat.measured());
        for heater in Heater::ALL {
            let place = heater as usize;
            if !awaited[place] {
                continue;
            }
            // A heater that is off and has no reading cannot tell that it has cooled, so its refusal counts, too.
            let refusal = main_loop.heat.refusal(heater, &main_loop.settings.thermal);
            if let Some(why) = refusal.filter(|_| targets[place] > Celsius::ZERO || measured[place].is_none()) {
                note_no_heat(main_loop, heater, why);
                return Err(Interrupt::EndJob);
            }
            match measured[place] {
                Some(at) => {
                    // A first reading that comes this late decides as one at the begin does.
                    let is_first = !core::mem::replace(&mut are_read[place], true);
                    awaited[place] = !is_first || cools || at < targets[place];
                    read[place] = now;
                }
                // The guards name a reason within half of this time, and then `refusal` has ended the wait with it.
                None if now >= read[place].after_ms(UNREAD_MS) => {
                    main_loop.job.note_end(JobEnd::Unread { heater });
                    return Err(Interrupt::EndJob);
                }
                None => {}
            }
        }
        if awaited == [false; HEATERS] {
            break;
        }
        let off_by = |place: usize| measured[place].filter(|_| awaited[place]).map(|is| off_by(place, is));
        let is_within = |most: Celsius| {
            (0..HEATERS).all(|place| !awaited[place] || off_by(place).is_some_and(|by| by.saturating_abs() <= most))
        };
        let missing = residency.follow(is_within(NEAR), !is_within(FAR), now);
        if now >= next_line {
            // From the last line's time and not from now, so that lines keep their rate.
            next_line = next_line.after_ms(LINE_MS);
            main_loop.reply(Answer::words(&|to, facts| report_wait(to, facts, missing))).await?;
        }
        let are_hot = [0, 1, 2].map(|place| off_by(place).is_some_and(|by| by > NEAR));
        if missing == Some(0) || (cools && cooling.has_ended(are_hot, measured, now)) {
            break;
        }
        let below = [0, 1, 2].map(|place| off_by(place).map(|by| Celsius::ZERO.saturating_sub(by)));
        tell_stuck(main_loop, &mut rising, (below, measured), now)?;
        // The look-ahead would keep the last moves for later ones, and these wait for this line.
        moves = moves && main_loop.motion.let_end(&main_loop.settings, main_loop.now());
        main_loop.poll().await?;
    }
    main_loop.pauses.end();
    Ok(())
}

/// Restores the heater targets from before a pause, or from before the heaters switched off in the print, and waits for
/// them.
pub(in crate::machine) async fn heat_again<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let Some(targets) = main_loop.job.targets() else { return Ok(()) };
    let (measured, mut awaited, mut is_new) = (main_loop.heat.measured(), [false; HEATERS], false);
    for (heater, target) in Heater::ALL.into_iter().zip(targets).filter(|(_, target)| *target > Celsius::ZERO) {
        if main_loop.heat.target(heater) != target {
            main_loop.heat.set_target(heater, target);
            is_new = true;
        }
        awaited[heater as usize] = measured[heater as usize] < Some(target.saturating_sub(NEAR));
    }
    if is_new {
        main_loop.say(text!("echo:Heating again"));
        main_loop.heat.note_used(main_loop.now());
        main_loop.heat.send_orders(&main_loop.settings.thermal);
    }
    apart(pin!(await_heat(main_loop, awaited, false))).await?;
    main_loop.job.forget_targets();
    Ok(())
}

/// The answer to a command for a heater that is not fitted, while others are.
const fn not_fitted(heater: Heater) -> Packed {
    match heater {
        Heater::Hotend => packed!("echo:no hotend configured, ignored"),
        Heater::Bed => packed!("echo:no bed configured, ignored"),
        Heater::Chamber => packed!("echo:no chamber configured, ignored"),
    }
}

/// The heater that a command for its behaviour means, if it is fitted; otherwise the line that says so.
pub(in crate::machine) fn model_of(thermal: &ThermalSettings, heater: Option<Heater>) -> Result<Heater, Packed> {
    match heater {
        None => Err(packed!("echo:line ignored: E is 0 (hotend), -1 (bed) or -2 (chamber)")),
        Some(heater) if thermal.heater(heater).is_fitted => Ok(heater),
        Some(heater) if thermal.has_heater() => Err(not_fitted(heater)),
        Some(_) => Err(packed!("echo:no heaters configured, ignored")),
    }
}
