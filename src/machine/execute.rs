//! Every command, and what it does.

use super::arc::{Arc, Shape};
use super::autoreport::Report;
use super::console::{Console, Interrupt, PortSet};
use super::drivers::DriverValue;
use super::modal::{Modal, Wanted};
use crate::gcode::{ArcShape, AxisFlags, AxisWords, Command, Number};
use crate::motion::Work;
use crate::port::{Clock, MotorSet, Pend};
use crate::units::{Mm, TICKS_PER_MS, part_of};

/// The bit of M111 for a dry run (Marlin, MARLIN_DEBUG_DRYRUN).
const DRY_RUN: u32 = 8;

/// The motors that move the named axes; all if none is named.
fn motors(flags: AxisFlags) -> MotorSet {
    let mut set = MotorSet::NONE;
    if flags.x || flags.y {
        set = set.with(MotorSet::BELT);
    }
    if flags.z {
        set = set.with(MotorSet::Z);
    }
    if flags.e {
        set = set.with(MotorSet::E);
    }
    if set.is_empty() { MotorSet::ALL } else { set }
}

/// The arguments of G2 and G3.
struct ArcWords {
    clockwise: bool,
    to: AxisWords,
    shape: ArcShape,
    turns: u16,
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Carries out a command up to its `ok`.
    pub(super) async fn execute(&mut self, command: &Command<'_>) -> Result<(), Interrupt> {
        match *command {
            Command::Line { to, feed, .. } => self.line(&to, feed).await,
            Command::Arc { clockwise, to, feed, shape, turns } => {
                self.modal.set_feed(feed);
                self.arc(&ArcWords { clockwise, to, shape, turns }).await
            }
            Command::Dwell { ms } => self.dwell(ms).await,
            Command::Retract | Command::Recover => {
                let (retraction, z_speed) = (self.retraction, self.settings.axes.z.max_speed);
                let retracts = *command == Command::Retract;
                self.stay_away(if retracts { retraction.ways_away(z_speed) } else { retraction.ways_back(z_speed) })
                    .await
            }
            Command::RetractSettings { length, feed, lift } => self.set_retraction(length, feed, lift).await,
            Command::RecoverSettings { extra, feed } => self.set_recovery(extra, feed).await,
            Command::Home(flags) => self.home(flags).await,
            Command::Finish => self.finish().await,
            // The receive path has acted on these already.
            Command::Continue | Command::QuickStop => Ok(()),
            Command::EmergencyStop => Err(Interrupt::Halt),
            Command::EnableMotors(flags) => self.power(motors(flags)).await,
            Command::DisableMotors(flags) => {
                self.finish().await?;
                self.unpower(motors(flags));
                self.told_of_edge = false;
                Ok(())
            }
            Command::StepsPerMm(words) => self.set_resolution(&words).await,
            Command::MaxAcceleration(words) => self.set_max_acceleration(&words).await,
            Command::MaxSpeed(words) => self.set_max_speed(&words).await,
            Command::Acceleration { print, retract, travel } => self.set_acceleration(print, retract, travel).await,
            Command::Corners { deviation, jerk, min_feed, min_travel } => {
                self.set_corners(deviation, &jerk, min_feed, min_travel).await
            }
            Command::SoftEndstops(None) => self.report_soft_endstops().await,
            Command::FeedPercent(None) => {
                let percent = self.modal.feed_percent;
                self.say(format_args!("FR:{percent}%")).await
            }
            Command::FlowPercent(None) => {
                let percent = self.modal.flow_percent;
                self.say(format_args!("echo:E0 Flow: {percent}%")).await
            }
            Command::AwaitUser { ms, filament } => self.await_user(ms, filament).await,
            Command::Pause => self.pause().await,
            Command::Resume => self.resume().await,
            Command::Tell { form, text } => self.tell(form, text).await,
            Command::Debug(None) => {
                let what = if self.modal.dry_run { "DRYRUN" } else { "off" };
                self.say(format_args!("echo:DEBUG:{what}")).await
            }
            Command::AutoPosition(seconds) => self.report_every(Report::Position, seconds),
            Command::AutoReport(seconds) => self.report_every(Report::Temperatures, seconds),
            Command::Keepalive(seconds) => self.set_keepalive(seconds).await,
            Command::ReportPosition { real } => self.report_position(real).await,
            Command::ReportFirmware => self.report_firmware().await,
            Command::ReportEndstops => self.report_endstops().await,
            Command::Diagnose => {
                self.report_drivers().await?;
                self.report_sensors().await
            }
            Command::ReportSettings => self.report_settings().await,
            Command::SaveSettings => self.save_settings().await,
            Command::LoadSettings => self.load_settings().await,
            Command::DefaultSettings => self.reset_settings().await,
            Command::CheckStorage => self.check_storage().await,
            Command::DriverCurrent(words) => self.set_drivers(DriverValue::Current, &words).await,
            Command::HybridThreshold(words) => self.set_drivers(DriverValue::HybridThreshold, &words).await,
            Command::StallThreshold(words) => self.set_drivers(DriverValue::StallThreshold, &words).await,
            Command::Stealth { on, axes } => self.set_stealth(on, axes).await,
            Command::Tool(0) => Ok(()),
            Command::Tool(number) => self.say(format_args!("echo:T{number} Invalid extruder")).await,
            Command::Heater => self.explain_heaters().await,
            Command::ColdExtrusion => self.say(format_args!("echo:Cold extrudes are enabled")).await,
            Command::ReportAdvance => self.say(format_args!("echo:Advance K=0")).await,
            Command::ReportLevelling => self.say(format_args!("echo:Bed Leveling OFF")).await,
            Command::Probing => self.say(format_args!("echo:nothing is probed by this firmware, ignored")).await,
            Command::CancelObject => self.say(format_args!("echo:objects cannot be left out, ignored")).await,
            _ => {
                self.remember(command);
                Ok(())
            }
        }
    }

