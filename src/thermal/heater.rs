//! One heater: its sensor, its controller, its guards.

use super::fixed_point::{duty, share};
use super::guard::{Alarm, Numbers, Window, has_own_model};
use super::heater_guards::{Aim, HeaterGuards, Watched};
use super::lag_watch::{LagNumbers, LagWatch};
use super::observer::{Coefficients, Observer, Past};
use super::pid::Pid;
use super::predictive::{self, Ahead};
use super::sensor::{Contact, Curve, Filter};
use super::switching::Switching;
use super::tune::Tune;
use crate::connectors::Heater;
use crate::fault::Cause;
use crate::settings::{Control, HeaterSettings};
use crate::status::HeatFigures;
use crate::units::{Celsius, Power, Ratio};
use fixed::types::I8F24;

/// The surroundings of a heater in a control period.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// The part fan's duty, of 1.
    pub fan: Ratio,
    /// Heat that the filament takes away for each K, in W/K.
    pub filament: I8F24,
    /// The look-ahead's knowledge of the filament.
    pub ahead: Ahead,
    /// Temperature up to which another heater may warm it: a bed warms its chamber, and a hotend that is off.
    pub warmed_to: Celsius,
    /// It gets no power for now: a touch of the probe is awaited, or its second sensor is at its limit.
    pub rests: bool,
    /// Cold, it reads otherwise than the other cold heater.
    pub differs: bool,
    /// Why its second sensor refuses heat.
    pub refused: Option<Cause>,
    /// How many times too low the bed reads, by its heat; 0 is not known.
    pub other: u16,
}

/// The ceiling: a heater gets no power this far above its target, whatever the model or the gains say.
const CEILING: Celsius = Celsius::const_from_int(10);

/// One heater.
pub struct HeaterLoop {
    heater: Heater,
    settings: HeaterSettings,
    /// Its model is not the one that any heater of its kind begins with.
    has_own_model: bool,
    curve: Curve,
    filter: Filter,
    window: Window,
    /// Present after the first reading.
    observer: Option<Observer>,
    lag_watch: LagWatch,
    pid: Pid,
    switching: Switching,
    guards: HeaterGuards,
    target: Celsius,
    measured: Option<Celsius>,
    /// The output of the last period, of 65,535, and whether it could have been more and less.
    given: u16,
    is_free: bool,
    /// The requested output, before switching.
    wanted: u16,
    /// A tuning sets its duty, until it goes off.
    is_tuned: bool,
    /// Full power whatever the target, for a self-test.
    is_pulsed: bool,
    /// Why it must not heat: its reading is none, or beyond its window. It has no target then.
    ailment: Option<Cause>,
}

impl HeaterLoop {
    /// A heater that is off.
    #[must_use]
    pub fn new(heater: Heater, settings: HeaterSettings) -> Self {
        Self {
            heater,
            settings,
            has_own_model: has_own_model(heater, &settings),
            curve: Curve::new(settings.thermistor),
            filter: Filter::new(),
            window: Window::new(),
            observer: None,
            lag_watch: LagWatch::new(&settings.model),
            pid: Pid::new(settings.pid),
            switching: Switching::new(settings.period_ms),
            guards: HeaterGuards::new(heater, &settings),
            target: Celsius::ZERO,
            measured: None,
            given: 0,
            is_free: true,
            wanted: 0,
            is_tuned: false,
            is_pulsed: false,
            ailment: None,
        }
    }

    /// Takes other settings. A heater with another output or sensor goes off.
    pub fn configure(&mut self, settings: HeaterSettings) {
        let before = core::mem::replace(&mut self.settings, settings);
        let place = |s: &HeaterSettings| (s.is_fitted, s.output, s.sensor, s.thermistor);
        if place(&before) != place(&settings) {
            *self = Self::new(self.heater, settings);
            return;
        }
        self.set_target(self.target);
        if before.pid != settings.pid {
            self.pid = Pid::new(settings.pid);
        }
        if before.period_ms != settings.period_ms {
            self.switching = Switching::new(settings.period_ms);
        }
        if before != settings {
            self.has_own_model = has_own_model(self.heater, &settings);
            self.observer = None;
            self.lag_watch = LagWatch::new(&settings.model);
            self.guards.configure(&settings);
        }
    }

    /// Its settings.
    pub const fn settings(&self) -> &HeaterSettings {
        &self.settings
    }

    /// Sets the target; 0 or less is off.
    pub fn set_target(&mut self, target: Celsius) {
        let target = self.legal(target);
        if target == Celsius::ZERO {
            self.pid.rest();
            self.is_tuned = false;
        }
        self.target = target;
    }

    /// The nearest legal target: within the limits, and none while heating is refused.
    pub fn legal(&self, target: Celsius) -> Celsius {
        if self.ailment.is_some() { Celsius::ZERO } else { target.min(self.settings.most).max(Celsius::ZERO) }
    }

    /// The target; 0 is off.
    pub const fn target(&self) -> Celsius {
        self.target
    }

