//! ThermalControl: the handle of the thermal context. `self_testing` and `tuning` have its part of these trials,
//! `second_sensors` that of more sensors on a heater.

mod second_sensors;
mod self_testing;
mod tuning;

use super::fans::{Fan, Needs};
use super::fixed_point::{PERIOD_MS, quotient, saturated, share};
use super::guard::{Alarm, Cold, FanTurns, Reference, Swapped};
use super::heartbeats::{Context, Heartbeats};
use super::heater::{Circumstances, HeaterLoop};
use super::order::{Common, Order, OrdersIn};
use super::predictive::Ahead;
use super::second_sensor::SecondSensor;
use super::self_test::{End, SelfTest};
use super::tune::Tune;
use crate::connectors::{FANS, HEATERS, Heater, OUTPUTS, Sensor};
use crate::fault::{Cause, Fault};
use crate::port::{ThermalPort, Wake};
use crate::settings::{EXTRA_SENSORS, FanRole, ThermalSettings, part_fans, sum};
use crate::status::Status;
use crate::units::Celsius;
use fixed::types::I8F24;

/// Periods between two checks of the settings in RAM: 1 s.
const SCRUB: u32 = 1000 / PERIOD_MS;

/// More filament in a period than any extruder moves, in um: its heat then stays within 64 bits, whatever the settings.
const MOST_UM: i32 = 1 << 20;

/// Below this a hotend is cold: at full power it then warms faster than any other heater.
const COLD: Celsius = Celsius::const_from_int(60);

/// The alarm of a period: the first one, unless a later one is a switch that sticks.
struct Found(Option<(Heater, Alarm)>);

impl Found {
    fn add(&mut self, heater: Heater, alarm: Alarm) {
        if self.0.is_none_or(|(_, first)| alarm.cause.is_stuck_on() && !first.cause.is_stuck_on()) {
            self.0 = Some((heater, alarm));
        }
    }
}

/// Heaters, fans and sensors of a machine.
pub struct ThermalControl<'m, H: ThermalPort, W: Wake> {
    port: H,
    orders: OrdersIn<'m>,
    status: &'m Status,
    wake: W,
    heaters: [HeaterLoop; HEATERS],
    fans: [Fan; FANS],
    fan_turns: [FanTurns; FANS],
    /// Which fans cool what is printed, and the hotend's block with it: found once, and summed up with the settings.
    parts: [bool; FANS],
    /// The duty of the strongest part fan in the last period, of 65,535.
    part_fan: u16,
    common: Common,
    reference: Reference,
    swapped: [[Swapped; HEATERS]; HEATERS],
    cold: Cold,
    seconds: [SecondSensor; EXTRA_SENSORS],
    self_test: Option<SelfTest>,
    /// The last tuning, and its heater. There is one for all heaters, for it takes 200 bytes.
    tune: Option<(Heater, Tune)>,
    /// A switch sticks, or may do so unseen: only the power supply ends that, and all fans run.
    has_cut_supply: bool,
    heartbeats: Heartbeats,
    /// Whether motors have power, and the remaining periods of the controller fan.
    has_motors: bool,
    runs_on: u32,
    extruded_um: u32,
    /// The sum of the settings when they came.
    settings_sum: u32,
    /// Periods until the next check of the sum.
    scrub_in: u32,
}

impl<'m, H: ThermalPort, W: Wake> ThermalControl<'m, H, W> {
    /// All heaters off.
    pub fn new(settings: &ThermalSettings, orders: OrdersIn<'m>, status: &'m Status, port: H, wake: W) -> Self {
        let mut control = Self {
            port,
            orders,
            status,
            wake,
            heaters: Heater::ALL.map(|heater| HeaterLoop::new(heater, *settings.heater(heater))),
            fans: settings.fans.map(Fan::new),
            fan_turns: [FanTurns::new(); FANS],
            parts: part_fans(settings.fans.map(|fan| fan.role)),
            part_fan: 0,
            common: Common::of(settings),
            reference: Reference::new(),
            swapped: [[Swapped::new(); HEATERS]; HEATERS],
            cold: Cold::new(),
            seconds: settings.sensors.map(|extra| SecondSensor::new(extra.thermistor)),
            self_test: None,
            tune: None,
            has_cut_supply: false,
            heartbeats: Heartbeats::new(),
            has_motors: false,
            runs_on: 0,
            extruded_um: 0,
            settings_sum: 0,
            scrub_in: SCRUB,
        };
        // The board switches the power supply on. After a switch that stuck it stays off, which this room does not
        // know.
        control.settings_sum = control.sum();
        control
    }