    /// Commands that only change what later lines mean; of the rest, nothing is left to do.
    fn remember(&mut self, command: &Command<'_>) {
        match *command {
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
            Command::FeedPercent(Some(number)) => self.modal.feed_percent = Modal::percent(number),
            Command::BackUpFeedPercent => self.modal.kept_feed_percent = self.modal.feed_percent,
            Command::RestoreFeedPercent => self.modal.feed_percent = self.modal.kept_feed_percent,
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

    /// G0, G1.
    async fn line(&mut self, to: &AxisWords, feed: Option<Number>) -> Result<(), Interrupt> {
        self.modal.set_feed(feed);
        let wanted = self.target(to).await?;
        self.go(wanted.position, self.modal.overridden_feed()).await?;
        self.modal.extrusion = wanted.extrusion;
        Ok(())
    }

    async fn target(&mut self, to: &AxisWords) -> Result<Wanted, Interrupt> {
        let wanted = self.modal.target(to, &self.settings);
        if wanted.too_much {
            let most = self.settings.axes.e.length.to_num::<i32>();
            self.say(format_args!("echo:E left out: more than {most} mm of filament in one move")).await?;
        }
        Ok(wanted)
    }

    /// G2, G3. Z and E run evenly along the arc.
    async fn arc(&mut self, words: &ArcWords) -> Result<(), Interrupt> {
        let wanted = self.target(&words.to).await?;
        let [sx, sy, sz, se] = self.modal.position;
        let [ex, ey, ez, ee] = wanted.position;
        let arc = Shape::new(words.shape, |n| self.modal.length(n)).and_then(|shape| {
            let tolerance = self.settings.arc_tolerance;
            Arc::new([sx, sy], [ex, ey], shape, words.clockwise, words.turns, tolerance)
        });
        let arc = match arc {
            Ok(arc) => arc,
            Err(error) => return self.say(format_args!("echo:{}", error.text())).await,
        };
        let speed = self.modal.overridden_feed();
        let begin = self.modal.extrusion;
        let between = |from: Mm, to: Mm, part: u32| {
            let way = to.to_bits().wrapping_sub(from.to_bits());
            Mm::from_bits(from.to_bits().wrapping_add(part_of(way, u64::from(part), u64::from(arc.chords()))))
        };
        for part in 1..=arc.chords() {
            let [x, y] = arc.point(part);
            self.go([x, y, between(sz, ez, part), between(se, ee, part)], speed).await?;
            self.modal.extrusion = between(begin, wanted.extrusion, part);
        }
        Ok(())
    }

    /// G4: lets time pass in the motion itself; M108 ends it.
    async fn dwell(&mut self, ms: u32) -> Result<(), Interrupt> {
        self.finish().await?;
        if ms == 0 {
            return Ok(());
        }
        self.until(|c| c.link.has_room()).await?;
        self.wait.is_dwelling = true;
        self.link.send(Work::Dwell((u64::from(ms) * u64::from(TICKS_PER_MS)) << 16));
        self.until(|c| c.wait.is_over || c.link.is_idle()).await?;
        if self.link.is_idle() { Ok(()) } else { self.drop_motion().await }
    }

    /// M104 and its relatives, until there are heaters.
    async fn explain_heaters(&mut self) -> Result<(), Interrupt> {
        if core::mem::replace(&mut self.told_of_heaters, true) {
            return Ok(());
        }
        self.say(format_args!("echo:no heaters configured")).await
    }
}
