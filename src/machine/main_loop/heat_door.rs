//! Heat, the door: orders of commands for heaters and fans, and their readings.

use super::MainLoop;
use crate::connectors::{FANS, HEATERS, Heater};
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::port::{Clock, Pend, Storage};
use crate::thermal::test_subject;
use crate::units::Celsius;

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// The temperature of each heater; the lowest possible value without a reading.
    pub fn measured(&self) -> [Celsius; HEATERS] {
        Heater::ALL.map(|heater| self.link.status().heat().measured(heater).unwrap_or(Celsius::MIN))
    }

    /// Sets the target of a heater; 0 is off. It is sent with the next orders.
    pub fn heat(&mut self, heater: Heater, target: Celsius) {
        self.heat_orders.heat(heater, target);
    }

    /// The heaters are in use.
    pub fn note_heaters_used(&mut self) {
        self.heaters_used = self.ports.clock.now();
    }

    /// Sets a fan to `speed`, of 65,535, when the planned moves are done. If the schedule is full, it waits as a move
    /// does that finds the look-ahead full: only as long as that changes no speed of a move.
    pub async fn set_fan(&mut self, fan: u8, speed: u16) -> Result<(), Interrupt> {
        self.close_line();
        self.fan_schedule.note_commanded(fan, speed);
        if !self.has_motion() && self.fan_schedule.is_empty() {
            self.heat_orders.set_fan(fan, speed);
            return Ok(());
        }
        while !self.fan_schedule.has_room() && !self.planner.lacks_moves() {
            self.policy.note_full();
            self.poll().await?;
        }
        self.fan_schedule.add(self.planner.planned().0, fan, speed);
        Ok(())
    }

    /// The speed of each fan that was commanded last, of 65,535.
    pub const fn commanded_fans(&self) -> [u16; FANS] {
        self.fan_schedule.commanded()
    }

    /// Heaters and fans go off, and no fan waits for its turn.
    pub fn switch_off_heat(&mut self) {
        self.heat_orders.switch_off();
        self.fan_schedule.clear();
        self.send_orders();
    }

    /// Find out how a heater behaves.
    pub const fn order_tuning(&mut self, heater: Heater, target: Celsius, cycles: u8) {
        self.heat_orders.tune(heater, target, cycles);
    }

    /// Whether all orders except fan speeds have left.
    pub const fn are_orders_gone(&self) -> bool {
        self.heat_orders.is_empty()
    }

    /// Heaters are about to be switched on: those that were not tested since the last update are tested first. Their
    /// targets wait in the thermal context.
    pub fn test_before_heating(&mut self) {
        let Some(image) = self.ports.storage.image() else { return };
        let subject = test_subject(&self.settings.thermal, image);
        if self.self_tests.is_needed(subject) {
            self.begin_self_test(subject, false);
        }
    }

    /// The user has asked for a self-test.
    pub fn begin_asked_test(&mut self) {
        if !self.self_tests.is_under_way() {
            let image = self.ports.storage.image().unwrap_or_default();
            self.begin_self_test(test_subject(&self.settings.thermal, image), true);
        }
    }

    fn begin_self_test(&mut self, subject: u32, is_asked: bool) {
        self.self_tests.begin(subject, is_asked);
        self.heat_orders.test();
        self.send_orders();
    }

    /// Whether a self-test is under way.
    pub const fn is_testing(&self) -> bool {
        self.self_tests.is_under_way()
    }

    /// The subject of the self-test passed before the start, if there is one.
    pub const fn know_passed_test(&mut self, passed: Option<u32>) {
        self.self_tests.know(passed);
    }

    /// Whether a passed self-test is to be stored: at rest, because flash may stop the processor while it is written.
    pub fn has_passed_test(&self) -> bool {
        self.self_tests.has_news() && !self.has_motion()
    }

    /// The subject of a passed test.
    pub fn take_passed_test(&mut self) -> Option<u32> {
        self.self_tests.take_news()
    }
}
