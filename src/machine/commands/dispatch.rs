//! Every command, in one match that has an arm for each: a new command does not compile before it is decided what it
//! does. Arms that await take their time (motion, power, storage, questions), the others are done at once.

use super::arcs::arc::{Arc, Shape, join, split};
use super::drivers::DriverValue;
use super::settings::set::CornerWords;
use super::shaping::ShaperWords;
use crate::gcode::{ArcShape, AxisFlags, AxisWords, Command, Number};
use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::hosts::schedule::Report;
use crate::machine::reports::answer::Answer;
use crate::machine::state::modal::{FARTHEST, PERCENT, Wanted};
use crate::motion::Work;
use crate::port::{Clock, MotorSet, Pend};
use crate::units::{Mm, TICKS_PER_MS, part_of};

/// The bit of M111 for a dry run (Marlin, MARLIN_DEBUG_DRYRUN).
const DRY_RUN: u32 = 8;

/// The arguments of G2 and G3.
struct ArcWords {
    clockwise: bool,
    to: AxisWords,
    feed: Option<Number>,
    shape: ArcShape,
    turns: u16,
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// The motors that move the named axes; all if none is named.
    fn motors_of(&self, flags: AxisFlags) -> MotorSet {
        let AxisFlags { x, y, z, e, .. } = flags;
        let mechanism = self.groups.mechanism();
        let named = [x, y, z, e].into_iter().enumerate().filter(|(_, named)| *named);
        let set = named.fold(MotorSet::NONE, |set, (axis, _)| set.with(mechanism.motors_of(axis)));
        if set.is_empty() { self.groups.fitted() } else { set }
    }

