//! Heat, a part of every turn: queued orders, faults, filament, the self-test, and heaters that are not in use.

use crate::connectors::Heater;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::reports::heat_report::{LowReading, Ratio8};
use crate::port::Wake;
use crate::settings::Settings;
use crate::status::{HeatFigures, SelfTest, WITH_FIGURES};
use crate::thermal::is_alike;
use crate::units::Instant;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// The part of every turn that handles heat. A fault ends the motion here and now.
    pub(super) fn tend_heat(&mut self, now: Instant) -> Result<(), Interrupt> {
        let faults = self.status.fault();
        if faults.is_set() && !self.limping.allows(faults.more()) {
            return Err(Interrupt::Halt);
        }
        if !self.heat.is_due(now) {
            return Ok(());
        }
        if self.heat.has_fans_waiting() {
            let (queued, done) = self.motion.work();
            self.heat.follow_fans(self.motion.moves_left(), queued, done);
        }
        let rests = self.settings.probe.bed_heater_off && self.probing.is_touching();
        self.status.heat().set_bed_rests(rests);
        let (s, made) = (&*self.settings, self.settings.defaults());
        let ends = |s: &Settings| s.axes.map(|axis| (axis.steps_per_mm, axis.length));
        self.status.set_free(!s.soft_endstops || ends(s) != ends(made) || s.axis_min != made.axis_min);
        self.heat.note_motors(!self.power.powered().is_empty());
        self.watch_heaters(now);
        self.watch_idleness(now);
        self.heat.send_orders(&self.settings.thermal);
        self.follow_self_test();
        if let Some(fault) = self.heat.follow_refusals(&self.settings.thermal) {
            self.hosts.notify_all(text!("echo:heating is refused, {fault}"));
        }
        if let Some(fan) = self.heat.follow_still_fans() {
            self.hosts.notify_all(text!("echo:fan{fan} stands still: free it, or plug it in"));
        }
        if let Some((heater, figures)) = self.heat.follow_low_readings() {
            self.tell_low_reading(heater, figures);
        }
        if self.settings.thermal.heater(Heater::Hotend).is_fitted {
            self.report_filament(now);
        }
        Ok(())
    }

    /// Tells that a heater takes more power and moves less than it did. If hotend and bed do so alike, the supply is
    /// weak.
    fn tell_low_reading(&mut self, heater: Heater, figures: HeatFigures) {
        let heat = self.status.heat();
        let others = WITH_FIGURES.into_iter().filter(|other| *other != heater);
        let other = others.map(|other| heat.figures(other).low()).next().unwrap_or_default();
        let (name, low) = (heater.name(), figures.low());
        let measured = heat.measured(heater).unwrap_or_default();
        if figures.is_far_off() {
            let number = ["0", "-1"][usize::from(heater == Heater::Bed)];
            self.hosts.notify_all(text!("echo:{name}: its model is far off, M303 E{number} U1 finds it"));
        } else if is_alike(low, other) {
            let times = Ratio8(low);
            self.hosts.notify_all(text!("echo:hotend and bed take {times} times their power: measure the supply"));
        } else {
            let shown = LowReading { name, figures, measured };
            self.hosts.notify_all(text!("echo:{shown}; see that sensor and heater sit firmly, and measure the supply"));
        }
    }

    /// Switches heaters off that were not used for long enough, in every state of the Console. In a print they are
    /// heated again before it continues.
    fn watch_heaters(&mut self, now: Instant) {
        if self.motion.has_motion() || !self.pauses.waiting().is_idle_for_heaters() {
            self.heat.note_used(now);
        }
        let (idle_min, paused_min) = (self.settings.thermal.idle_min, self.settings.pause.heat_off_min);
        let minutes = u32::from(if self.job.is_paused() { idle_min.min(paused_min) } else { idle_min }).max(1);
        let Some(targets) = self.heat.switch_off_unused(now, minutes) else { return };
        if self.job.is_under_way() {
            self.job.remember_targets(targets);
        }
        self.hosts.notify_all(text!("echo:Heaters off after {minutes} minutes without use"));
    }

    /// Reports the heat that the filament takes from the hotend.
    fn report_filament(&mut self, now: Instant) {
        let [.., at] = self.motion.real_steps();
        let thermal = &self.settings.thermal;
        if let Some(ticks) = self.heat.note_extruded(self.motion.extruded_um(at) as u32, thermal, now) {
            self.heat.note_ahead(self.motion.filament_ahead(ticks, at), thermal);
        }
    }

    /// Reports how a self-test ended. A failed test is a fault, which has its own report.
    fn follow_self_test(&mut self) {
        let Some(end) = self.heat.follow_self_test() else { return };
        self.hosts.notify_all(match end {
            SelfTest::Passed => text!("echo:Self-test passed: each heater warms its own sensor"),
            SelfTest::PutOff => {
                text!(
                    "echo:Heaters are not tested since the update, for one is warm or has no reading that can be \
                     right. Heating goes on, watched by all guards; the self-test comes before the first heating \
                     from the cold, or with SELF_TEST"
                )
            }
            // The command that has switched everything off tells it.
            SelfTest::None | SelfTest::Testing => return,
        });
    }

    /// Sets a fan to `speed`, of 65,535, when the planned moves are done. If too many fans wait already, it waits as a
    /// move does that finds the look-ahead full: only as long as that changes no speed of a move.
    pub async fn set_fan(&mut self, fan: u8, speed: u16) -> Result<(), Interrupt> {
        self.motion.close_line(&self.settings);
        if self.heat.set_fan(fan, speed, self.motion.has_motion()) {
            return Ok(());
        }
        while !self.heat.has_room_for_fan() && !self.motion.lacks_moves() {
            self.motion.note_full();
            self.poll().await?;
        }
        self.heat.set_fan_after(self.motion.planned_moves(), fan, speed);
        Ok(())
    }
}
