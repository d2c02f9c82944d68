//! Orders for heaters and fans that wait for room in the queue.
//!
//! Only the latest of each target, each fan's speed and the settings counts. So nothing here is ever full, and no
//! command waits for the thermal context.

use super::baselines::Baselines;
use crate::connectors::{FANS, HEATERS, Heater};
use crate::settings::{ThermalSettings, sum};
use crate::status::Heat;
use crate::thermal::{Common, Order};
use crate::units::Celsius;

/// Control periods after which an order that left has been taken for certain.
const TAKEN: u32 = 2;

/// A target in transfer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Target {
    /// The thermal context knows it.
    Known,
    /// It has not left.
    Waits(Celsius),
    /// It left in this control period.
    Left(Celsius, u32),
}

/// Control periods after which every sensor that works has been read: 1 s. A median of readings takes a tenth of it.
const READINGS: u32 = 50;

/// The sums of the settings that the thermal context has. The settings themselves take ten times the memory.
struct Told {
    heaters: [u32; HEATERS],
    fans: [u32; FANS],
    common: u32,
}

impl Told {
    fn new(settings: &ThermalSettings) -> Self {
        let mut told = Self { heaters: [0; HEATERS], fans: [0; FANS], common: sum(&Common::of(settings)) };
        for heater in Heater::ALL {
            told.heaters[heater as usize] = sum(settings.heater(heater));
        }
        for (told, fan) in told.fans.iter_mut().zip(&settings.fans) {
            *told = sum(fan);
        }
        told
    }
}

/// Orders not yet sent to the thermal context.
pub(in crate::machine) struct HeatOrders {
    is_off: bool,
    targets: [Target; HEATERS],
    is_test_waiting: bool,
    /// A test that has left ends.
    is_test_over: bool,
    /// The control period since which the test waits for readings.
    test_since: Option<u32>,
    tuning: Option<(Heater, Celsius, u8)>,
    fans: [Option<u16>; FANS],
    motors: Option<bool>,
    are_motors_on: bool,
    told: Told,
    has_news: bool,
    baselines: Baselines,
}

impl HeatOrders {
    /// The thermal context begins with these settings.
    pub fn new(settings: &ThermalSettings) -> Self {
        Self {
            is_off: false,
            targets: [Target::Known; HEATERS],
            is_test_waiting: false,
            is_test_over: false,
            test_since: None,
            tuning: None,
            fans: [None; FANS],
            motors: None,
            are_motors_on: false,
            told: Told::new(settings),
            has_news: false,
            baselines: Baselines::new(),
        }
    }

    /// The baselines of heaters, which leave as orders.
    pub const fn baselines(&mut self) -> &mut Baselines {
        &mut self.baselines
    }

    /// Whether a baseline waits to be erased.
    pub fn has_baseline_to_erase(&self) -> bool {
        self.baselines.has_one_to_erase()
    }

    /// What is to be stored of them, once the thermal context has the latest settings.
    pub fn baseline_news(&self, heat: &Heat, settings: &ThermalSettings) -> Option<(Heater, u32, [u16; 2])> {
        if self.has_news { None } else { self.baselines.news(heat, settings) }
    }

    /// Sets the target of a heater; 0 is off.
    pub fn heat(&mut self, heater: Heater, target: Celsius) {
        self.targets[heater as usize] = Target::Waits(target);
    }

    /// Sets a fan to `speed`, of 65,535.
    pub fn set_fan(&mut self, fan: u8, speed: u16) {
        if let Some(place) = self.fans.get_mut(usize::from(fan)) {
            *place = Some(speed);
        }
    }

    /// Everything off.
    pub const fn switch_off(&mut self) {
        self.targets = [Target::Known; HEATERS];
        self.fans = [None; FANS];
        (self.tuning, self.is_test_waiting, self.test_since, self.is_off) = (None, false, None, true);
    }

    /// Find out whether each heater warms its own sensor, before anything that is ordered later.
    pub const fn test(&mut self) {
        self.is_test_waiting = true;
    }

    /// The test ends, or does not begin.
    pub const fn stop_test(&mut self) {
        self.is_test_over |= !core::mem::replace(&mut self.is_test_waiting, false);
        self.test_since = None;
    }

    /// Whether that order has not left.
    pub const fn is_test_waiting(&self) -> bool {
        self.is_test_waiting
    }