    /// One control period: called every 20 ms, in a context that the Console cannot delay.
    pub fn period(&mut self) {
        self.take_orders();
        self.listen();
        self.heat();
        self.set_fan();
        self.status.heat().set_filament(self.port.filament());
        self.status.heat().count_period();
    }

    /// The hardware port.
    pub const fn port(&mut self) -> &mut H {
        &mut self.port
    }

    fn take_orders(&mut self) {
        let mut has_new_settings = false;
        while let Some(order) = self.orders.dequeue() {
            match order {
                // After a fault no heater may heat.
                Order::Target(..) | Order::Tune(..) | Order::SelfTest if self.status.fault().is_set() => {}
                Order::Target(heater, target) => match &mut self.self_test {
                    Some(test) => test.hold(heater, self.heaters[heater as usize].legal(target)),
                    None => self.heaters[heater as usize].set_target(target),
                },
                // A tuning would heat what the test watches as cold.
                Order::Tune(..) if self.self_test.is_some() => {}
                Order::SelfTest => self.begin_self_test(),
                Order::Tune(heater, target, cycles) => self.begin_tuning(heater, target, cycles),
                Order::StopTrials => {
                    self.stop_tuning();
                    self.end_self_test(End::PutOff);
                }
                Order::Fan(fan, speed) => {
                    if let Some(fan) = self.fans.get_mut(usize::from(fan)) {
                        fan.command(speed);
                    }
                }
                Order::Motors(on) => self.has_motors = on,
                Order::Off => {
                    // Stopped, not ended: an end would give the heaters their held targets.
                    self.stop_self_test();
                    self.heaters.iter_mut().for_each(|heater| heater.set_target(Celsius::ZERO));
                    self.fans.iter_mut().for_each(|fan| fan.command(0));
                }
                Order::Heater(heater, settings) => {
                    // Its pulse was made for the old model.
                    self.end_self_test(End::PutOff);
                    self.heaters[heater as usize].configure(settings);
                    has_new_settings = true;
                }
                Order::Baseline(heater, baseline) => self.heaters[heater as usize].know(baseline),
                Order::FanSettings(fan, settings) => {
                    if let Some(fan) = self.fans.get_mut(usize::from(fan)) {
                        fan.configure(settings);
                    }
                    has_new_settings = true;
                }
                Order::Common(common) => {
                    self.take_sensors(&common.sensors);
                    self.common = common;
                    has_new_settings = true;
                }
            }
        }
        if has_new_settings {
            self.parts = part_fans(self.fans.each_ref().map(|fan| fan.settings().role));
            self.settings_sum = self.sum();
        }
    }

    /// Feeds the watchdog, and checks the settings in RAM.
    fn listen(&mut self) {
        if self.heartbeats.is_silent(Context::Generator) {
            self.wake.wake_generator();
        }
        if self.heartbeats.is_silent(Context::Stepper) {
            self.wake.wake_stepper();
        }
        if let Some(fault) = self.heartbeats.listen(self.status) {
            self.status.fault().set(fault);
        }
        if self.heartbeats.all_beat() {
            self.port.feed_watchdog();
        }
        self.scrub_in -= 1;
        if self.scrub_in == 0 {
            self.scrub_in = SCRUB;
            if self.sum() != self.settings_sum {
                self.status.fault().set(Fault::plain(Cause::SettingsDamaged));
            }
        }
    }

    /// The sum of the settings, and of the numbers that guards derive from them.
    fn sum(&self) -> u32 {
        let heaters = self.heaters.each_ref();
        sum(&(
            heaters.map(HeaterLoop::settings),
            heaters.map(HeaterLoop::derived),
            self.seconds.each_ref().map(SecondSensor::curve),
            self.fans.each_ref().map(Fan::settings),
            self.parts,
            self.common,
        ))
    }