    /// Carries out a command, and returns what there is to say before its `ok`.
    pub(in crate::machine) async fn execute<'a>(&mut self, command: &Command<'a>) -> Result<Answer<'a>, Interrupt> {
        Ok(match *command {
            Command::Line { rapid: _, to, feed } => return self.line(&to, feed).await,
            Command::Arc { clockwise, to, feed, shape, turns } => {
                return self.arc(&ArcWords { clockwise, to, feed, shape, turns }).await;
            }
            Command::Dwell { ms } => self.dwell(ms).await?,
            Command::Retract => {
                self.stay_away(self.retraction.ways_away(self.settings.axes.z.max_speed)).await?;
                Answer::Nothing
            }
            Command::Recover => {
                self.stay_away(self.retraction.ways_back(self.settings.axes.z.max_speed)).await?;
                Answer::Nothing
            }
            Command::Home(flags) => {
                self.home(flags).await?;
                Answer::Nothing
            }
            Command::Finish => {
                self.finish().await?;
                Answer::Nothing
            }
            Command::EmergencyStop => return Err(Interrupt::Halt),
            Command::Conditional => {
                self.tell(Answer::Line(
                    "Error:which lines run depends on this one, and this firmware would run them all",
                ))
                .await?;
                return Err(Interrupt::Halt);
            }
            Command::EnableMotors(flags) => {
                self.power(self.motors_of(flags)).await?;
                Answer::Nothing
            }
            Command::DisableMotors(flags) => {
                self.finish().await?;
                self.unpower(self.motors_of(flags));
                self.told_of_edge = false;
                self.told_of_homing = false;
                Answer::Nothing
            }
            Command::AwaitUser { ms, filament } => {
                self.await_user(ms, filament).await?;
                Answer::Nothing
            }
            Command::Pause => {
                self.pause().await?;
                Answer::Nothing
            }
            Command::Resume => {
                self.resume().await?;
                Answer::Nothing
            }
            Command::SaveSettings => Answer::Storage(self.save_settings().await?),
            Command::LoadSettings => Answer::Storage(self.load_settings().await?),
            Command::DefaultSettings => Answer::Storage(self.reset_settings().await?),
            Command::CheckStorage => Answer::Storage(self.check_storage().await?),
            // Limits and settings.
            Command::StepsPerMm(words) => self.set_resolution(&words).await?,
            Command::MaxAcceleration(words) => self.set_max_acceleration(&words),
            Command::MaxSpeed(words) => self.set_max_speed(&words),
            Command::Acceleration { print, retract, travel } => self.set_acceleration(print, retract, travel),
            Command::Corners { deviation, jerk, min_feed, min_travel, min_segment } => {
                self.set_corners(&CornerWords { deviation, jerk, min_feed, min_travel, min_segment })
            }
            Command::VelocityLimit(words) => self.set_velocity_limit(&words),
            Command::RetractSettings { length, feed, lift } => self.set_retraction(length, feed, lift),
            Command::RecoverSettings { extra, feed } => self.set_recovery(extra, feed),
            Command::Shaper { axes, frequency, damping, kind } => {
                self.set_shapers(&ShaperWords { axes, frequency, damping, kind }).await?
            }
            Command::Advance { time, window } => self.set_advance(time, window).await?,
            Command::Stealth { on, axes } => self.set_stealth(on, axes).await?,
            Command::DriverCurrent(words) => self.set_drivers(DriverValue::Current, &words),
            Command::HybridThreshold(words) => self.set_drivers(DriverValue::HybridThreshold, &words),
            Command::StallThreshold(words) => self.set_drivers(DriverValue::StallThreshold, &words),
            Command::SoftEndstops(None) => Answer::SoftEndstops,
            Command::SoftEndstops(Some(on)) => {
                self.settings.soft_endstops = on;
                Answer::Nothing
            }
            Command::Keepalive(seconds) => self.set_keepalive(seconds),
            Command::IdleTimeout { seconds } => {
                self.idle_timeout_s = seconds;
                self.last_motion = self.ports.clock.now();
                Answer::Nothing
            }
            // What later lines mean.
            Command::Plane(plane) => {
                self.modal.plane = plane;
                Answer::Nothing
            }
            Command::Inches => {
                self.modal.inches = true;
                Answer::Nothing
            }
            Command::Millimetres => {
                self.modal.inches = false;
                Answer::Nothing
            }
            Command::Absolute => {
                self.modal.absolute = true;
                Answer::Nothing
            }
            Command::Relative => {
                self.modal.absolute = false;
                Answer::Nothing
            }
            Command::AbsoluteExtrusion => {
                self.modal.absolute_extrusion = true;
                Answer::Nothing
            }
            Command::RelativeExtrusion => {
                self.modal.absolute_extrusion = false;
                Answer::Nothing
            }
            Command::SetPosition(words) => self.set_position(&words),
            Command::FeedPercent(None) => Answer::FeedPercent,
            Command::FeedPercent(Some(number)) => {
                let percent = self.clamps.whole(["M220", "S"], number, PERCENT);
                self.override_feed(percent).await?;
                Answer::Nothing
            }
            Command::BackUpFeedPercent => {
                self.modal.kept_feed_percent = self.planner.feed_percent();
                Answer::Nothing
            }
            Command::RestoreFeedPercent => {
                self.override_feed(self.modal.kept_feed_percent).await?;
                Answer::Nothing
            }
            Command::FlowPercent(None) => Answer::FlowPercent,
            Command::FlowPercent(Some(number)) => {
                self.modal.flow_percent = self.clamps.whole(["M221", "S"], number, PERCENT);
                Answer::Nothing
            }
            Command::Debug(None) => Answer::DebugFlags,
            Command::Debug(Some(bits)) => {
                self.modal.dry_run = bits.to_u32() & DRY_RUN != 0;
                Answer::Nothing
            }
            Command::Tool(0) => Answer::Nothing,
            Command::Tool(number) => Answer::InvalidTool(number),
            // Reports and messages.
            Command::ReportTemperatures => Answer::Temperatures,
            Command::ReportPosition { real } => Answer::Position { real },
            Command::ReportFirmware => Answer::Firmware,
            Command::ReportSettings => Answer::Settings,
            Command::ReportLevelling => Answer::Line("echo:Bed Leveling OFF"),
            Command::ReportEndstops => {
                self.link.look_at_endstops();
                self.turn().await?;
                Answer::Endstops(self.link.status().endstops())
            }
            Command::Diagnose => {
                self.report_drivers().await?;
                self.tell(Answer::Overload).await?;
                Answer::Sensors
            }
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
                let told = &self.link.status().told;
                told.note_progress(percent.map(Number::to_u32), minutes.map(Number::to_u32));
                Answer::Nothing
            }
            Command::Object(number) => {
                let object = number.to_thousandths().div_euclid(1000) as i32;
                self.link.status().told.set_object(object);
                Answer::Nothing
            }
            // What this firmware does not do.
            Command::Heater if core::mem::replace(&mut self.told_of_heaters, true) => Answer::Nothing,
            // M104 and its relatives, until there are heaters.
            Command::Heater => Answer::Line("echo:no heaters configured"),
            Command::HeaterTuning => Answer::Line("echo:no heaters configured, ignored"),
            Command::ColdExtrusion { forbid: false } => Answer::Line("echo:Cold extrudes are enabled"),
            Command::ColdExtrusion { forbid: true } => {
                Answer::Line("echo:Cold extrudes are enabled, and cannot be forbidden without a heater")
            }
            Command::PowerOff => Answer::Line("echo:M81 ignored: this firmware does not switch the power supply"),
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

    /// G0, G1. A line that is refused changes nothing, F included.
    async fn line(&mut self, to: &AxisWords, feed: Option<Number>) -> Result<Answer<'static>, Interrupt> {
        let feed = self.clamps.feed(&self.modal, feed).unwrap_or(self.modal.feed);
        let wanted = self.target(to).await?;
        let at = self.modal.position;
        let moves = [0, 1, 2].map(|axis| wanted.position.get(axis) != at.get(axis));
        if !self.may_move(moves).await? {
            return Ok(Answer::NotHomed);
        }
        self.go(wanted.position, feed).await?;
        self.modal.feed = feed;
        self.modal.extrusion = wanted.extrusion;
        Ok(Answer::Nothing)
    }

    /// Whether these axes may move: they were homed, or need not be, of which the host is told once.
    async fn may_move(&mut self, moves: [bool; 3]) -> Result<bool, Interrupt> {
        if !moves.into_iter().zip(self.homed.0).any(|(moves, is_homed)| moves && !is_homed) {
            return Ok(true);
        }
        if self.settings.require_homing {
            self.clamps.clear();
            return Ok(false);
        }
        if !core::mem::replace(&mut self.told_of_homing, true) {
            self.tell(Answer::Line("echo:motion before homing (G28), the ends of the axes are not known")).await?;
        }
        Ok(true)
    }

    /// G92.
    fn set_position(&mut self, words: &AxisWords) -> Answer<'static> {
        for (axis, word) in [("X", words.x), ("Y", words.y), ("Z", words.z)] {
            if let Some(number) = word {
                let _: Mm = self.clamps.length(&self.modal, ["G92", axis], number, FARTHEST);
            }
        }
        self.modal.rename(words);
        Answer::Nothing
    }

    async fn target(&mut self, to: &AxisWords) -> Result<Wanted, Interrupt> {
        let wanted = self.modal.target(to, &self.settings);
        if wanted.too_much {
            self.tell(Answer::TooMuchFilament).await?;
        }
        if wanted.is_fenced {
            self.tell_of_edge().await?;
        }
        Ok(wanted)
    }

    /// G2, G3. The axis across the plane and E run evenly along the arc.
    async fn arc(&mut self, words: &ArcWords) -> Result<Answer<'static>, Interrupt> {
        let speed = self.clamps.feed(&self.modal, words.feed).unwrap_or(self.modal.feed);
        let wanted = self.target(&words.to).await?;
        let plane = self.modal.plane;
        let (start, [sz, se]) = split(plane, self.modal.position);
        let (end, [ez, ee]) = split(plane, wanted.position);
        let arc = Shape::new(words.shape, plane, |n| self.modal.length(n))
            .and_then(|shape| Arc::new(start, end, shape, words.clockwise, words.turns, self.settings.arc_tolerance));
        let arc = match arc {
            Ok(arc) => arc,
            Err(error) => {
                self.clamps.clear();
                return Ok(Answer::Line(error.text()));
            }
        };
        let [x, y, z, _] = join(plane, [true, true], [sz != ez, false]);
        if !self.may_move([x, y, z]).await? {
            return Ok(Answer::NotHomed);
        }
        self.modal.feed = speed;
        let begin = self.modal.extrusion;
        let between = |from: Mm, to: Mm, part: u32| {
            let way = to.to_bits().wrapping_sub(from.to_bits());
            Mm::from_bits(from.to_bits().wrapping_add(part_of(way, u64::from(part), u64::from(arc.chords()))))
        };
        for part in 1..=arc.chords() {
            let along = [between(sz, ez, part), between(se, ee, part)];
            self.go(join(plane, arc.point(part), along), speed).await?;
            self.modal.extrusion = between(begin, wanted.extrusion, part);
        }
        Ok(Answer::Nothing)
    }

    /// G4: lets time pass in the motion itself; M108 ends it.
    async fn dwell(&mut self, ms: u32) -> Result<Answer<'static>, Interrupt> {
        self.finish().await?;
        if ms == 0 {
            return Ok(Answer::Nothing);
        }
        self.until(|c| c.link.has_room()).await?;
        self.wait.is_dwelling = true;
        self.link.send(Work::Dwell((u64::from(ms) * u64::from(TICKS_PER_MS)) << 16));
        self.until(|c| c.wait.is_over || c.link.is_idle()).await?;
        if !self.link.is_idle() {
            self.drop_motion().await?;
        }
        Ok(Answer::Nothing)
    }
}
