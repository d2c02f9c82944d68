//! The commands for the motor drivers: M122, M569, M906, M913, M914.
//!
//! X and Y both mean the four belt motors, which have one set of settings. A change reaches the drivers of motors
//! with power within a second, in the background and without stopping the motion; the others before they get it.

use super::console::{Console, Interrupt, PortSet};
use super::report::{Hundredths, exact};
use crate::driver::{Job, Name};
use crate::gcode::{AxisFlags, AxisWords, Number};
use crate::port::{Motor, MotorSet, Pend};
use crate::settings::{DriverGroups, DriverSettings, ranges};
use crate::units::{Mm, MmPerSec};

/// Full steps of a turn of almost every stepper motor (1.8 degrees).
const FULL_STEPS: u64 = 200;

/// The groups of motors by the letters that name them.
fn named(groups: &DriverGroups) -> [(char, &DriverSettings); 4] {
    [('X', &groups.belt), ('Y', &groups.belt), ('Z', &groups.z), ('E', &groups.e)]
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Whether there are drivers to talk to; says so if there are none.
    async fn has_lines(&mut self) -> Result<bool, Interrupt> {
        let has_lines = !self.drivers.lines().is_empty();
        if !has_lines {
            self.say(format_args!("echo:drivers are set by their jumpers")).await?;
        }
        Ok(has_lines)
    }

    /// Every group that a line names, with its value; `None` if X and Y do not agree, which is said.
    async fn groups(&mut self, code: &str, words: &AxisWords) -> Result<Option<[Option<Number>; 3]>, Interrupt> {
        if words.x.is_some() && words.y.is_some() && words.x != words.y {
            self.say(format_args!("echo:{code} ignored: X and Y move one belt and need the same value")).await?;
            return Ok(None);
        }
        Ok(Some([words.x.or(words.y), words.z, words.e]))
    }

    /// Takes over what `change` makes of every group that was named.
    fn change_drivers(&mut self, values: [Option<Number>; 3], change: impl Fn(&mut DriverSettings, Number)) {
        let groups = &mut self.settings.drivers;
        for (group, value) in [&mut groups.belt, &mut groups.z, &mut groups.e].into_iter().zip(values) {
            if let Some(value) = value {
                change(group, value);
            }
        }
        self.drivers.want(&self.settings);
    }

    /// M906.
    pub(super) async fn set_currents(&mut self, words: &AxisWords) -> Result<(), Interrupt> {
        if !self.has_lines().await? {
            return Ok(());
        }
        if *words == AxisWords::default() {
            let groups = self.settings.drivers;
            for (axis, group) in named(&groups) {
                self.say(format_args!("{axis} driver current: {}", group.current_ma)).await?;
            }
            return Ok(());
        }
        let Some(values) = self.groups("M906", words).await? else { return Ok(()) };
        let current = |number: Number| u16::try_from(number.to_u32()).unwrap_or(u16::MAX);
        let legal = ranges::CURRENT_MA;
        if !values.into_iter().flatten().all(|number| legal.holds(current(number))) {
            // A current that nobody asked for could burn a motor.
            return self.say(format_args!("echo:M906 ignored: {} to {} mA", legal.least, legal.most)).await;
        }
        self.change_drivers(values, |group, number| group.current_ma = current(number));
        Ok(())
    }

    /// M913.
    pub(super) async fn set_hybrid_thresholds(&mut self, words: &AxisWords) -> Result<(), Interrupt> {
        if !self.has_lines().await? {
            return Ok(());
        }
        if *words == AxisWords::default() {
            let groups = self.settings.drivers;
            for (axis, group) in named(&groups) {
                self.say(format_args!("{axis} stealthChop max speed: {}", exact(group.hybrid_threshold))).await?;
            }
            return Ok(());
        }
        let Some(values) = self.groups("M913", words).await? else { return Ok(()) };
        let modal = self.modal;
        self.change_drivers(values, |group, number| {
            group.hybrid_threshold = MmPerSec::saturating_from_num(modal.length(number)).min(ranges::SPEED.most);
        });
        Ok(())
    }

    /// M914.
    pub(super) async fn set_stall_thresholds(&mut self, words: &AxisWords) -> Result<(), Interrupt> {
        if !self.has_lines().await? {
            return Ok(());
        }
        if *words == AxisWords::default() {
            let groups = self.settings.drivers;
            for (axis, group) in named(&groups) {
                self.say(format_args!("{axis} homing sensitivity: {}", group.stall_threshold)).await?;
            }
            return Ok(());
        }
        let Some(values) = self.groups("M914", words).await? else { return Ok(()) };
        self.change_drivers(values, |group, number| {
            group.stall_threshold = u8::try_from(number.to_u32()).unwrap_or(u8::MAX);
        });
        Ok(())
    }

    /// M569. The motion rests first: a motor that changes its mode at speed may lose steps.
    pub(super) async fn set_stealth(&mut self, on: Option<bool>, axes: AxisFlags) -> Result<(), Interrupt> {
        if !self.has_lines().await? {
            return Ok(());
        }
        let Some(on) = on else {
            let groups = self.settings.drivers;
            for (axis, group) in named(&groups) {
                let mode = if group.stealth { "stealthChop" } else { "spreadCycle" };
                self.say(format_args!("{axis} driver mode: {mode}")).await?;
            }
            return Ok(());
        };
        self.finish().await?;
        let all = axes == AxisFlags::default();
        let named = |is_named: bool| (is_named || all).then_some(Number::ZERO);
        self.change_drivers([named(axes.x || axes.y), named(axes.z), named(axes.e)], |group, _| group.stealth = on);
        self.until(|c| c.drivers.is_settled()).await
    }

    /// M503, the part of the drivers.
    pub(super) async fn report_driver_settings(&mut self) -> Result<(), Interrupt> {
        if self.drivers.lines().is_empty() {
            return Ok(());
        }
        let DriverGroups { belt, z, e } = self.settings.drivers;
        for (group, axes) in [(belt, "X Y"), (z, "Z"), (e, "E")] {
            self.say(format_args!("echo:  M569 S{} {axes}", u8::from(group.stealth))).await?;
        }
        let (b, z, e) = (belt, z, e);
        let current = b.current_ma;
        self.say(format_args!("echo:  M906 X{current} Y{current} Z{} E{}", z.current_ma, e.current_ma)).await?;
        let [x, vz, ve] = [b, z, e].map(|group| exact(group.hybrid_threshold));
        self.say(format_args!("echo:  M913 X{x} Y{x} Z{vz} E{ve}")).await?;
        let stall = b.stall_threshold;
        self.say(format_args!("echo:  M914 X{stall} Y{stall} Z{} E{}", z.stall_threshold, e.stall_threshold)).await
    }

    /// M122.
    pub(super) async fn report_drivers(&mut self) -> Result<(), Interrupt> {
        for motor in Motor::ALL {
            let name = Name(motor);
            if !self.drivers.lines().has(motor) {
                self.say(format_args!("Driver {name}: no UART, set by its jumpers")).await?;
                continue;
            }
            let reading = match self.ask_driver(Job::Read, motor).await? {
                Ok(reading) => reading,
                Err(error) => {
                    self.say(format_args!("Driver {name}: {error}")).await?;
                    continue;
                }
            };
            let (held, failures) = self.drivers.known(motor);
            let power = if self.drivers.powered().has(motor) { "on" } else { "off" };
            match held {
                Some(held) => {
                    let (turn, current) = (self.turn_of(motor, held.microsteps()), held.run_current_ma());
                    self.say(format_args!(
                        "Driver {name}: configured, motor {power}, {current} mA, {}, {} microsteps, {turn} mm a turn",
                        reading.mode(),
                        reading.microsteps().unwrap_or_default(),
                    ))
                    .await?;
                }
                None => self.say(format_args!("Driver {name}: not configured yet, motor {power}")).await?,
            }
            let open = if reading.seems_open() { ", coil open?" } else { "" };
            self.say(format_args!(
                "  {}{open}, stall result {}, {} writes, {failures} failed exchanges",
                reading.temperature(),
                reading.stall(),
                reading.writes()
            ))
            .await?;
            if let (Some(problem), Some(_)) = (reading.problem(), held) {
                self.say(format_args!("  {problem}")).await?;
            }
        }
        Ok(())
    }

    /// How far a turn of a motor of 200 full steps goes, which shows whether microsteps and steps/mm agree.
    fn turn_of(&self, motor: Motor, microsteps: u32) -> Hundredths {
        let (axes, set) = (&self.settings.axes, MotorSet::of(motor));
        let axis = match set {
            s if s.without(MotorSet::BELT).is_empty() => axes.x,
            s if s.without(MotorSet::Z).is_empty() => axes.z,
            _ => axes.e,
        };
        let steps = (FULL_STEPS * u64::from(microsteps)) << 48;
        Hundredths(Mm::from_bits((steps / u64::from(axis.steps_per_mm.to_bits().max(1))) as i64))
    }
}
