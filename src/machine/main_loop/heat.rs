//! Heat, a part of every turn: queued orders, faults, filament, the self-test, and heaters that are not in use. The
//! orders of commands are in [`heat_door`](super::heat_door).

use crate::connectors::Heater;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;
use crate::status::SelfTest;
use crate::units::{Celsius, Instant, TICKS_PER_SECOND};

/// Interval of the heat work, in ms: a quarter of a control period.
const TURN_MS: u32 = 5;

/// Interval of the look-ahead's filament report: a fraction of any heater's lag.
const AHEAD_MS: u32 = 50;

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// The part of every turn that handles heat. A fault ends the motion here and now.
    pub(super) fn tend_heat(&mut self, now: Instant) -> Result<(), Interrupt> {
        let faults = self.link.status().fault();
        if faults.is_set() && !self.limping.allows(faults.more()) {
            return Err(Interrupt::Halt);
        }
        if now < self.heat_due {
            return Ok(());
        }
        self.heat_due = now.after_ms(TURN_MS);
        self.follow_fans();
        self.heat_orders.note_motors(!self.drivers.powered().is_empty());
        self.watch_heaters(now);
        self.watch_idleness(now);
        self.send_orders();
        self.follow_self_test();
        if self.settings.thermal.heater(Heater::Hotend).is_fitted {
            self.report_filament(now);
        }
        Ok(())
    }

    /// Hands on the orders for which there is room.
    pub fn send_orders(&mut self) {
        let (heat, thermal) = (self.link.status().heat(), &self.settings.thermal);
        let (period, fitted) = (heat.periods(), |heater: &Heater| thermal.heater(*heater).is_fitted);
        let are_read = || Heater::ALL.into_iter().filter(fitted).all(|heater| heat.measured(heater).is_some());
        while self.orders.ready()
            && let Some(order) = self.heat_orders.next(thermal, period, are_read)
        {
            let _ = self.orders.enqueue(order);
        }
    }

    /// Fan speeds that are due among the moves.
    fn follow_fans(&mut self) {
        if self.fan_schedule.is_empty() {
            return;
        }
        let (planned, _) = self.planner.planned();
        self.fan_schedule.note_left(planned.wrapping_sub(self.planner.len() as u32), self.link.entries());
        while let Some((fan, speed)) = self.fan_schedule.take(self.link.entries_done()) {
            self.heat_orders.set_fan(fan, speed);
        }
    }

    /// The target of a heater; 0 is off.
    pub fn target_of(&self, heater: Heater) -> Celsius {
        self.heat_orders.target(heater, self.link.status().heat())
    }

    /// Switches heaters off that were not used for long enough, in every state of the Console. In a print they are
    /// heated again before it continues.
    fn watch_heaters(&mut self, now: Instant) {
        if self.has_motion() || !self.pauses.waiting().is_idle_for_heaters() {
            self.heaters_used = now;
        }
        let (idle_min, paused_min) = (self.settings.thermal.idle_min, self.settings.pause.heat_off_min);
        let minutes = u32::from(if self.job.is_paused() { idle_min.min(paused_min) } else { idle_min }).max(1);
        if now < self.heaters_used.after_ms(minutes * 60_000) {
            return;
        }
        self.heaters_used = now;
        let targets = Heater::ALL.map(|heater| self.target_of(heater));
        if targets.iter().all(|target| *target <= Celsius::ZERO) {
            return;
        }
        if self.job.is_under_way() {
            self.job.remember_targets(targets);
        }
        for heater in Heater::ALL {
            self.heat_orders.heat(heater, Celsius::ZERO);
        }
        self.hosts.notify_all(format_args!("echo:Heaters off after {minutes} minutes without use"));
    }

    /// Reports the heat that the filament takes from the hotend.
    fn report_filament(&mut self, now: Instant) {
        let [.., at] = self.real_steps();
        let heat = self.link.status().heat();
        heat.set_extruded_um(self.planner.filament_um(at) as u32);
        if now < self.ahead_due {
            return;
        }
        self.ahead_due = now.after_ms(AHEAD_MS);
        let thermal = &self.settings.thermal;
        let lag = u64::from(thermal.heater(Heater::Hotend).model.heater_lag.to_bits());
        let ticks = (lag * u64::from(TICKS_PER_SECOND)) >> 24;
        let ahead = self.planner.filament_within(ticks, at, self.link.left());
        let heat_of = |um: i64| {
            let bits = i128::from(um.max(0)) * i128::from(thermal.filament.to_bits()) / 1000;
            u32::try_from(bits).unwrap_or(u32::MAX)
        };
        self.link.status().heat().set_filament_ahead(ahead.map(heat_of));
    }

    /// Reports how a self-test ended. A failed test is a fault, which has its own report.
    fn follow_self_test(&mut self) {
        let heat = self.link.status().heat();
        let state = heat.self_test();
        let Some(end) = self.self_tests.follow(!self.heat_orders.is_test_waiting(), heat.periods(), state) else {
            return;
        };
        self.hosts.notify_all(match end {
            SelfTest::Passed => format_args!("echo:Self-test passed: each heater warms its own sensor"),
            SelfTest::PutOff => {
                format_args!(
                    "echo:Heaters are not tested since the update: one is at 50 C, was just on, cools or has no reading. \
                     Heating goes on, watched by all guards; the self-test comes before the first heating from the \
                     cold, or with SELF_TEST"
                )
            }
            SelfTest::None | SelfTest::Testing => format_args!("echo:Self-test ended"),
        });
    }
}