    /// All heaters of the coming period. After a fault or an emergency stop they are all off.
    fn heat(&mut self) {
        for (sensor, _) in &Sensor::ALL {
            self.status.heat().set_sample(*sensor, self.port.sample(*sensor));
        }
        // Before the fans of this period: the duties are what cooled the block in the last one.
        let of_hotend = self.circumstances();
        let of_others = Circumstances { filament: I8F24::ZERO, ahead: Ahead::default(), ..of_hotend };
        let warmed_to = Heater::ALL.map(|heater| self.warmed_to(heater));
        let differs = self.compare_cold();
        let mut duties = [0; OUTPUTS];
        // First, because it says which heater has a pulse in this period.
        let mut found = Found(self.test().err());
        let seconds = self.look_at_seconds(&mut found);
        for heater in Heater::ALL {
            let looped = &mut self.heaters[heater as usize];
            let settings = looped.settings();
            if !settings.is_fitted {
                continue;
            }
            let (output, sensor) = (settings.output, settings.sensor);
            let now = if heater == Heater::Hotend { of_hotend } else { of_others };
            let second = seconds[heater as usize];
            let rests = second.is_hot || heater == Heater::Bed && self.status.heat().bed_rests();
            let differs = differs && heater != Heater::Chamber;
            let refused = second.refused;
            let now = Circumstances { warmed_to: warmed_to[heater as usize], rests, differs, refused, ..now };
            let tune = self.tune.as_mut().filter(|(tuned, _)| *tuned == heater).map(|(_, tune)| tune);
            match looped.period(self.status.heat().sample(sensor), &now, tune) {
                Ok(duty) if self.port.outputs().has(output) => duties[output as usize] = duty,
                // The board has no such output. The sensor's guards watch all the same.
                Ok(_) => {}
                Err(alarm) => found.add(heater, alarm),
            }
            if looped.ailment().is_some() {
                self.drop_held(heater);
            }
        }
        if let Err((heater, alarm)) = self.compare() {
            found.add(heater, alarm);
        }
        if let Some(alarm) = self.port.reference().and_then(|sample| self.reference.look(sample)) {
            let heated = Heater::ALL.into_iter().find(|heater| self.heaters[*heater as usize].has_heated());
            found.add(heated.unwrap_or(Heater::Hotend), alarm);
        }
        self.status.heat().set_mcu(self.port.mcu());
        // Before the duties are put out, so that an alarm cuts the power in the same period.
        if let Some((heater, alarm)) = found.0 {
            self.fail(heater as u8, alarm);
        }
        if self.status.fault().is_set() || self.status.is_halted() {
            duties = [0; OUTPUTS];
            self.stop_self_test();
            self.heaters.iter_mut().for_each(|heater| heater.set_target(Celsius::ZERO));
        }
        self.port.heat(&duties);
        self.report_tuning();
        let is_any_on = duties.iter().any(|duty| *duty > 0);
        for heater in Heater::ALL {
            let looped = &self.heaters[heater as usize];
            let held = self.self_test.as_ref().map(|test| test.held()[heater as usize]);
            let target = held.unwrap_or(looped.target());
            let measured = looped.measured().filter(|_| looped.settings().is_fitted);
            // After a fault a heater still has its wanted duty, which has not been put out.
            let duty = if is_any_on { looped.duty() } else { 0 };
            self.status.heat().set_heater(heater, measured, target, duty);
            self.status.heat().set_ailment(heater, looped.ailment());
            self.status.heat().set_slow(heater, looped.is_slow());
            self.status.heat().set_figures(heater, looped.figures());
        }
    }

    /// The surroundings of the heaters: the strongest part fan, and the filament.
    fn circumstances(&mut self) -> Circumstances {
        let heat = self.status.heat();
        let um = heat.extruded_um();
        let moved = um
            .wrapping_sub(core::mem::replace(&mut self.extruded_um, um))
            .cast_signed()
            .clamp(0, MOST_UM)
            .unsigned_abs();
        // um a period times J/(K mm), times periods a second over 1000 um: W/K.
        let filament = quotient(u64::from(moved) * u64::from(self.common.filament.to_bits()), PERIOD_MS);
        let [coming, then] = heat.filament_ahead().map(|bits| I8F24::from_bits(saturated(bits.into())));
        Circumstances {
            warmed_to: Celsius::MIN,
            rests: false,
            differs: false,
            refused: None,
            other: self.heaters[Heater::Bed as usize].figures().low(),
            fan: share(self.part_fan),
            filament: I8F24::from_bits(saturated(filament.into())),
            ahead: Ahead { coming, then },
        }
    }

