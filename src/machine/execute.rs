//! Every command that takes its time: motion, power, storage, questions. The others are carried out at once.

use super::answer::Answer;
use super::arc::{Arc, Shape};
use super::console::{Console, Interrupt, PortSet};
use super::modal::{Modal, Wanted};
use super::shaping::ShaperWords;
use crate::gcode::{ArcShape, AxisFlags, AxisWords, Command, Number};
use crate::motion::Work;
use crate::port::{MotorSet, Pend};
use crate::units::{Mm, TICKS_PER_MS, part_of};

/// The arguments of G2 and G3.
struct ArcWords {
    clockwise: bool,
    to: AxisWords,
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
    pub(super) async fn execute<'a>(&mut self, command: &Command<'a>) -> Result<Answer<'a>, Interrupt> {
        match *command {
            Command::Line { to, feed, .. } => self.line(&to, feed).await?,
            Command::Arc { clockwise, to, feed, shape, turns } => {
                self.modal.set_feed(feed);
                return self.arc(&ArcWords { clockwise, to, shape, turns }).await;
            }
            Command::Dwell { ms } => self.dwell(ms).await?,
            Command::Retract | Command::Recover => {
                let (retraction, z_speed) = (self.retraction, self.settings.axes.z.max_speed);
                let retracts = *command == Command::Retract;
                self.stay_away(if retracts { retraction.ways_away(z_speed) } else { retraction.ways_back(z_speed) })
                    .await?;
            }
            Command::Home(flags) => self.home(flags).await?,
            Command::Finish => self.finish().await?,
            Command::FeedPercent(Some(number)) => self.override_feed(Modal::percent(number)).await?,
            Command::RestoreFeedPercent => self.override_feed(self.modal.kept_feed_percent).await?,
            Command::EmergencyStop => return Err(Interrupt::Halt),
            Command::EnableMotors(flags) => self.power(self.motors_of(flags)).await?,
            Command::DisableMotors(flags) => {
                self.finish().await?;
                self.unpower(self.motors_of(flags));
                self.told_of_edge = false;
            }
            Command::StepsPerMm(words) => return self.set_resolution(&words).await,
            Command::AwaitUser { ms, filament } => self.await_user(ms, filament).await?,
            Command::Pause => self.pause().await?,
            Command::Resume => self.resume().await?,
            Command::ReportEndstops => {
                self.link.look_at_endstops();
                self.turn().await?;
                return Ok(Answer::Endstops(self.link.status().endstops()));
            }
            Command::Diagnose => {
                self.report_drivers().await?;
                self.tell(Answer::Overload).await?;
                return Ok(Answer::Sensors);
            }
            Command::SaveSettings => return self.save_settings().await.map(Answer::Storage),
            Command::LoadSettings => return self.load_settings().await.map(Answer::Storage),
            Command::DefaultSettings => return self.reset_settings().await.map(Answer::Storage),
            Command::CheckStorage => return self.check_storage().await.map(Answer::Storage),
            Command::Shaper { axes, frequency, damping, kind } => {
                return self.set_shapers(&ShaperWords { axes, frequency, damping, kind }).await;
            }
            Command::Advance { time, window } => return self.set_advance(time, window).await,
            Command::Stealth { on, axes } => return self.set_stealth(on, axes).await,
            _ => return Ok(self.execute_at_once(command)),
        }
        Ok(Answer::Nothing)
    }

    /// G0, G1.
    async fn line(&mut self, to: &AxisWords, feed: Option<Number>) -> Result<(), Interrupt> {
        self.modal.set_feed(feed);
        let wanted = self.target(to).await?;
        self.go(wanted.position, self.modal.feed).await?;
        self.modal.extrusion = wanted.extrusion;
        Ok(())
    }

    async fn target(&mut self, to: &AxisWords) -> Result<Wanted, Interrupt> {
        let wanted = self.modal.target(to, &self.settings);
        if wanted.too_much {
            self.tell(Answer::TooMuchFilament).await?;
        }
        Ok(wanted)
    }

    /// G2, G3. Z and E run evenly along the arc.
    async fn arc(&mut self, words: &ArcWords) -> Result<Answer<'static>, Interrupt> {
        let wanted = self.target(&words.to).await?;
        let [sx, sy, sz, se] = self.modal.position;
        let [ex, ey, ez, ee] = wanted.position;
        let arc = Shape::new(words.shape, |n| self.modal.length(n)).and_then(|shape| {
            let tolerance = self.settings.arc_tolerance;
            Arc::new([sx, sy], [ex, ey], shape, words.clockwise, words.turns, tolerance)
        });
        let arc = match arc {
            Ok(arc) => arc,
            Err(error) => return Ok(Answer::Line(error.text())),
        };
        let speed = self.modal.feed;
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
        Ok(Answer::Nothing)
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
}
