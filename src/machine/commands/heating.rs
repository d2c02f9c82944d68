//! Heating: targets (M104, M140, M141), waits for them (M109, M116, M190, M191), and everything off (M81).
//!
//! A target acts at once, ahead of queued moves, and moves continue while a command waits for it. M108 ends a wait and
//! leaves the target; M410 does too. A fault of a heater halts the machine, and so ends any wait.

use crate::connectors::{HEATERS, Heater};
use crate::fault::Fault;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::says::Facts;
use crate::machine::answers::speaker::Speaker;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::job::JobEnd;
use crate::machine::state::notices::{Notice, Notices};
use crate::machine::state::waiting::Waiting;
use crate::port::{Pend, Storage};
use crate::settings::{Range, ThermalSettings};
use crate::units::{Celsius, Instant, TICKS_PER_SECOND};
use core::pin::pin;

/// Within the first distance of its target a heater has reached it; beyond the second it has lost it again: Marlin's
/// TEMP_WINDOW and TEMP_HYSTERESIS (Configuration.h, 2.1).
const NEAR: Celsius = Celsius::const_from_int(1);
const FAR: Celsius = Celsius::const_from_int(3);

/// It has to be so for that long. Marlin waits for 10 s because a PID controller oscillates. The model does not, and
/// after the sensor's lag of a second or two the reading is the real temperature.
const RESIDENCY_MS: u32 = 3000;

/// A wait for cooling ends once cooling is slower than 1.5 C a minute, because the room may be warmer than the target:
/// Marlin's MIN_COOLING_SLOPE_DEG and MIN_COOLING_SLOPE_TIME (Configuration_adv.h, 2.1).
const LEAST_COOLING: Celsius = Celsius::lit("1.5");
const COOLING_MS: u32 = 60_000;

/// A heater below its target that gains less than this in the time of its kind does not get there. By the plants: a
/// heater that can reach its target is at least 1 C below its final temperature at full power. In time t it gains at
/// least 1 C x t x loss / capacity. The heaviest bed in use (5,500 J/K) loses at least 1 W/K and gains 0.33 C in half
/// an hour. A hotend (34 J/K at most, 0.05 W/K) gains 0.35 C in four minutes. The host is warned after a third of it.
const LEAST_RISE: Celsius = Celsius::lit("0.2");
const HOTEND_STUCK_MS: u32 = 240_000;
const STUCK_MS: u32 = 1_800_000;

/// A heater without a reading for this time has a broken sensor. A working one is read a tenth of a second after the
/// start, and the reason for a missing reading is known after half of one.
const UNREAD_MS: u32 = 1000;

/// Interval of temperature lines in every wait.
pub(super) const LINE_MS: u32 = 1000;

/// Whether heaters have been at their targets for long enough.
struct Residency {
    since: Option<Instant>,
}

impl Residency {
    /// Seconds that are missing; `None` if a target is not reached.
    fn follow(&mut self, is_near: bool, is_far: bool, now: Instant) -> Option<u32> {
        if is_far {
            self.since = None;
        } else if is_near && self.since.is_none() {
            self.since = Some(now);
        }
        let end = self.since?.after_ms(RESIDENCY_MS);
        Some(end.0.saturating_sub(now.0).div_ceil(u64::from(TICKS_PER_SECOND)) as u32)
    }
}

/// Whether a heater still cools as fast as waiting for it makes sense.
struct Cooling {
    /// Start of the interval, and the temperatures then.
    looked: (Instant, [Option<Celsius>; HEATERS]),
}

impl Cooling {
    /// Whether none of the heaters that are too hot gets cooler any more.
    fn has_ended(&mut self, are_hot: [bool; HEATERS], measured: [Option<Celsius>; HEATERS], now: Instant) -> bool {
        let (since, before) = self.looked;
        if now < since.after_ms(COOLING_MS) {
            return false;
        }
        self.looked = (now, measured);
        let stays = |place: usize| {
            let both = before[place].zip(measured[place]);
            both.is_some_and(|(before, now)| before.saturating_sub(now) < LEAST_COOLING)
        };
        are_hot.iter().any(|is_hot| *is_hot) && (0..HEATERS).all(|place| !are_hot[place] || stays(place))
    }
}