    /// The temperature up to which its neighbours may warm a heater. A hot bed warms the hotend next to it and the
    /// chamber as long as it is hot. A hotend, which is light, warms the chamber as long as its heat is under way.
    /// Nothing warms a bed, which is the heaviest.
    fn warmed_to(&self, heater: Heater) -> Celsius {
        let [hotend, bed, _] = &self.heaters;
        let reading = |near: &HeaterLoop| near.believed().filter(|_| near.settings().is_fitted);
        let near = match heater {
            Heater::Hotend => reading(bed),
            Heater::Bed => None,
            Heater::Chamber => reading(hotend).filter(|_| !hotend.is_settled()).max(reading(bed)),
        };
        near.unwrap_or(Celsius::MIN)
    }

    /// Whether hotend and bed are cold and read differently.
    fn compare_cold(&mut self) -> bool {
        let [hotend, bed, _] = &self.heaters;
        let reading = |heater: &HeaterLoop| heater.measured().filter(|_| heater.settings().is_fitted);
        self.cold.look(hotend.is_powered() || bed.is_powered(), [reading(hotend), reading(bed)])
    }

    /// Checks that each heater warms its own sensor.
    fn compare(&mut self) -> Result<(), (Heater, Alarm)> {
        let mut found = Ok(());
        for own in Heater::ALL {
            let a = &self.heaters[own as usize];
            let Some(a_is) = a.measured().filter(|_| a.settings().is_fitted) else { continue };
            let heats = a.duty() > u16::MAX / 2;
            // A hotend is quicker than any heater that heats with it.
            let is_quick = own == Heater::Hotend && a.is_full() && a_is < COLD;
            for (other, guard) in Heater::ALL.into_iter().zip(&mut self.swapped[own as usize]) {
                let b = &self.heaters[other as usize];
                let Some(b_is) = b.measured().filter(|_| own != other && b.settings().is_fitted) else { continue };
                if let Some(alarm) = guard.look(heats && (is_quick || !b.is_powered() && !b.is_warming()), a_is, b_is) {
                    found = found.and(Err((own, alarm)));
                }
            }
        }
        found
    }

    /// Handles an alarm: the first cause counts. A switch that sticks switches the power supply off, whatever came
    /// first. So does a lost sensor of a heater that has had power: its switch may stick, and nothing would show it.
    fn fail(&mut self, subject: u8, alarm: Alarm) {
        let Alarm { cause, value, limit } = alarm;
        self.status.fault().set(Fault { cause, subject, value: value.to_bits(), limit: limit.to_bits() });
        let has_heated = || self.heaters.get(usize::from(subject)).is_some_and(HeaterLoop::has_heated);
        if cause.is_stuck_on() || cause.hides_heat() && has_heated() {
            self.has_cut_supply = true;
            self.port.switch_supply(false);
        }
    }

    /// All fans of the coming period.
    fn set_fan(&mut self) {
        let [hotend, ..] = &self.heaters;
        // A hotend without a reading that can be right may be hot.
        let is_warm = hotend.settings().is_fitted
            && hotend.believed().is_none_or(|measured| measured > self.common.hotend_fan_above);
        let is_busy = self.has_motors || self.heaters.iter().any(HeaterLoop::is_powered);
        self.runs_on = if is_busy {
            u32::from(self.common.fan_run_on_s) * (1000 / PERIOD_MS)
        } else {
            self.runs_on.saturating_sub(1)
        };
        // A tuning controls the part fan itself.
        let tuned = self.tuning().and_then(|(_, tune)| tune.fan());
        let mut standing = None;
        self.part_fan = 0;
        let needs = Needs { hotend: is_warm, controller: is_busy || self.runs_on > 0, all: self.has_cut_supply };
        for (place, (fan, is_part)) in self.fans.iter_mut().zip(self.parts).enumerate().take(self.port.fans()) {
            let forced = tuned.filter(|_| is_part);
            let duty = forced.map_or_else(|| fan.period(needs), |is_on| if is_on { u16::MAX } else { 0 });
            if is_part {
                self.part_fan = self.part_fan.max(duty);
            }
            self.port.set_fan(place, duty);
            self.status.heat().set_fan(place, duty);
            let Some(pulses) = self.port.tachometer(place) else { continue };
            let turns = &mut self.fan_turns[place];
            let alarm = turns.look(duty, pulses);
            let is_of_hotend = fan.settings().role == FanRole::Hotend;
            if let Some(alarm) = alarm.filter(|_| is_of_hotend) {
                standing = Some((place as u8, alarm));
            }
            self.status.heat().set_tachometer(place, turns.pulses(), turns.is_still() && !is_of_hotend);
        }
        if let Some((fan, alarm)) = standing {
            self.fail(fan, alarm);
        }
    }
}

#[cfg(test)]
mod tests;
