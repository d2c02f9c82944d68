//! Commands that are done at once, in one match without a wildcard: a new one does not compile before it is decided what
//! it does. What takes time is only named here, as a [`Blocking`], its values in range where they have one.

use super::blocking::Blocking;
use super::drivers::set_drivers;
use super::fans::set_controller_fan;
use super::heater_settings::{set_model, set_pid};
use super::moves::ArcWords;
use super::retraction::{set_recovery, set_retraction};
use super::settings::set::{
    CornerWords, set_acceleration, set_corners, set_keepalive, set_max_acceleration, set_max_speed, set_velocity_limit,
};
use super::shaping::ShaperWords;
use crate::gcode::{AxisWords, Command, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::driver_value::DriverValue;
use crate::machine::console::{Console, PortSet};
use crate::machine::hosts::schedule::{PERIOD_S, Report};
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::{FARTHEST, PERCENT};
use crate::port::{Clock, Pend};
use crate::settings::ThermalSettings;
use crate::units::Mm;

/// The bit of M111 for a dry run (Marlin, MARLIN_DEBUG_DRYRUN).
const DRY_RUN: u32 = 8;

/// What has become of a command.
pub(in crate::machine) enum Outcome<'a, 'c> {
    /// It is done, and this is what it has to say before its `ok`.
    Done(Answer<'a>),
    /// It takes time.
    TakesTime(Blocking<'c>),
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Carries out a command if that can be done at once. Inlined, it would swell the future that awaits the others.
    #[inline(never)]
    pub(in crate::machine) fn carry_out_immediate<'a, 'c>(&mut self, command: &'c Command<'a>) -> Outcome<'a, 'c> {
        let Self { settings: s, drivers, modal, retraction, clamps, notices, .. } = self;
        Outcome::Done(match *command {
            // What takes time.
            Command::Line { rapid: _, ref to, feed } => return Outcome::TakesTime(Blocking::Line { to, feed }),
            Command::Circulate { ref to, belt, feed } => {
                return Outcome::TakesTime(Blocking::Circulate { to, belt, feed });
            }
            Command::Arc { clockwise, ref to, feed, shape, turns } => {
                return Outcome::TakesTime(Blocking::Arc(ArcWords { clockwise, to, feed, shape, turns }));
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
            Command::AwaitUser { ms, filament } => return Outcome::TakesTime(Blocking::AwaitUser { ms, filament }),
            Command::Pause => return Outcome::TakesTime(Blocking::Pause),
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
            Command::FeedPercent(Some(number)) => {
                return Outcome::TakesTime(Blocking::FeedPercent(clamps.whole(["M220", "S"], number, PERCENT)));
            }
            Command::RestoreFeedPercent => {
                return Outcome::TakesTime(Blocking::FeedPercent(modal.kept_feed_percent));
            }
            Command::AlignBelt { diagnoses, repairs } => {
                return Outcome::TakesTime(Blocking::AlignBelt { diagnoses, repairs });
            }
            Command::ReportEndstops => return Outcome::TakesTime(Blocking::ReportEndstops),
            Command::Diagnose => return Outcome::TakesTime(Blocking::Diagnose),
            Command::HeaterWait { heater, tool, target, cools } => {
                return Outcome::TakesTime(Blocking::Heat { heater, tool, target, cools });
            }
            Command::AwaitHeaters => return Outcome::TakesTime(Blocking::AwaitHeaters),
            Command::FanSpeed { fan, speed } => return Outcome::TakesTime(Blocking::Fan { fan, speed }),
            Command::SelfTest => return Outcome::TakesTime(Blocking::SelfTest),
            Command::MachineRecord(order) => return Outcome::TakesTime(Blocking::MachineRecord(order)),
            Command::TuneHeater { heater, target, cycles, applies } => {
                return Outcome::TakesTime(Blocking::Tune { heater, target, cycles, applies });
            }
            // Limits and settings.
            Command::MaxAcceleration(ref words) => set_max_acceleration(words, s, modal, clamps),
            Command::MaxSpeed(ref words) => set_max_speed(words, s, modal, clamps),
            Command::Acceleration { print, retract, travel } => {
                set_acceleration([print, retract, travel], s, modal, clamps)
            }
            Command::Corners { deviation, jerk, min_feed, min_travel, min_segment } => {
                let words = CornerWords { deviation, jerk, min_feed, min_travel, min_segment };
                set_corners(&words, s, modal, clamps, notices)
            }
            Command::VelocityLimit(ref words) => set_velocity_limit(words, s, clamps),
            Command::RetractSettings { length, feed, lift } => {
                set_retraction([length, feed, lift], &mut retraction.settings, modal, clamps)
            }
            Command::RecoverSettings { extra, feed } => {
                set_recovery([extra, feed], &mut retraction.settings, modal, clamps)
            }
            Command::DriverCurrent(ref words) => set_drivers(DriverValue::Current, words, s, drivers, modal, clamps),
            Command::HybridThreshold(ref words) => {
                set_drivers(DriverValue::HybridThreshold, words, s, drivers, modal, clamps)
            }
            Command::StallThreshold(ref words) => {
                set_drivers(DriverValue::StallThreshold, words, s, drivers, modal, clamps)
            }
            Command::SoftEndstops(None) => Answer::SoftEndstops,
            Command::SoftEndstops(Some(on)) => {
                s.soft_endstops = on;
                Answer::Nothing
            }
            Command::Keepalive(seconds) => set_keepalive(seconds, s, clamps),
            Command::IdleTimeout { seconds } => {
                self.idle_timeout.set(seconds, self.ports.clock.now());
                Answer::Nothing
            }
            // What later lines mean.
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
                self.set_position(words);
                Answer::Nothing
            }
            Command::FeedPercent(None) => Answer::FeedPercent,
            Command::BackUpFeedPercent => {
                modal.kept_feed_percent = self.planner.feed_percent();
                Answer::Nothing
            }
            Command::FlowPercent(None) => Answer::FlowPercent(modal.flow_percent),
            Command::FlowPercent(Some(number)) => {
                modal.flow_percent = clamps.whole(["M221", "S"], number, PERCENT);
                Answer::Nothing
            }
            Command::Debug(None) => Answer::DebugFlags(modal.dry_run),
            Command::Debug(Some(bits)) => {
                modal.dry_run = bits.to_u32() & DRY_RUN != 0;
                Answer::Nothing
            }
            Command::Tool(0) => Answer::Nothing,
            Command::Tool(number) => Answer::InvalidTool(number),
            // Reports and messages.
            Command::ReportTemperatures => Answer::Temperatures,
            Command::ReportPosition { real } => Answer::Position { real },
            Command::ReportFirmware => Answer::Firmware,
            Command::ReportSettings => Answer::Settings(retraction.settings),
            Command::ReportLevelling => Answer::Line("echo:Bed Leveling OFF"),
            Command::AutoPosition(seconds) => {
                self.report_every(Report::Position, seconds);
                Answer::Nothing
            }
            Command::AutoReport(seconds) => {
                self.report_every(Report::Temperatures, seconds);
                Answer::Nothing
            }
            Command::Tell { form, text } => Answer::Message(form, text),
            Command::Progress { percent, minutes } => {
                self.link
                    .status()
                    .print_progress
                    .note_progress(percent.map(Number::to_u32), minutes.map(Number::to_u32));
                Answer::Nothing
            }
            Command::Object(number) => {
                let object = number.to_thousandths().div_euclid(1000) as i32;
                self.link.status().print_progress.set_object(object);
                Answer::Nothing
            }
            // Heaters and fans.
            Command::HeaterTarget { heater, tool, target } => {
                let code = ["M104", "M140", "M141"][heater as usize];
                self.set_target(code, heater, tool, target).map_or_else(|answer| answer, |_| Answer::Nothing)
            }
            Command::Pid { heater, gains } => match self.model_of(Some(heater)) {
                Ok(_) => self.change_heat(|s, _, clamps| set_pid(heater, gains, s.heater_mut(heater), clamps)),
                Err(answer) => answer,
            },
            Command::HeaterModel { heater, words } => match self.model_of(heater) {
                Ok(heater) => self.change_heat(|s, _, clamps| set_model(heater, &words, s, clamps)),
                Err(answer) => answer,
            },
            Command::ControllerFan { speed, run_on, resets, other } => {
                self.change_heat(|s, made, clamps| set_controller_fan([speed, run_on], resets, other, s, made, clamps))
            }
            Command::ColdExtrusion { least, allow } => self.set_cold_extrusion(least, allow),
            Command::PowerOff => self.switch_off(),
            // What this firmware does not do.
            // M413 S0 asks for what is so.
            Command::PowerLossRecovery(Some(false)) => Answer::Nothing,
            Command::PowerLossRecovery(None) => Answer::Line("echo:Power-loss recovery OFF"),
            Command::PowerLossRecovery(Some(true)) => {
                Answer::Line("echo:Power-loss recovery OFF, this firmware cannot do it")
            }
            Command::Probing => Answer::Line("echo:nothing is probed by this firmware, ignored"),
            Command::CancelObject => Answer::Line("echo:objects cannot be left out, ignored"),
            Command::Malformed(flaw) => Answer::Malformed(flaw),
            Command::Unknown(text) => Answer::Unknown(text),
            // The receive path has acted on M108, M410 and M876; of M110 it hands on nothing.
            Command::Continue | Command::QuickStop | Command::Answer | Command::LineNumber => Answer::Nothing,
            // There is no display, and nothing to begin anew while the machine is not halted.
            Command::Message | Command::Restart | Command::Silent => Answer::Nothing,
        })
    }

    /// Changes settings of heaters or fans, given those that the machine was made with, and has them told.
    fn change_heat(
        &mut self,
        change: impl FnOnce(&mut ThermalSettings, &ThermalSettings, &mut Clamps) -> Answer<'static>,
    ) -> Answer<'static> {
        let answer = {
            let defaults = self.defaults().thermal;
            change(&mut self.settings.thermal, &defaults, &mut self.clamps)
        };
        self.heat_orders.note_settings();
        answer
    }

    /// G92.
    fn set_position(&mut self, words: &AxisWords) {
        for (axis, word) in [("X", words.x), ("Y", words.y), ("Z", words.z)] {
            if let Some(number) = word {
                let _: Mm = self.clamps.length(&self.modal, ["G92", axis], number, FARTHEST);
            }
        }
        self.modal.rename(words);
    }

    /// M154, M155. Without S nothing changes.
    fn report_every(&mut self, report: Report, seconds: Option<Number>) {
        if let Some(seconds) = seconds {
            let seconds = self.clamps.whole([report.code(), "S"], seconds, PERIOD_S);
            self.hosts.schedule(report, seconds as u8, self.ports.clock.now());
        }
    }
}