    /// Find out how a heater behaves.
    pub const fn tune(&mut self, heater: Heater, target: Celsius, cycles: u8) {
        self.tuning = Some((heater, target, cycles));
    }

    /// Whether any motor has power; sent when it changes.
    pub const fn note_motors(&mut self, are_on: bool) {
        if self.are_motors_on != are_on {
            self.are_motors_on = are_on;
            self.motors = Some(are_on);
        }
    }

    /// Settings may have changed.
    pub const fn note_settings(&mut self) {
        self.has_news = true;
    }

    /// The target of a heater, even if its order has not left yet.
    pub fn target(&self, heater: Heater, heat: &Heat) -> Celsius {
        match self.targets[heater as usize] {
            Target::Waits(target) => target,
            Target::Left(target, at) if heat.periods().wrapping_sub(at) < TAKEN => target,
            Target::Left(..) | Target::Known if self.is_off => Celsius::ZERO,
            Target::Left(..) | Target::Known => heat.target(heater),
        }
    }

    /// Whether everything has left.
    pub fn is_empty(&self) -> bool {
        let is_silent =
            !self.is_test_waiting && self.tuning.is_none() && self.motors.is_none() && !self.is_off && !self.has_news;
        let [a, b, c] = self.targets;
        is_silent
            && self.baselines.is_empty()
            && !matches!(a, Target::Waits(_))
            && !matches!(b, Target::Waits(_))
            && !matches!(c, Target::Waits(_))
    }

    /// The next order, which leaves in that control period. There is room for it. A self-test, and all orders after it,
    /// wait until all heaters have a reading (`are_read`): just after the start there is none yet.
    pub fn next(&mut self, settings: &ThermalSettings, period: u32, are_read: impl Fn() -> bool) -> Option<Order> {
        if core::mem::replace(&mut self.is_off, false) {
            for target in &mut self.targets {
                if *target == Target::Known {
                    *target = Target::Left(Celsius::ZERO, period);
                }
            }
            return Some(Order::Off);
        }
        if let Some(order) = self.next_settings(settings) {
            return Some(order);
        }
        if let Some(order) = self.baselines.next(settings) {
            return Some(order);
        }
        if core::mem::take(&mut self.is_test_over) {
            return Some(Order::StopTrials);
        }
        if self.is_test_waiting {
            let since = *self.test_since.get_or_insert(period);
            if !are_read() && period.wrapping_sub(since) < READINGS {
                return None;
            }
            (self.is_test_waiting, self.test_since) = (false, None);
            return Some(Order::SelfTest);
        }
        for heater in Heater::ALL {
            let place = &mut self.targets[heater as usize];
            if let Target::Waits(target) = *place {
                *place = Target::Left(target, period);
                return Some(Order::Target(heater, target));
            }
        }
        if let Some((heater, target, cycles)) = self.tuning.take() {
            self.targets[heater as usize] = Target::Left(target, period);
            return Some(Order::Tune(heater, target, cycles));
        }
        if let Some(are_on) = self.motors.take() {
            return Some(Order::Motors(are_on));
        }
        let mut fans = (0..).zip(&mut self.fans);
        fans.find_map(|(fan, speed)| speed.take().map(|speed| Order::Fan(fan, speed)))
    }

    /// The next of the settings that differ from the sent ones.
    fn next_settings(&mut self, settings: &ThermalSettings) -> Option<Order> {
        if !self.has_news {
            return None;
        }
        for heater in Heater::ALL {
            let wanted = settings.heater(heater);
            if is_news(&mut self.told.heaters[heater as usize], sum(wanted)) {
                self.baselines.follow_settings(heater);
                return Some(Order::Heater(heater, *wanted));
            }
        }
        for ((fan, told), wanted) in (0..).zip(&mut self.told.fans).zip(&settings.fans) {
            if is_news(told, sum(wanted)) {
                return Some(Order::FanSettings(fan, *wanted));
            }
        }
        self.has_news = false;
        let common = Common::of(settings);
        is_news(&mut self.told.common, sum(&common)).then_some(Order::Common(common))
    }
}