/// Whether heaters below their targets still get warmer, by a small step within a short time. A chamber that warms with
/// the bed lets it creep on for hours: that is slow by the guards' floor (`thermal::guard::Gain`), which would halt the
/// machine later.
struct Rising {
    /// The reading of each heater when it last rose by a step, and its time.
    steps: [(Option<Celsius>, Instant); HEATERS],
    is_told: bool,
}

/// The reaction to a heater that gets no warmer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stuck {
    Tell(Heater),
    End(Heater),
}

impl Rising {
    fn new(measured: [Option<Celsius>; HEATERS], now: Instant) -> Self {
        Self { steps: measured.map(|measured| (measured, now)), is_told: false }
    }

    /// Follows heaters by the distances below their targets, of those that are waited for.
    fn follow(
        &mut self,
        below: [Option<Celsius>; HEATERS],
        measured: [Option<Celsius>; HEATERS],
        is_slow: impl Fn(Heater) -> bool,
        now: Instant,
    ) -> Option<Stuck> {
        for heater in Heater::ALL {
            let place = heater as usize;
            let (best, since) = &mut self.steps[place];
            let is_cold = below[place].is_some_and(|below| below > NEAR);
            if !is_cold || measured[place] >= best.map(|best| best.saturating_add(LEAST_RISE)) {
                (*best, *since) = (measured[place], now);
            }
            let most_ms = if heater == Heater::Hotend { HOTEND_STUCK_MS } else { STUCK_MS };
            if now >= since.after_ms(most_ms) || is_cold && is_slow(heater) {
                return Some(Stuck::End(heater));
            }
            if now >= since.after_ms(most_ms / 3) && !core::mem::replace(&mut self.is_told, true) {
                return Some(Stuck::Tell(heater));
            }
        }
        None
    }
}

/// The answer to a command for a heater that is not fitted; `None` if it is.
fn missing<P: PortSet, W: Pend>(
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
            if notices.give(notice) { Answer::says(say_no_heater, heater as i32) } else { Answer::Nothing }
        }
        Heater::Hotend | Heater::Bed if notices.give(Notice::NoHeaters) => {
            Answer::Line(packed!("echo:no heaters configured"))
        }
        Heater::Hotend | Heater::Bed => Answer::Nothing,
    })
}

/// M104, M140, M141, and the first part of M109, M190, M191: true if there is a target. A target beyond the heater's
/// range is refused: the old target stays.
#[allow(clippy::result_large_err, reason = "the answer is what the caller returns, whichever it is")]
pub(in crate::machine) fn set_target<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    clamps: &mut Clamps,
    code: &'static str,
    (heater, target): (Heater, Option<Number>),
) -> Result<bool, Answer<'static>> {
    if let Some(answer) = missing(main_loop, notices, heater) {
        return Err(answer);
    }
    let Some(number) = target else { return Ok(false) };
    let range = Range { least: Celsius::ZERO, most: main_loop.settings.thermal.heater(heater).most };
    let Some(target) = clamps.near_of([code, "S"], number, range, Some(main_loop.heat.target(heater))) else {
        return Ok(false);
    };
    if target > Celsius::ZERO {
        if let Some(why) = main_loop.heat.refusal(heater, &main_loop.settings.thermal) {
            return Err(Answer::NoHeat(code, why));
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

/// M109, M190, M191.
pub(in crate::machine) async fn heat_and_wait<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    clamps: &mut Clamps,
    (heater, target): (Heater, Option<Number>),
    cools: bool,
) -> Result<Answer<'static>, Interrupt> {
    let code = ["M109", "M190", "M191"][heater as usize];
    match set_target(main_loop, notices, clamps, code, (heater, target)) {
        Err(Answer::NoHeat(_, why)) => return Err(no_heat(main_loop, heater, why)),
        Err(answer) => return Ok(answer),
        Ok(false) => {}
        Ok(true) => {
            // Report clamped values before the wait, not minutes later.
            main_loop.reply_clamps(clamps).await?;
            apart(pin!(await_heat(main_loop, Heater::ALL.map(|other| other == heater), cools))).await?;
        }
    }
    Ok(Answer::Nothing)
}

