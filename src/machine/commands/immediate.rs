//! Commands that are done at once, in one match without a wildcard: a new command does not compile without an arm. A
//! command that takes time is only named here, as a [`Blocking`], with its words; only M220's percentage is
//! range-checked here.

use super::blocking::Blocking;
use super::drivers::set_drivers;
use super::fans::set_controller_fan;
use super::heater_settings::{set_model, set_pid};
use super::heating::{TargetWords, model_of, set_target, switch_off};
use super::job::starts_print;
use super::messages::send_message;
use super::moves::ArcWords;
use super::retraction::{set_recovery, set_retraction};
use super::settings::set::{
    CornerWords, set_acceleration, set_corners, set_keepalive, set_max_acceleration, set_max_speed, set_velocity_limit,
};
use super::shaping::ShaperWords;
use super::states::States;
use super::tuning::TuningWords;
use crate::gcode::{AxisWords, Command, Flaw, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::driver_value::DriverValue;
use crate::machine::hosts::schedule::{PERIOD_S, Report};
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::{FARTHEST, Modal, PERCENT};
use crate::port::Pend;
use crate::settings::{Range, ThermalSettings};
use crate::units::Mm;

/// The bit of M111 for a dry run (Marlin, MARLIN_DEBUG_DRYRUN).
const DRY_RUN: u32 = 8;

/// The outcome of a command.
pub(in crate::machine) enum Outcome<'a, 'c> {
    /// It is done; this is the answer before its `ok`.
    Done(Answer<'a>),
    /// It takes time.
    TakesTime(Blocking<'c>),
}

/// Carries out a command if that can be done at once. Inlined, it would swell the future that awaits the others.
#[inline(never)]
pub(super) fn carry_out_immediate<'a, 'c, P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &'c Command<'a>,
) -> Outcome<'a, 'c> {
    let States { modal, retraction, clamps, notices, pieces: _, cold } = states;
    Outcome::Done(match *command {
        // Commands that take time.
        Command::Line { rapid: _, ref to, feed } => return Outcome::TakesTime(Blocking::Line { to, feed }),
        Command::Circulate { ref to, belt, feed } => {
            return Outcome::TakesTime(Blocking::Circulate { to, belt, feed });
        }
        Command::Arc { clockwise, ref to, feed, shape, turns, decimals } => {
            return Outcome::TakesTime(Blocking::Arc(ArcWords { clockwise, to, feed, shape, turns, decimals }));
        }
        Command::Dwell { ms } => return Outcome::TakesTime(Blocking::Dwell { ms }),
        Command::Retract => return Outcome::TakesTime(Blocking::Retract),
        Command::Recover => return Outcome::TakesTime(Blocking::Recover),
        Command::Home(flags) => return Outcome::TakesTime(Blocking::Home(flags)),
        Command::Finish => return Outcome::TakesTime(Blocking::Finish),
        Command::EmergencyStop => return Outcome::TakesTime(Blocking::EmergencyStop),
        Command::Conditional => return Outcome::TakesTime(Blocking::Conditional),
        Command::EnableMotors(flags) => return Outcome::TakesTime(Blocking::EnableMotors(flags)),
        Command::DisableMotors(flags) => return Outcome::TakesTime(Blocking::DisableMotors(flags)),
        Command::AwaitUser { ms, filament, ref park } => {
            return Outcome::TakesTime(Blocking::AwaitUser { ms, filament, park });
        }
        Command::Pause { parks, ref park } => return Outcome::TakesTime(Blocking::Pause { parks, park }),
        Command::EndJob => return Outcome::TakesTime(Blocking::EndJob),
        Command::Resume => return Outcome::TakesTime(Blocking::Resume),
        Command::SaveSettings => return Outcome::TakesTime(Blocking::SaveSettings),
        Command::LoadSettings => return Outcome::TakesTime(Blocking::LoadSettings),
        Command::DefaultSettings => return Outcome::TakesTime(Blocking::DefaultSettings),
        Command::CheckStorage => return Outcome::TakesTime(Blocking::CheckStorage),
        Command::StepsPerMm(ref words) => return Outcome::TakesTime(Blocking::StepsPerMm(words)),
        Command::Shaper { axes, frequency, damping, kind } => {
            return Outcome::TakesTime(Blocking::Shaper(ShaperWords { axes, frequency, damping, kind }));
        }
        Command::Advance { time, window } => return Outcome::TakesTime(Blocking::Advance { time, window }),
        Command::Stealth { on, axes } => return Outcome::TakesTime(Blocking::Stealth { on, axes }),
        Command::FeedPercent(Some(number)) => match clamps.whole_of(["M220", "S"], number, PERCENT, None) {
            Some(percent) => return Outcome::TakesTime(Blocking::FeedPercent(percent)),
            None => Answer::Nothing,
        },
        Command::RestoreFeedPercent => {
            return Outcome::TakesTime(Blocking::FeedPercent(modal.kept_feed_percent));
        }
        Command::AlignBelt { diagnoses, repairs } => {
            return Outcome::TakesTime(Blocking::AlignBelt { diagnoses, repairs });
        }
        Command::ReportEndstops => return Outcome::TakesTime(Blocking::ReportEndstops),
        Command::Diagnose => return Outcome::TakesTime(Blocking::Diagnose),
        Command::HeaterWait { heater, target, cools } => {
            let words = TargetWords { heater, target };
            return Outcome::TakesTime(Blocking::Heat { words, cools });
        }
        Command::AwaitHeaters => return Outcome::TakesTime(Blocking::AwaitHeaters),
        Command::FanSpeed { fan, speed } => return Outcome::TakesTime(Blocking::Fan { fan, speed }),
        Command::SelfTest => return Outcome::TakesTime(Blocking::SelfTest),
        Command::MachineRecord(order) => return Outcome::TakesTime(Blocking::MachineRecord(order)),
        Command::TuneHeater { heater, target, cycles, applies } => {
            return Outcome::TakesTime(Blocking::Tune(TuningWords { heater, target, cycles, applies }));
        }
        // Limits and settings.
        Command::MaxAcceleration(ref words) => {
            set_max_acceleration(words, &mut main_loop.live_settings(), modal, clamps)
        }
        Command::MaxSpeed(ref words) => set_max_speed(words, &mut main_loop.live_settings(), modal, clamps),
        Command::Acceleration { print, retract, travel } => {
            set_acceleration([print, retract, travel], &mut main_loop.live_settings(), modal, clamps)
        }
        Command::Corners { deviation, jerk, min_feed, min_travel, min_segment } => {
            let words = CornerWords { deviation, jerk, min_feed, min_travel, min_segment };
            set_corners(&words, &mut main_loop.live_settings(), modal, clamps, notices)
        }
        Command::VelocityLimit(ref words) => set_velocity_limit(words, &mut main_loop.live_settings(), clamps),
        Command::RetractSettings { length, feed, lift } => {
            set_retraction([length, feed, lift], retraction, modal, clamps)
        }
        Command::RecoverSettings { extra, feed } => set_recovery([extra, feed], retraction, modal, clamps),
        Command::DriverCurrent(ref words) => set_drivers(main_loop, DriverValue::Current, words, modal, clamps),
        Command::HybridThreshold(ref words) => {
            set_drivers(main_loop, DriverValue::HybridThreshold, words, modal, clamps)
        }
        Command::StallThreshold(ref words) => set_drivers(main_loop, DriverValue::StallThreshold, words, modal, clamps),
        Command::SoftEndstops(None) => Answer::SoftEndstops,
        Command::SoftEndstops(Some(on)) => {
            main_loop.live_settings().set_soft_endstops(on);
            Answer::Nothing
        }
        Command::Keepalive(seconds) => set_keepalive(seconds, &mut main_loop.live_settings(), clamps),
        Command::IdleTimeout { seconds } => {
            main_loop.power.set_idle_timeout(seconds, main_loop.now());
            Answer::Nothing
        }
        // Modes for later lines.
        Command::Plane(plane) => {
            modal.plane = plane;
            Answer::Nothing
        }
        Command::Inches => {
            modal.inches = true;
            Answer::Nothing
        }
        Command::Millimetres => {
            modal.inches = false;
            Answer::Nothing
        }
        Command::Absolute => {
            modal.absolute = true;
            Answer::Nothing
        }
        Command::Relative => {
            modal.absolute = false;
            Answer::Nothing
        }
        Command::AbsoluteExtrusion => {
            modal.absolute_extrusion = true;
            Answer::Nothing
        }
        Command::RelativeExtrusion => {
            modal.absolute_extrusion = false;
            Answer::Nothing
        }
        Command::SetPosition(ref words) => {
            set_position(main_loop, modal, clamps, words);
            Answer::Nothing
        }
        Command::FeedPercent(None) => Answer::FeedPercent,
        Command::BackUpFeedPercent => {
            modal.kept_feed_percent = main_loop.feed_percent();
            Answer::Nothing
        }
        Command::FlowPercent(None) => Answer::FlowPercent(modal.flow_percent),
        Command::FlowPercent(Some(number)) => {
            clamps.whole(["M221", "S"], number, PERCENT, &mut modal.flow_percent);
            Answer::Nothing
        }
        Command::Debug(None) => Answer::DebugFlags(modal.dry_run),
        Command::Debug(Some(bits)) => {
            modal.dry_run = bits.to_u32() & DRY_RUN != 0;
            Answer::Nothing
        }
        Command::Tool => Answer::Nothing,
        // Reports and messages.
        Command::ReportTemperatures => Answer::Temperatures,
        Command::ReportPosition { real } => Answer::Position { real },
        Command::ReportFirmware => Answer::Firmware,
        Command::ReportSettings { for_replay } => Answer::Settings { retraction: *retraction, for_replay },
        Command::ReportLevelling => Answer::Line("echo:Bed Leveling OFF"),
        Command::AutoPosition(seconds) => {
            report_every(main_loop, clamps, Report::Position, seconds);
            Answer::Nothing
        }
        Command::AutoReport(seconds) => {
            report_every(main_loop, clamps, Report::Temperatures, seconds);
            Answer::Nothing
        }
        Command::Tell { form, to, text } => send_message(main_loop, (form, to), text),
        Command::Progress { percent, minutes } => {
            let (hundred, long) = (Range { least: 0, most: 100 }, Range { least: 0, most: u16::MAX });
            let percent = percent.and_then(|percent| clamps.whole_of(["M73", "P"], percent, hundred, None));
            let minutes = minutes.and_then(|minutes| clamps.whole_of(["M73", "R"], minutes, long, None));
            if !clamps.refuses_line() {
                main_loop.status().print_progress.note_progress(percent.map(u32::from), minutes.map(u32::from));
            }
            Answer::Nothing
        }
        Command::Object(number) => {
            let object = number.to_thousandths().div_euclid(1000) as i32;
            main_loop.status().print_progress.set_object(object);
            Answer::Nothing
        }
        // Heaters and fans.
        Command::HeaterTarget { heater, target } => {
            let code = ["M104", "M140", "M141"][heater as usize];
            let words = TargetWords { heater, target };
            set_target(main_loop, notices, clamps, code, &words).map_or_else(|answer| answer, |_| Answer::Nothing)
        }
        Command::Pid { heater, gains } => match model_of(main_loop, Some(heater)) {
            Ok(_) => change_heat(main_loop, |s, _| set_pid(heater, gains, s.heater_mut(heater), clamps)),
            Err(answer) => answer,
        },
        Command::HeaterModel { heater, is_named, words } => match model_of(main_loop, heater) {
            Ok(heater) => change_heat(main_loop, |s, _| set_model(heater, is_named, &words, s, clamps)),
            Err(answer) => answer,
        },
        Command::ControllerFan { speed, run_on, resets, other } => {
            change_heat(main_loop, |s, made| set_controller_fan([speed, run_on], resets, other, s, made, clamps))
        }
        Command::ColdExtrusion { least, allow } => cold.set(main_loop, clamps, least, allow),
        Command::PowerOff => switch_off(main_loop),
        // Unsupported functions.
        Command::BeginUpload(name) => {
            main_loop.hosts.begin_upload(main_loop.now());
            Answer::NoCard(name)
        }
        Command::EndUpload => main_loop.hosts.end_upload().map_or(Answer::Nothing, Answer::UploadEnded),
        // M413 S0 is a no-op: power-loss recovery is always off.
        Command::PowerLossRecovery(Some(false)) => Answer::Nothing,
        Command::PowerLossRecovery(None) => Answer::Line("echo:Power-loss recovery OFF"),
        Command::PowerLossRecovery(Some(true)) => {
            Answer::Line("echo:Power-loss recovery OFF, this firmware cannot do it")
        }
        Command::Probing => Answer::Line("echo:this firmware has no probing, ignored"),
        Command::CancelObject => Answer::Line("echo:this firmware cannot leave out objects, ignored"),
        Command::Malformed(Flaw::Absent(absent)) if !notices.give_absent(absent.key()) => Answer::Nothing,
        Command::Malformed(flaw) => Answer::Malformed(flaw),
        Command::Unknown(text) => {
            let host = main_loop.hosts.serving();
            match starts_print(text) {
                Some(true) => main_loop.job.begin_by_unknown_name(host),
                Some(false) if main_loop.job.is_printing() => main_loop.job.end(),
                Some(false) | None => {}
            }
            Answer::Unknown(text)
        }
        Command::BeginJob => {
            let host = main_loop.hosts.serving();
            main_loop.job.begin(host);
            Answer::Nothing
        }
        // The receive path has acted on M108, M410, M524 and M876; of M110 it passes nothing on.
        Command::Continue | Command::QuickStop | Command::Cancel | Command::Answer | Command::LineNumber => {
            Answer::Nothing
        }
        // There is no display, and a restart has no effect unless the machine is halted.
        Command::Message | Command::Restart | Command::Silent => Answer::Nothing,
    })
}

/// Changes settings of heaters or fans, given the default settings, and reports them.
fn change_heat<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    change: impl FnOnce(&mut ThermalSettings, &ThermalSettings) -> Answer<'static>,
) -> Answer<'static> {
    let defaults = main_loop.settings.defaults().thermal;
    change(main_loop.heat_settings(), &defaults)
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

/// M154, M155. Without S nothing changes.
fn report_every<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    report: Report,
    seconds: Option<Number>,
) {
    if let Some(seconds) = seconds.and_then(|s| clamps.whole_of([report.code(), "S"], s, PERIOD_S, None)) {
        main_loop.hosts.schedule(report, seconds as u8, main_loop.now());
    }
}
