//! Heaters and fans as commands order them: the orders on their way, the fans that wait for their moves, the
//! self-tests, and when heaters were last used.
//!
//! The heater control runs in another context and has the guards. This owner alone sends it orders. [`heat_poll`] is
//! its part of every turn.
//!
//! [`heat_poll`]: super::heat_poll

use crate::connectors::{FANS, HEATERS, Heater};
use crate::fault::{Cause, Fault};
use crate::machine::state::baselines::Baselines;
use crate::machine::state::fan_schedule::FanSchedule;
use crate::machine::state::heat_orders::HeatOrders;
use crate::machine::state::self_tests::SelfTests;
use crate::settings::ThermalSettings;
use crate::status::{Heat, HeatFigures, SelfTest, WITH_FIGURES};
use crate::thermal::{Orders, refusal, test_subject};
use crate::units::{Celsius, Instant, TICKS_PER_SECOND, part_of};

/// Interval of the heat work, in ms: a quarter of a control period.
const TURN_MS: u32 = 5;

/// Interval of the look-ahead's filament report: a fraction of any heater's lag.
const AHEAD_MS: u32 = 50;

/// The orders for heaters and fans, and their readings.
pub(in crate::machine) struct Heaters<'m> {
    status: &'m Heat,
    /// The queue to the heater control, and the orders still to be queued.
    queue: Orders<'m>,
    orders: HeatOrders,
    fans: FanSchedule,
    self_tests: SelfTests,
    /// Fans that stand still and were told, a bit each.
    still_fans: u8,
    /// Whether it was told that hotend and bed read low, or that their models are far off.
    are_low: [bool; 2],
    /// One of them has learned a baseline that may be new.
    has_learned: bool,
    /// The refusal of each heater that was told last. A target that is accepted forgets it.
    told: [Option<Cause>; HEATERS],
    /// When heaters were last used.
    used: Instant,
    /// When the heat work, and the filament report to the heater control, are due next.
    due: Instant,
    ahead_due: Instant,
}

impl<'m> Heaters<'m> {
    pub(super) fn new(status: &'m Heat, queue: Orders<'m>, thermal: &ThermalSettings, now: Instant) -> Self {
        Self {
            status,
            queue,
            orders: HeatOrders::new(thermal),
            fans: FanSchedule::new(),
            self_tests: SelfTests::new(),
            still_fans: 0,
            are_low: [false; 2],
            has_learned: false,
            told: [None; HEATERS],
            used: now,
            due: now,
            ahead_due: now,
        }
    }

    /// The temperature of each heater that has a reading.
    pub fn measured(&self) -> [Option<Celsius>; HEATERS] {
        Heater::ALL.map(|heater| self.status.measured(heater))
    }

    /// The temperature of a heater, if its sensor can be right.
    pub fn believed(&self, heater: Heater) -> Option<Celsius> {
        self.status.measured(heater).filter(|_| self.status.ailment(heater).is_none())
    }

    /// Whether a heater has no reading yet, and no known reason for that.
    pub fn is_unread(&self, heater: Heater, thermal: &ThermalSettings) -> bool {
        let heat = self.status;
        thermal.heater(heater).is_fitted && heat.measured(heater).is_none() && heat.ailment(heater).is_none()
    }

    /// Why a heater must not heat, if so: its reading is none, or one that cannot be right.
    pub fn refusal(&self, heater: Heater, thermal: &ThermalSettings) -> Option<Fault> {
        refusal(self.status, heater, thermal)
    }

    /// A refusal that was not told yet.
    pub fn follow_refusals(&mut self, thermal: &ThermalSettings) -> Option<Fault> {
        if !self.status.has_ailment() {
            return None;
        }
        Heater::ALL.into_iter().find_map(|heater| {
            let fault = refusal(self.status, heater, thermal)?;
            let told = &mut self.told[heater as usize];
            (told.replace(fault.cause) != Some(fault.cause)).then_some(fault)
        })
    }

    /// The target of a heater; 0 is off.
    pub fn target(&self, heater: Heater) -> Celsius {
        self.orders.target(heater, self.status)
    }

    /// Sets the target of a heater; 0 is off. It is sent with the next orders.
    pub fn set_target(&mut self, heater: Heater, target: Celsius) {
        self.orders.heat(heater, target);
        if target > Celsius::ZERO {
            self.told[heater as usize] = None;
        }
    }

    /// The heaters are in use.
    pub const fn note_used(&mut self, now: Instant) {
        self.used = now;
    }

    /// Heaters and fans go off, and no fan waits for its turn.
    pub fn switch_off(&mut self, thermal: &ThermalSettings) {
        self.drop_all();
        self.send_orders(thermal);
    }

    /// Finds out how a heater behaves.
    pub const fn tune(&mut self, heater: Heater, target: Celsius, cycles: u8) {
        self.orders.tune(heater, target, cycles);
    }

