//! The self-test among the other work of thermal control: heaters are the test's, and get their targets back.

use super::super::guard::Alarm;
use super::super::heater::HeaterLoop;
use super::super::self_test::{End, Readings, SelfTest};
use super::ThermalControl;
use crate::connectors::Heater;
use crate::port::{ThermalPort, Wake};
use crate::status;
use crate::units::Celsius;

impl<H: ThermalPort, W: Wake> ThermalControl<'_, H, W> {
    /// Begins one, unless a heater is warming or one is under way.
    pub(super) fn begin_self_test(&mut self) {
        if self.self_test.is_some() {
            return;
        }
        let held = self.heaters.each_ref().map(HeaterLoop::target);
        let settings = self.heaters.each_ref().map(HeaterLoop::settings);
        // The reading of a heater that was on a moment ago still rises by itself.
        let is_warming = self.heaters.iter().any(HeaterLoop::is_warming);
        self.self_test = SelfTest::new(settings, &self.readings(), held).filter(|_| !is_warming);
        let is_begun = self.self_test.is_some();
        if is_begun {
            self.heaters.iter_mut().for_each(|heater| heater.set_target(Celsius::ZERO));
        }
        let state = if is_begun { status::SelfTest::Testing } else { status::SelfTest::PutOff };
        self.status.heat().set_self_test(state);
    }

    /// One control period of the current self-test.
    pub(super) fn test(&mut self) -> Result<(), (Heater, Alarm)> {
        if self.self_test.is_none() {
            return Ok(());
        }
        let readings = self.readings();
        let settings = self.heaters.each_ref().map(HeaterLoop::settings);
        let end = self.self_test.as_mut().and_then(|test| test.period(settings, &readings));
        if let Some(End::Failed(heater, alarm)) = end {
            self.stop_self_test();
            return Err((heater, alarm));
        }
        if let Some(end) = end {
            self.end_self_test(end);
        } else {
            let powered = self.self_test.as_ref().and_then(SelfTest::powered);
            Heater::ALL.into_iter().for_each(|heater| self.heaters[heater as usize].pulse(powered == Some(heater)));
        }
        Ok(())
    }

    /// Ends the current self-test; heaters get their held targets.
    pub(super) fn end_self_test(&mut self, end: End) {
        let Some(test) = self.self_test.take() else { return };
        for (heater, target) in self.heaters.iter_mut().zip(test.held()) {
            heater.pulse(false);
            heater.set_target(target);
        }
        let is_passed = end == End::Passed;
        let state = if is_passed { status::SelfTest::Passed } else { status::SelfTest::PutOff };
        self.status.heat().set_self_test(state);
    }

    /// The reading of each heater's sensor, if it can be right.
    fn readings(&self) -> Readings {
        self.heaters.each_ref().map(|heater| heater.believed().filter(|_| heater.settings().is_fitted))
    }

    /// A heater that is refused loses its held target for good, as it loses its target outside of a test.
    pub(super) const fn drop_held(&mut self, heater: Heater) {
        if let Some(test) = &mut self.self_test {
            test.hold(heater, Celsius::ZERO);
        }
    }

    /// Ends the current self-test and all heating.
    pub(super) fn stop_self_test(&mut self) {
        if self.self_test.take().is_some() {
            self.heaters.iter_mut().for_each(|heater| heater.pulse(false));
            self.status.heat().set_self_test(status::SelfTest::None);
        }
    }
}