/// Whether settings have another sum than those that were told; they count as told from now on.
const fn is_news(told: &mut u32, wanted: u32) -> bool {
    core::mem::replace(told, wanted) != wanted
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::status::Status;
    use std::vec::Vec;

    fn all(orders: &mut HeatOrders, settings: &ThermalSettings) -> Vec<Order> {
        core::iter::from_fn(|| orders.next(settings, 0, || true)).collect()
    }

    #[test]
    fn a_self_test_and_what_follows_wait_a_while_for_readings() {
        let settings = ThermalSettings::prototype();
        let mut orders = HeatOrders::new(&settings);
        orders.test();
        orders.heat(Heater::Bed, Celsius::from_num(60));
        assert!(orders.next(&settings, 7, || false).is_none() && orders.is_test_waiting());
        assert!(matches!(orders.next(&settings, 8, || true), Some(Order::SelfTest)));
        assert!(matches!(orders.next(&settings, 8, || true), Some(Order::Target(Heater::Bed, _))));
        // A sensor that never answers does not hold it for ever, and all goes off at once.
        orders.test();
        assert!(
            orders.next(&settings, 9, || false).is_none()
                && orders.next(&settings, 9 + READINGS - 1, || false).is_none()
        );
        assert!(matches!(orders.next(&settings, 9 + READINGS, || false), Some(Order::SelfTest)));
        orders.test();
        orders.switch_off();
        assert!(matches!(orders.next(&settings, 90, || false), Some(Order::Off)));
    }

    #[test]
    fn the_latest_counts_and_off_comes_first() {
        let settings = ThermalSettings::prototype();
        let mut orders = HeatOrders::new(&settings);
        let celsius = Celsius::const_from_int;
        orders.heat(Heater::Hotend, celsius(200));
        orders.set_fan(0, 9);
        orders.switch_off();
        orders.heat(Heater::Bed, celsius(50));
        orders.heat(Heater::Bed, celsius(60));
        orders.set_fan(3, 1);
        orders.set_fan(3, 2);
        orders.note_motors(true);
        let expected = [Order::Off, Order::Target(Heater::Bed, celsius(60)), Order::Motors(true), Order::Fan(3, 2)];
        assert_eq!(all(&mut orders, &settings), expected);
        orders.note_motors(true);
        assert!(orders.is_empty());
        assert_eq!(all(&mut orders, &settings), []);
    }

    #[test]
    fn only_settings_that_changed_are_told() {
        let mut settings = ThermalSettings::prototype();
        let mut orders = HeatOrders::new(&settings);
        orders.note_settings();
        assert_eq!(all(&mut orders, &settings), []);
        settings.heaters.bed.is_fitted = true;
        settings.fan_run_on_s = 7;
        settings.fans[2].kick_ms = 5;
        orders.note_settings();
        let expected = [
            Order::Heater(Heater::Bed, settings.heaters.bed),
            Order::FanSettings(2, settings.fans[2]),
            Order::Common(Common::of(&settings)),
        ];
        assert_eq!(all(&mut orders, &settings), expected);
        assert_eq!(all(&mut orders, &settings), []);
    }

    #[test]
    fn a_target_on_its_way_is_the_target() {
        let status = Status::new();
        let settings = ThermalSettings::prototype();
        let mut orders = HeatOrders::new(&settings);
        orders.heat(Heater::Bed, Celsius::const_from_int(60));
        assert_eq!(orders.target(Heater::Bed, status.heat()), Celsius::from_num(60));
        assert!(orders.next(&settings, 0, || true).is_some());
        assert_eq!(orders.target(Heater::Bed, status.heat()), Celsius::from_num(60));
        status.heat().count_period();
        status.heat().count_period();
        assert_eq!(orders.target(Heater::Bed, status.heat()), Celsius::ZERO);
    }

    #[test]
    fn off_on_its_way_is_off() {
        let (status, settings) = (Status::new(), ThermalSettings::prototype());
        let mut orders = HeatOrders::new(&settings);
        status.heat().set_heater(Heater::Bed, None, Celsius::from_num(60), 0);
        orders.switch_off();
        orders.heat(Heater::Hotend, Celsius::from_num(200));
        let targets = |orders: &HeatOrders| [Heater::Bed, Heater::Hotend].map(|h| orders.target(h, status.heat()));
        let wanted = [Celsius::ZERO, Celsius::from_num(200)];
        assert_eq!(targets(&orders), wanted);
        assert!(matches!(orders.next(&settings, 0, || true), Some(Order::Off)));
        assert_eq!(targets(&orders), wanted);
    }
}