/// M116: waits for all that are on.
pub(in crate::machine) async fn await_heaters<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
) -> Result<Answer<'static>, Interrupt> {
    if !main_loop.settings.thermal.has_heater() {
        return Ok(missing(main_loop, notices, Heater::Hotend).unwrap_or(Answer::Nothing));
    }
    let are_on = Heater::ALL.map(|heater| main_loop.heat.target(heater) > Celsius::ZERO);
    apart(pin!(await_heat(main_loop, are_on, true))).await?;
    Ok(Answer::Nothing)
}

/// Waits for the first reading of heaters, for as long as a working sensor may take. A machine that was just switched
/// on has none, and none is a number.
pub(in crate::machine) async fn await_readings<P: PortSet, W: Pend>(
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
fn no_heat<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, heater: Heater, why: Fault) -> Interrupt {
    let is_read = main_loop.heat.measured()[heater as usize].is_some();
    main_loop.job.note_end(if is_read { JobEnd::Refused { why } } else { JobEnd::Unread { heater } });
    Interrupt::EndJob
}

/// Waits until heaters have reached their targets, or if `cools` is not set, have no need to warm up any more.
async fn await_heat<P: PortSet, W: Pend>(
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
                return Err(no_heat(main_loop, heater, why));
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
            main_loop.reply(Answer::Heating(missing)).await?;
        }
        let are_hot = [0, 1, 2].map(|place| off_by(place).is_some_and(|by| by > NEAR));
        if missing == Some(0) || (cools && cooling.has_ended(are_hot, measured, now)) {
            break;
        }
        let below = [0, 1, 2].map(|place| off_by(place).map(|by| Celsius::ZERO.saturating_sub(by)));
        let status = main_loop.status;
        match rising.follow(below, measured, |heater| status.heat().is_slow(heater), now) {
            Some(Stuck::End(heater)) => {
                if let Some(at) = measured[heater as usize] {
                    let [at, target] = [at, targets[heater as usize]].map(Celsius::to_num::<i32>);
                    main_loop.job.note_end(JobEnd::Unreachable { heater, at, target });
                    return Err(Interrupt::EndJob);
                }
            }
            Some(Stuck::Tell(heater)) => main_loop.reply(Answer::says(say_no_rise, heater as i32)).await?,
            None => {}
        }
        // The look-ahead would keep the last moves for later ones, and these wait for this line.
        moves = moves && main_loop.motion.let_end(&main_loop.settings, main_loop.now());
        main_loop.poll().await?;
    }
    main_loop.pauses.end();
    Ok(())
}

/// Restores the heater targets from before a pause, or from before the heaters switched off in the print, and waits for
/// them.
pub(in crate::machine) async fn heat_again<P: PortSet, W: Pend>(
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
        main_loop.reply(Answer::Line(packed!("echo:Heating again"))).await?;
        main_loop.heat.note_used(main_loop.now());
        main_loop.heat.send_orders(&main_loop.settings.thermal);
    }
    apart(pin!(await_heat(main_loop, awaited, false))).await?;
    main_loop.job.forget_targets();
    Ok(())
}

/// A heater that a command is for is not fitted, but others are.
fn say_no_heater(to: &mut Speaker<'_>, facts: &Facts<'_>) {
    to.say(text!("echo:no {} configured, ignored", facts.heater()));
}

/// A heater that is waited for does not get warmer.
fn say_no_rise(to: &mut Speaker<'_>, facts: &Facts<'_>) {
    to.say(text!("echo:{} does not get warmer; the print ends if this continues. M108 ends this wait", facts.heater()));
}