    /// Hands on the orders for which there is room.
    pub fn send_orders(&mut self, thermal: &ThermalSettings) {
        let heat = self.status;
        let (period, fitted) = (heat.periods(), |heater: &Heater| thermal.heater(*heater).is_fitted);
        let are_read = || Heater::ALL.into_iter().filter(fitted).all(|heater| heat.measured(heater).is_some());
        while self.queue.ready()
            && let Some(order) = self.orders.next(thermal, period, are_read)
        {
            let _ = self.queue.enqueue(order);
        }
    }

    /// Whether all orders except fan speeds have left.
    pub fn are_orders_gone(&self) -> bool {
        self.orders.is_empty()
    }

    /// The speed of each fan that was commanded last, of 65,535.
    pub const fn commanded_fans(&self) -> [u16; FANS] {
        self.fans.commanded()
    }

    /// Heaters are about to be switched on: those that were not tested since the last update, with this `image`, are
    /// tested first. Their targets wait in the thermal context.
    pub fn test_before_heating(&mut self, thermal: &ThermalSettings, image: Option<u32>) {
        let Some(image) = image else { return };
        let subject = test_subject(thermal, image);
        if self.self_tests.is_needed(subject) {
            self.begin_test(subject, false, thermal);
        }
    }

    /// The user has asked for a self-test.
    pub fn begin_asked_test(&mut self, thermal: &ThermalSettings, image: Option<u32>) {
        if !self.self_tests.is_under_way() {
            self.begin_test(test_subject(thermal, image.unwrap_or_default()), true, thermal);
        }
    }

    fn begin_test(&mut self, subject: u32, is_asked: bool, thermal: &ThermalSettings) {
        self.self_tests.begin(subject, is_asked);
        self.orders.test();
        self.send_orders(thermal);
    }

    /// The self-test that is under way ends without a result; heaters get their targets. Whether one was.
    pub const fn stop_test(&mut self) -> bool {
        let is_early = self.self_tests.stop();
        if is_early {
            self.orders.stop_test();
        }
        is_early
    }

    /// A fan that has come to stand still though it is driven, once; the others are told in the next turns.
    pub fn follow_still_fans(&mut self) -> Option<u32> {
        let still = self.status.still_fans();
        self.still_fans &= still;
        let fan = (still & !self.still_fans).trailing_zeros();
        self.still_fans |= 1_u8.checked_shl(fan)?;
        Some(fan)
    }

    /// Whether a self-test is under way.
    pub const fn is_testing(&self) -> bool {
        self.self_tests.is_under_way()
    }

    /// The subject of the self-test passed before the start, if there is one.
    pub const fn know_passed_test(&mut self, passed: Option<u32>) {
        self.self_tests.know(passed);
    }

    /// Whether a passed self-test is not stored yet.
    pub const fn has_passed_test(&self) -> bool {
        self.self_tests.has_news()
    }

    /// The subject of a passed test.
    pub fn take_passed_test(&mut self) -> Option<u32> {
        self.self_tests.take_news()
    }

    /// The baselines of hotend and bed.
    pub const fn baselines(&mut self) -> &mut Baselines {
        self.orders.baselines()
    }

    /// Whether there may be a baseline to store, or to erase: asked in each turn of the Console.
    pub fn may_have_baseline_news(&self) -> bool {
        self.has_learned || self.orders.has_baseline_to_erase()
    }

    /// A baseline that is to be stored, or erased: the heater, its model's sum, and the figures.
    pub fn baseline_news(&mut self, thermal: &ThermalSettings) -> Option<(Heater, u32, [u16; 2])> {
        self.has_learned = false;
        self.orders.baseline_news(self.status, thermal)
    }

    /// A heater that has come to read low, or whose model is far off, once.
    pub fn follow_low_readings(&mut self) -> Option<(Heater, HeatFigures)> {
        WITH_FIGURES.into_iter().zip(&mut self.are_low).find_map(|(heater, told)| {
            let figures = self.status.figures(heater);
            self.has_learned |= figures.has_learned();
            let is_low = figures.is_low || figures.is_far_off();
            let was_low = core::mem::replace(told, is_low);
            (is_low && !was_low).then_some((heater, figures))
        })
    }

    /// Settings of heaters or fans may have changed.
    pub(super) const fn note_settings(&mut self) {
        self.orders.note_settings();
    }

    /// Motors have power, or none has.
    pub(super) const fn note_motors(&mut self, are_on: bool) {
        self.orders.note_motors(are_on);
    }

    /// Heaters and fans are to go off, and no fan waits for its turn.
    pub(super) fn drop_all(&mut self) {
        self.orders.switch_off();
        self.fans.clear();
    }

    /// Whether the heat work is due.
    pub(super) fn is_due(&mut self, now: Instant) -> bool {
        let is_due = now >= self.due;
        if is_due {
            self.due = now.after_ms(TURN_MS);
        }
        is_due
    }

