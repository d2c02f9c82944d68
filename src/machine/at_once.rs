//! Every command that takes no time: what later lines mean, settings, and reports.

use super::answer::Answer;
use super::autoreport::Report;
use super::console::{Console, PortSet};
use super::drivers::DriverValue;
use super::modal::Modal;
use crate::gcode::{Command, Number};
use crate::port::{Clock, Pend};

/// The bit of M111 for a dry run (Marlin, MARLIN_DEBUG_DRYRUN).
const DRY_RUN: u32 = 8;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Carries out a command, and returns what there is to say before its `ok`.
    pub(super) fn execute_at_once<'a>(&mut self, command: &Command<'a>) -> Answer<'a> {
        match *command {
            Command::RetractSettings { length, feed, lift } => self.set_retraction(length, feed, lift),
            Command::RecoverSettings { extra, feed } => self.set_recovery(extra, feed),
            Command::MaxAcceleration(words) => self.set_max_acceleration(&words),
            Command::MaxSpeed(words) => self.set_max_speed(&words),
            Command::Acceleration { print, retract, travel } => self.set_acceleration(print, retract, travel),
            Command::Corners { deviation, jerk, min_feed, min_travel } => {
                self.set_corners(deviation, &jerk, min_feed, min_travel)
            }
            Command::CruiseRatio(ratio) => self.set_cruise_ratio(ratio),
            Command::Keepalive(seconds) => self.set_keepalive(seconds),
            Command::DriverCurrent(words) => self.set_drivers(DriverValue::Current, &words),
            Command::HybridThreshold(words) => self.set_drivers(DriverValue::HybridThreshold, &words),
            Command::StallThreshold(words) => self.set_drivers(DriverValue::StallThreshold, &words),
            Command::SoftEndstops(None) => Answer::SoftEndstops,
            Command::FeedPercent(None) => Answer::FeedPercent,
            Command::FlowPercent(None) => Answer::FlowPercent,
            Command::Debug(None) => Answer::DebugFlags,
            Command::Tell { form, text } => Answer::Message(form, text),
            Command::ReportTemperatures => Answer::Temperatures,
            Command::ReportPosition { real } => Answer::Position { real },
            Command::ReportFirmware => Answer::Firmware,
            Command::ReportSettings => Answer::Settings,
            Command::Tool(0) => Answer::Nothing,
            Command::Tool(number) => Answer::InvalidTool(number),
            Command::Heater if core::mem::replace(&mut self.told_of_heaters, true) => Answer::Nothing,
            // M104 and its relatives, until there are heaters.
            Command::Heater => Answer::Line("echo:no heaters configured"),
            Command::ColdExtrusion => Answer::Line("echo:Cold extrudes are enabled"),
            Command::ReportLevelling => Answer::Line("echo:Bed Leveling OFF"),
            Command::Probing => Answer::Line("echo:nothing is probed by this firmware, ignored"),
            Command::CancelObject => Answer::Line("echo:objects cannot be left out, ignored"),
            Command::Unknown(text) => Answer::Unknown(text),
            _ => {
                self.remember(command);
                Answer::Nothing
            }
        }
    }

    /// Commands that only change what later lines mean, or what hosts are told by themselves. Of the rest nothing is
    /// left to do: the receive path has acted on M108 and M410 already.
    fn remember(&mut self, command: &Command<'_>) {
        match *command {
            Command::AutoPosition(seconds) => self.report_every(Report::Position, seconds),
            Command::AutoReport(seconds) => self.report_every(Report::Temperatures, seconds),
            Command::IdleTimeout { seconds } => {
                self.idle_timeout_s = seconds;
                self.last_motion = self.ports.clock.now();
            }
            Command::Inches => self.modal.inches = true,
            Command::Millimetres => self.modal.inches = false,
            Command::Absolute => self.modal.absolute = true,
            Command::Relative => self.modal.absolute = false,
            Command::AbsoluteExtrusion => self.modal.absolute_extrusion = true,
            Command::RelativeExtrusion => self.modal.absolute_extrusion = false,
            Command::SetPosition(words) => self.modal.rename(&words),
            Command::SoftEndstops(Some(on)) => self.settings.soft_endstops = on,
            Command::BackUpFeedPercent => self.modal.kept_feed_percent = self.planner.feed_percent(),
            Command::Debug(Some(bits)) => self.modal.dry_run = bits.to_u32() & DRY_RUN != 0,
            Command::Progress { percent, minutes } => {
                self.link.status().told.note_progress(percent.map(Number::to_u32), minutes.map(Number::to_u32));
            }
            Command::Object(number) => {
                self.link.status().told.set_object(number.to_thousandths().div_euclid(1000) as i32)
            }
            Command::FlowPercent(Some(number)) => self.modal.flow_percent = Modal::percent(number),
            _ => {}
        }
    }
}
