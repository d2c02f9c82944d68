//! Commands that take time, in one match without a wildcard: a new one does not compile before it is decided what it does.
//!
//! They are awaited: motion, power, storage, drivers, questions to the user. Meanwhile the Console's crank goes on turning.

use super::drivers::{mode_words, set_drivers};
use super::moves::ArcWords;
use super::settings::set::{Resolved, set_resolution};
use super::shaping::{NO_SUCH_KIND, ShaperWords, set_advance};
use crate::connectors::Heater;
use crate::driver::Job;
use crate::gcode::{AxisFlags, AxisWords, MachineRecord, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::driver_value::DriverValue;
use crate::machine::answers::setting::Setting;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::port::{Motor, MotorSet, Pend};

/// A command that takes time.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Blocking<'c> {
    /// G0, G1.
    Line { to: &'c AxisWords, feed: Option<Number> },
    /// G0, G1 with C.
    Circulate { to: &'c AxisWords, belt: Number, feed: Option<Number> },
    /// G2, G3.
    Arc(ArcWords<'c>),
    /// G4.
    Dwell { ms: u32 },
    /// G10.
    Retract,
    /// G11.
    Recover,
    /// G28.
    Home(AxisFlags),
    /// M400.
    Finish,
    /// M112.
    EmergencyStop,
    /// A condition that other lines depend on.
    Conditional,
    /// M17.
    EnableMotors(AxisFlags),
    /// M18, M84.
    DisableMotors(AxisFlags),
    /// M915.
    AlignBelt { diagnoses: bool, repairs: bool },
    /// M0, M1, M600, M601.
    AwaitUser { ms: u32, filament: bool },
    /// M25.
    Pause,
    /// M24, M602.
    Resume,
    /// M500.
    SaveSettings,
    /// M501.
    LoadSettings,
    /// M502.
    DefaultSettings,
    /// M504.
    CheckStorage,
    /// M92.
    StepsPerMm(&'c AxisWords),
    /// M593.
    Shaper(ShaperWords),
    /// M900, M572.
    Advance { time: Option<Number>, window: Option<Number> },
    /// M569.
    Stealth { on: Option<bool>, axes: AxisFlags },
    /// M220, with a percentage that is in range.
    FeedPercent(u16),
    /// M109, M190, M191.
    Heat { heater: Heater, tool: u8, target: Option<Number>, cools: bool },
    /// M116.
    AwaitHeaters,
    /// M106, M107.
    Fan { fan: u8, speed: Number },
    /// M303.
    Tune { heater: Option<Heater>, target: Option<Number>, cycles: Option<Number>, applies: bool },
    /// SELF_TEST.
    SelfTest,
    /// MACHINE_GET, MACHINE_PUT, MACHINE_STORE.
    MachineRecord(MachineRecord<'c>),
    /// M119.
    ReportEndstops,
    /// M122.
    Diagnose,
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Carries out a command that takes time, and returns what there is to say before its `ok`.
    pub(in crate::machine) async fn carry_out_blocking(
        &mut self,
        command: Blocking<'_>,
    ) -> Result<Answer<'static>, Interrupt> {
        let z_speed = self.settings.axes.z.max_speed;
        match command {
            Blocking::Line { to, feed } => return self.line(to, feed).await,
            Blocking::Circulate { to, belt, feed } => return self.circulate(to, belt, feed).await,
            Blocking::Arc(words) => return self.arc(&words).await,
            Blocking::Dwell { ms } => self.dwell(ms).await?,
            Blocking::Retract => self.retract(self.retraction.moves_away(z_speed)).await?,
            Blocking::Recover => self.retract(self.retraction.moves_back(z_speed)).await?,
            Blocking::Home(flags) => self.home(flags).await?,
            Blocking::Finish => self.finish().await?,
            Blocking::EmergencyStop => return Err(Interrupt::Halt),
            Blocking::Conditional => {
                self.tell(Answer::Line(
                    "Error:which lines run depends on this one, and this firmware would run them all",
                ))
                .await?;
                return Err(Interrupt::Halt);
            }
            Blocking::EnableMotors(flags) => self.power(self.motors_of(flags)).await?,
            Blocking::DisableMotors(flags) => {
                self.finish().await?;
                self.unpower(self.motors_of(flags));
                self.notices.renew_for_position();
            }
            Blocking::AwaitUser { ms, filament } => self.await_user(ms, filament).await?,
            Blocking::Pause => self.pause().await?,
            Blocking::Resume => self.resume().await?,
            Blocking::SaveSettings => return self.save_settings().await.map(Answer::Storage),
            Blocking::LoadSettings => return self.load_settings().await.map(Answer::Storage),
            Blocking::DefaultSettings => return self.reset_settings().await.map(Answer::Storage),
            Blocking::CheckStorage => return self.check_storage().await.map(Answer::Storage),
            Blocking::StepsPerMm(words) => return self.change_resolution(words).await,
            Blocking::Shaper(words) => return self.change_shapers(&words).await,
            Blocking::Advance { time, window } => return self.change_advance(time, window).await,
            Blocking::Stealth { on, axes } => return self.change_mode(on, axes).await,
            Blocking::FeedPercent(percent) => self.override_feed(percent).await?,
            Blocking::Heat { heater, tool, target, cools } => {
                return self.heat_and_wait(heater, tool, target, cools).await;
            }
            Blocking::AwaitHeaters => return self.await_heaters().await,
            Blocking::Fan { fan, speed } => return self.set_fan(fan, speed).await,
            Blocking::Tune { heater, target, cycles, applies } => {
                return self.tune(heater, target, cycles, applies).await;
            }
            Blocking::SelfTest => return self.test_heaters().await,
            Blocking::MachineRecord(order) => return self.exchange_machine(order).await,
            Blocking::AlignBelt { diagnoses, repairs } => {
                return if diagnoses || repairs { self.examine_belt(repairs).await } else { self.align_belt().await };
            }
            Blocking::ReportEndstops => {
                self.link.look_at_endstops();
                self.turn().await?;
                return Ok(Answer::Endstops(self.link.status().endstops()));
            }
            Blocking::Diagnose => {
                self.report_drivers().await?;
                self.report_belt().await?;
                self.tell(Answer::Overload).await?;
                return Ok(Answer::Heat);
            }
        }
        Ok(Answer::Nothing)
    }

    /// The motors that move the named axes; all if none is named.
    fn motors_of(&self, flags: AxisFlags) -> MotorSet {
        let AxisFlags { x, y, z, e, .. } = flags;
        let groups = self.real.groups();
        let mechanism = groups.mechanism();
        let named = [x, y, z, e].into_iter().enumerate().filter(|(_, named)| *named);
        let set = named.fold(MotorSet::NONE, |set, (axis, _)| set.with(mechanism.motors_of(axis)));
        if set.is_empty() { groups.fitted() } else { set }
    }

    /// M92. The machine comes to rest first: a step must not change its size under way.
    async fn change_resolution(&mut self, words: &AxisWords) -> Result<Answer<'static>, Interrupt> {
        if *words == AxisWords::default() {
            return Ok(Answer::Setting(Setting::Resolutions));
        }
        let mut wanted = *self.settings;
        match set_resolution(words, &mut wanted, &mut self.clamps) {
            Ok(Resolved::Resolutions) => {}
            Ok(Resolved::LoweredSpeeds) => self.tell(Answer::LoweredSpeeds).await?,
            Err(axes) => {
                self.clamps.clear();
                return Ok(Answer::SharedMotors(axes));
            }
        }
        self.finish().await?;
        self.use_settings(wanted).await?;
        Ok(Answer::Nothing)
    }

    /// M593. Motion comes to rest before a shaper changes.
    async fn change_shapers(&mut self, words: &ShaperWords) -> Result<Answer<'static>, Interrupt> {
        if words.are_a_question() {
            return Ok(Answer::Setting(Setting::Shapers));
        }
        let mut wanted = *self.settings;
        let Some(shapers) = words.change(wanted.shapers, &mut self.clamps) else {
            return Ok(Answer::Line(NO_SUCH_KIND));
        };
        wanted.shapers = shapers;
        if wanted.shapers != self.settings.shapers {
            self.finish().await?;
            self.use_settings(wanted).await?;
        }
        Ok(Answer::Nothing)
    }

    /// M900, M572. The advance counts for the following moves. Motion comes to rest only before its window changes, and
    /// before the generator follows it for the first time: all axes are later from then on.
    async fn change_advance(
        &mut self,
        time: Option<Number>,
        window: Option<Number>,
    ) -> Result<Answer<'static>, Interrupt> {
        if time.or(window).is_none() {
            return Ok(Answer::Advance);
        }
        let mut wanted = *self.settings;
        set_advance(time, window, &mut wanted, &mut self.clamps);
        if self.advance_in_use.needs_rest(&self.settings, &wanted) {
            self.finish().await?;
            self.use_settings(wanted).await?;
        } else {
            *self.settings = wanted;
        }
        Ok(Answer::Nothing)
    }

    /// M569. The motion rests first: a motor that changes its mode at speed may lose steps.
    async fn change_mode(&mut self, stealth: Option<bool>, axes: AxisFlags) -> Result<Answer<'static>, Interrupt> {
        let mut words = AxisWords::default();
        if let Some(stealth) = stealth.filter(|_| !self.drivers.lines().is_empty()) {
            self.finish().await?;
            words = mode_words(stealth, axes);
        }
        let Self { settings, drivers, modal, clamps, .. } = self;
        let answer = set_drivers(DriverValue::Mode, &words, settings, drivers, modal, clamps);
        self.until(|c| c.drivers.is_configured()).await?;
        Ok(answer)
    }

    /// M122, the part of the drivers.
    async fn report_drivers(&mut self) -> Result<(), Interrupt> {
        let fitted = self.real.groups().fitted();
        for motor in Motor::ALL.into_iter().filter(|motor| fitted.has(*motor)) {
            let has_uart = self.drivers.lines().has(motor);
            let reading = if has_uart { Some(self.ask_driver(Job::Read, motor).await?) } else { None };
            self.tell(Answer::Driver(motor, reading)).await?;
        }
        Ok(())
    }
}