    /// Takes a fan's speed, of 65,535. Where nothing moves and no fan waits, it counts at once; else the caller has it
    /// wait for its move, and this is false.
    pub(super) fn set_fan(&mut self, fan: u8, speed: u16, has_motion: bool) -> bool {
        self.fans.note_commanded(fan, speed);
        let is_now = !has_motion && self.fans.is_empty();
        if is_now {
            self.orders.set_fan(fan, speed);
        }
        is_now
    }

    /// Whether another fan may wait for its move.
    pub(super) fn has_room_for_fan(&self) -> bool {
        self.fans.has_room()
    }

    /// A fan takes its speed when so many planned moves are done.
    pub(super) fn set_fan_after(&mut self, moves: u32, fan: u8, speed: u16) {
        self.fans.add(moves, fan, speed);
    }

    /// Whether a fan waits for its move.
    pub(super) fn has_fans_waiting(&self) -> bool {
        !self.fans.is_empty()
    }

    /// Fans take their speeds when so many planned moves have left the look-ahead, in `entries` of the queue, of which
    /// `done` are made.
    pub(super) fn follow_fans(&mut self, moves: u32, entries: u32, done: u32) {
        self.fans.note_left(moves, entries);
        while let Some((fan, speed)) = self.fans.take(done) {
            self.orders.set_fan(fan, speed);
        }
    }

    /// Switches heaters off that were not used for so many minutes, and returns their targets if one was on.
    pub(super) fn switch_off_unused(&mut self, now: Instant, minutes: u32) -> Option<[Celsius; HEATERS]> {
        if now < self.used.after_ms(minutes * 60_000) {
            return None;
        }
        self.used = now;
        let targets = Heater::ALL.map(|heater| self.target(heater));
        if targets.iter().all(|target| *target <= Celsius::ZERO) {
            return None;
        }
        for heater in Heater::ALL {
            self.orders.heat(heater, Celsius::ZERO);
        }
        Some(targets)
    }

    /// Reports the filament that has left the hotend. Returns the ticks within which the filament to come counts, if
    /// its report is due.
    pub(super) fn note_extruded(&mut self, um: u32, thermal: &ThermalSettings, now: Instant) -> Option<u64> {
        self.status.set_extruded_um(um);
        if now < self.ahead_due {
            return None;
        }
        self.ahead_due = now.after_ms(AHEAD_MS);
        let lag = u64::from(thermal.heater(Heater::Hotend).model.heater_lag.to_bits());
        Some((lag * u64::from(TICKS_PER_SECOND)) >> 24)
    }

    /// Reports the heat that the filament to come takes from the hotend.
    pub(super) fn note_ahead(&self, um: [i64; 2], thermal: &ThermalSettings) {
        let heat_of = |um: i64| {
            let bits = part_of(um.max(0), thermal.filament.to_bits().into(), 1000);
            u32::try_from(bits).unwrap_or(u32::MAX)
        };
        self.status.set_filament_ahead(um.map(heat_of));
    }

    /// How a self-test ended, once.
    pub(super) fn follow_self_test(&mut self) -> Option<SelfTest> {
        self.self_tests.follow(!self.orders.is_test_waiting(), self.status.periods(), self.status.self_test())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::status::Status;
    use crate::thermal::{Order, OrderQueue};
    use std::vec::Vec;

    fn change_all(settings: &mut ThermalSettings) {
        for heater in Heater::ALL {
            settings.heater_mut(heater).most -= Celsius::ONE;
        }
        settings.fans.iter_mut().for_each(|fan| fan.kick_ms += 1);
        settings.fan_run_on_s += 1;
    }

    #[test]
    fn orders_that_find_the_queue_full_leave_in_the_next_periods() {
        let mut settings = ThermalSettings::prototype();
        let (mut queue, status) = (OrderQueue::new(), Status::new());
        let (orders_in, mut orders) = queue.split();
        let mut heat = Heaters::new(status.heat(), orders_in, &settings, Instant::default());
        // The four turns of a control period, and the orders that it takes.
        let mut period = |heat: &mut Heaters<'_>, settings: &ThermalSettings| {
            (0..4).for_each(|_| heat.send_orders(settings));
            core::iter::from_fn(|| orders.dequeue()).collect::<Vec<_>>()
        };
        change_all(&mut settings);
        heat.note_settings();
        heat.set_target(Heater::Bed, Celsius::from_num(60));
        let taken = [period(&mut heat, &settings), period(&mut heat, &settings)];
        assert!(heat.are_orders_gone() && period(&mut heat, &settings).is_empty());
        let taken = taken.concat();
        assert_eq!(taken.len(), HEATERS + FANS + 2);
        assert_eq!(taken.last(), Some(&Order::Target(Heater::Bed, Celsius::from_num(60))), "after its settings");
        // Off waits for a period at most, and comes first.
        change_all(&mut settings);
        heat.note_settings();
        heat.send_orders(&settings);
        heat.switch_off(&settings);
        assert!(!period(&mut heat, &settings).contains(&Order::Off));
        assert_eq!(period(&mut heat, &settings).first(), Some(&Order::Off));
    }
}