/// The heater that a command for its behaviour means, if it is fitted.
#[allow(clippy::result_large_err, reason = "the answer is what the caller returns, whichever it is")]
pub(in crate::machine) fn model_of(
    thermal: &ThermalSettings,
    heater: Option<Heater>,
) -> Result<Heater, Answer<'static>> {
    match heater {
        None => Err(Answer::Line(packed!("echo:line ignored: E is 0 (hotend), -1 (bed) or -2 (chamber)"))),
        Some(heater) if thermal.heater(heater).is_fitted => Ok(heater),
        Some(heater) if thermal.has_heater() => Err(Answer::says(say_no_heater, heater as i32)),
        Some(_) => Err(Answer::Line(packed!("echo:no heaters configured, ignored"))),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_target_counts_as_reached_after_three_seconds_near_it() {
        let at = |ms: u32| Instant(0).after_ms(ms);
        let mut residency = Residency { since: None };
        assert_eq!(residency.follow(false, true, at(0)), None);
        assert_eq!(residency.follow(true, false, at(1000)), Some(3));
        assert_eq!(residency.follow(false, false, at(2500)), Some(2), "between near and far it goes on");
        assert_eq!(residency.follow(false, true, at(3000)), None);
        assert_eq!(residency.follow(true, false, at(4000)), Some(3));
        assert_eq!(residency.follow(true, false, at(6999)), Some(1));
        assert_eq!(residency.follow(true, false, at(7000)), Some(0));
    }

    #[test]
    fn a_wait_ends_when_nothing_gets_warmer_and_never_while_a_heavy_bed_still_does() {
        let at = |s: u32| Instant(0).after_ms(s * 1000);
        let celsius = Celsius::from_num::<f64>;
        let bed = |degrees: f64| [celsius(25.0), celsius(degrees), celsius(25.0)].map(Some);
        let below = |degrees: f64| [None, Some(celsius(99.0 - degrees)), None];
        // A bed of 5,500 J/K that loses 1 W/K and is heated to a degree above the target: seen until it is a degree
        // below.
        let mut rising = Rising::new(bed(25.0), at(0));
        let (mut degrees, mut s) = (25.0, 0);
        while degrees < 99.0 {
            degrees += (100.0 - degrees) / 5500.0;
            s += 1;
            let stuck = rising.follow(below(degrees), bed(degrees), |_| false, at(s));
            assert!(!matches!(stuck, Some(Stuck::End(_))), "{degrees} after {s} s");
        }
        // One that stays where it is.
        let mut rising = Rising::new(bed(80.0), at(0));
        let found: Vec<_> =
            (0..=1800).filter_map(|s| Some((s, rising.follow(below(80.1), bed(80.1), |_| false, at(s))?))).collect();
        assert_eq!(found, [(600, Stuck::Tell(Heater::Bed)), (1800, Stuck::End(Heater::Bed))]);
        assert_eq!(rising.follow([None; HEATERS], bed(80.1), |_| false, at(9000)), None);
    }

    #[test]
    fn a_heater_that_the_guards_find_slow_ends_the_wait_for_it_alone() {
        let at = |degrees: i32| [None, Some(Celsius::from_num(degrees)), None];
        let mut rising = Rising::new(at(72), Instant(0));
        let slow = |slow: Heater| move |heater| heater == slow;
        assert_eq!(rising.follow(at(7), at(72), slow(Heater::Chamber), Instant(0)), None);
        assert_eq!(rising.follow(at(1), at(78), slow(Heater::Bed), Instant(0)), None, "near enough");
        assert_eq!(rising.follow(at(7), at(72), slow(Heater::Bed), Instant(0)), Some(Stuck::End(Heater::Bed)));
    }

    #[test]
    fn cooling_ends_when_it_takes_too_long() {
        let celsius = |degrees: i32| Some(Celsius::from_num(degrees));
        let mut cooling = Cooling { looked: (Instant(0), [celsius(60); HEATERS]) };
        let hot = [true, false, false];
        assert!(!cooling.has_ended(hot, [celsius(60); HEATERS], Instant(0).after_ms(59_999)));
        assert!(!cooling.has_ended(hot, [celsius(50); HEATERS], Instant(0).after_ms(60_000)));
        assert!(cooling.has_ended(hot, [celsius(49); HEATERS], Instant(0).after_ms(120_000)));
    }
}