    /// The temperature, after the first reading: as hosts see it.
    pub const fn measured(&self) -> Option<Celsius> {
        self.measured
    }

    /// The temperature, unless its sensor cannot be right.
    pub fn believed(&self) -> Option<Celsius> {
        self.measured.filter(|_| self.ailment.is_none())
    }

    /// The last output duty, of 65,535; averaged for a relay.
    pub const fn duty(&self) -> u16 {
        self.wanted
    }

    /// Whether it warms so slowly that a wait for it is in vain.
    pub const fn is_slow(&self) -> bool {
        self.guards.is_slow()
    }

    /// Why it must not heat, although there is no fault: its sensor cannot be right.
    pub const fn ailment(&self) -> Option<Cause> {
        self.ailment
    }

    /// Whether all its heat has arrived, so that its sensor does not rise by itself.
    pub const fn is_settled(&self) -> bool {
        self.guards.is_settled()
    }

    /// Whether it has had power since the start.
    pub const fn has_heated(&self) -> bool {
        self.guards.has_heated()
    }

    /// Whether it has heated since the start, and some heat is still under way.
    pub const fn is_warming(&self) -> bool {
        self.guards.is_warming()
    }

    /// Whether it is at its greatest permitted duty.
    pub fn is_full(&self) -> bool {
        self.wanted > 0 && self.wanted >= self.most()
    }

    /// The baseline of its heat, as it was stored; zeros begin to learn it.
    pub const fn know(&mut self, baseline: [u16; 2]) {
        self.guards.know(baseline);
    }

    /// What its heat has shown.
    pub const fn figures(&self) -> HeatFigures {
        self.guards.figures()
    }

    /// Numbers from the settings, for their sum.
    pub const fn derived(&self) -> (&Curve, &Numbers, &LagNumbers) {
        (&self.curve, self.guards.numbers(), self.lag_watch.numbers())
    }

    /// Changes a number from the settings, as failing memory does.
    #[cfg(test)]
    pub fn damage(&mut self, place: usize) {
        let other = HeaterSettings { most: Celsius::const_from_int(400), ..self.settings };
        match place {
            0 => self.curve = Curve::new(crate::settings::Thermistor::PT1000),
            1 => {
                let guards = crate::settings::Guards { heating: Ratio::lit("0.2"), ..other.guards };
                self.guards.configure(&HeaterSettings { guards, ..other });
            }
            2 => self.lag_watch = LagWatch::new(&HeaterSettings::bed(other.output, other.sensor).model),
            _ => self.settings = other,
        }
    }

    /// Whether it had power in the last period.
    pub const fn is_powered(&self) -> bool {
        self.wanted > 0
    }

    /// Begins a tuning, with the part fan too if that cools it.
    pub fn tune(&mut self, target: Celsius, cycles: u8, has_fan: bool) -> Option<Tune> {
        self.set_target(target);
        let measured = self.measured.filter(|_| self.target > Celsius::ZERO);
        self.is_tuned = measured.is_some();
        measured.map(|measured| Tune::new((self.heater, &self.settings), self.target, cycles, has_fan, measured))
    }

    /// Whether a tuning that was [begun](Self::tune) is under way.
    pub const fn is_tuned(&self) -> bool {
        self.is_tuned
    }

    /// Sets full power for the coming period whatever the target, for a self-test.
    pub const fn pulse(&mut self, is_pulsed: bool) {
        self.is_pulsed = is_pulsed;
    }

    /// One control period; a tuning of this heater is passed in.
    ///
    /// # Errors
    /// The alarm of a guard; the heater must go off.
    pub fn period(&mut self, sample: Option<u16>, now: &Circumstances, tune: Option<&mut Tune>) -> Result<u16, Alarm> {
        let contact = self.filter.take(self.curve.read(sample));
        let good = match contact {
            Contact::Good(measured) => Some(measured),
            Contact::Doubtful => None,
            Contact::Broken(cause) if self.is_off() || !self.window.is_seen() => {
                // It has no power, so this is no fault; it just must not heat.
                self.refuse(Some(cause));
                // The next valid reading begins a model of its own: what happened in between is unknown.
                (self.measured, self.observer) = (None, None);
                self.guards.end();
                self.guards.follow(&self.settings, false);
                return Ok(self.put_out(0));
            }
            Contact::Broken(cause) => return Err(alarm(cause, self.measured)),
        };
        if let Some(measured) = good {
            let refused = self.window.look(self.settings.too_hot(), measured, self.is_off())?;
            self.refuse(refused.or(now.refused).or(now.differs.then_some(Cause::SensorsDiffer)));
        }
        // What was put out in the last period: a relay is on or off for whole periods, whatever duty was wanted.
        let power = self.power_at(self.given);
        // The control sees what would be without the dither.
        let (dither, answer) = self.guards.told();
        let calm = good.map(|measured| measured.saturating_sub(answer));
        let power_without = power.saturating_sub(dither);
        let past =
            Past { power: power_without, is_free: self.is_free, fan: now.fan, filament: now.filament, measured: calm };
        match (&mut self.observer, calm) {
            (Some(observer), _) => observer.follow(&past),
            (none, Some(measured)) => *none = Some(Observer::new(Coefficients::new(&self.settings), measured)),
            (None, None) => {}
        }
        let Some(measured) = good else {
            // A doubtful reading never raises the duty, and a heater that shall be off gets none.
            let wanted = if self.target == Celsius::ZERO || now.rests { 0 } else { self.wanted };
            self.guards.follow(&self.settings, wanted > 0);
            return Ok(self.put_out(wanted));
        };
        self.measured = Some(measured);
        let is_full = !self.is_free && self.given > 0;
        let seen = self.lag_watch.look(measured, power, is_full, self.guards.is_warming());
        if let (Some(seen), Some(observer)) = (seen, &mut self.observer) {
            observer.take_lag(&self.settings, seen, measured);
        }
        // Before the decision, so that an alarm leaves no duty for this period.
        self.watch(measured, power, now)?;
        let wanted = self.decide(measured, calm.unwrap_or(measured), now, tune);
        Ok(self.put_out(wanted))
    }

    /// Whether it shall have no power, and has none.
    fn is_off(&self) -> bool {
        self.target == Celsius::ZERO && self.wanted == 0
    }

    /// Refuses to heat for that reason, or does so no more.
    fn refuse(&mut self, why: Option<Cause>) {
        self.ailment = why;
        if why.is_some() {
            self.set_target(Celsius::ZERO);
        }
    }

    fn watch(&mut self, measured: Celsius, power: Power, now: &Circumstances) -> Result<(), Alarm> {
        let aim = match self.target {
            _ if self.is_pulsed => Aim::Pulse,
            target if target <= Celsius::ZERO => Aim::Off,
            target if self.is_tuned => Aim::Tune(target),
            target => Aim::Hold(target),
        };
        let Circumstances { fan, filament, warmed_to, rests, other, .. } = *now;
        let is_too_hot = self.ailment == Some(Cause::TooHot);
        let (duty, most) = (self.wanted, self.most());
        let is_tuned = self.has_own_model;
        let watched =
            Watched { aim, measured, duty, most, power, fan, filament, warmed_to, rests, is_too_hot, is_tuned, other };
        let Some(alarm) = self.guards.look(&self.settings, &watched) else { return Ok(()) };
        // Another cure: a better model does not help a heater that gives all it has.
        let cause =
            if self.is_full() && alarm.cause == Cause::TemperatureLost { Cause::LostAtFull } else { alarm.cause };
        Err(Alarm { cause, ..alarm })
    }

    /// Its greatest permitted duty, of 65,535.
    fn most(&self) -> u16 {
        ((u64::from(self.settings.max_duty.to_bits().min(1 << 16)) * 65_535) >> 16) as u16
    }

    /// The duty for the next period, by the reading and by the one that it would be without the dither.
    fn decide(&mut self, measured: Celsius, calm: Celsius, now: &Circumstances, tune: Option<&mut Tune>) -> u16 {
        let most = self.most();
        // At full power the observer learns the gain instead of the drift, and at none neither: so it is not free.
        if self.is_pulsed && self.ailment.is_none() {
            self.is_free = false;
            return most;
        }
        if self.target == Celsius::ZERO || self.ailment.is_some() {
            self.is_free = true;
            return 0;
        }
        if now.rests {
            self.is_free = false;
            return 0;
        }
        if let Some(tune) = tune.filter(|_| self.is_tuned) {
            let wanted = tune.duty(measured, most);
            self.is_free = false;
            return wanted;
        }
        if measured >= self.target.saturating_add(CEILING) {
            self.is_free = false;
            self.pid.rest();
            return 0;
        }
        let wanted = match (self.settings.control, &self.observer) {
            (Control::Model, Some(observer)) => {
                duty(predictive::power(observer, self.target, now.ahead), self.power_at(u16::MAX)).min(most)
            }
            _ => self.pid.duty(self.target, calm, most),
        };
        self.is_free = wanted > 0 && wanted < most;
        self.guards.dither(wanted, most, self.target.saturating_sub(measured))
    }

    fn put_out(&mut self, wanted: u16) -> u16 {
        self.wanted = wanted;
        self.given = self.switching.next(wanted);
        self.given
    }

    /// The power at a duty: a PTC heater has less when it is hot.
    fn power_at(&self, duty: u16) -> Power {
        let left = self.measured.map_or(Ratio::ONE, |measured| self.settings.model.power_left(measured));
        let part = (u64::from(share(duty).to_bits()) * u64::from(left.to_bits())) >> Ratio::FRAC_NBITS;
        self.settings.power.part(Ratio::from_bits(part as u32))
    }
}

const fn alarm(cause: Cause, measured: Option<Celsius>) -> Alarm {
    let value = match measured {
        Some(measured) => measured,
        None => Celsius::ZERO,
    };
    Alarm { cause, value, limit: Celsius::ZERO }
}
