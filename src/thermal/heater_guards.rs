//! The guards of one heater, and what they are fed.

use super::fixed_point::Power;
use super::guard::{Alarm, AtTarget, Floor, Frozen, Gain, HeatBalance, Numbers, Seen, UnderWay, WhileOff, Window};
use crate::connectors::Heater;
use crate::settings::HeaterSettings;
use crate::units::{Celsius, Ratio};
use fixed::types::I8F24;

/// A reading is smoothed over 1/2^4 of its history: 0.3 s.
const SMOOTHING: u32 = 4;

/// What a heater is made to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Aim {
    /// Nothing.
    Off,
    /// To be kept at this temperature.
    Hold(Celsius),
    /// To swing around this temperature (M303): its model is not believed.
    Tune(Celsius),
    /// To be warmed a little (self-test): its model is not believed.
    Pulse,
}

/// What a control period was like.
#[derive(Clone, Copy, Debug)]
pub struct Watched {
    /// What it is made to do.
    pub aim: Aim,
    /// The reading.
    pub measured: Celsius,
    /// The duty that is wanted for it, of 65,535. A relay is off at times although power is wanted.
    pub duty: u16,
    /// The most that it may have.
    pub most: u16,
    /// The power that was given.
    pub power: Power,
    /// The part fan's duty, of 1.
    pub fan: Ratio,
    /// Heat that the filament takes away for each K, in W/K.
    pub filament: I8F24,
    /// Up to here another heater warms it, rightly.
    pub warmed_to: Celsius,
}

/// The guards of one heater.
pub struct HeaterGuards {
    floor: &'static Floor,
    under_way: UnderWay,
    /// The reading without its noise, once there is one.
    smooth: Option<Celsius>,
    window: Window,
    gain: Gain,
    balance: HeatBalance,
    at_target: AtTarget,
    while_off: WhileOff,
    frozen: Frozen,
}

impl HeaterGuards {
    /// Guards that have seen nothing yet.
    pub fn new(heater: Heater, settings: &HeaterSettings) -> Self {
        Self {
            floor: Floor::of(heater),
            under_way: UnderWay::new(),
            smooth: None,
            window: Window::new(),
            gain: Gain::new(),
            balance: HeatBalance::new(settings),
            at_target: AtTarget::new(),
            while_off: WhileOff::new(),
            frozen: Frozen::new(),
        }
    }

    /// Other numbers. What was seen so far still counts, or settings that keep coming would hold up every alarm.
    pub fn configure(&mut self, settings: &HeaterSettings) {
        self.balance.configure(settings);
    }

    /// All episodes end: there is no reading. Power that was given counts on.
    pub fn end(&mut self) {
        self.smooth = None;
        (self.window, self.at_target, self.while_off, self.frozen) =
            (Window::new(), AtTarget::new(), WhileOff::new(), Frozen::new());
    }

    /// Follows the power of a period without a reading.
    pub fn follow(&mut self, settings: &HeaterSettings, is_powered: bool) {
        self.under_way.follow(is_powered, &settings.model, self.floor);
    }

    /// Whether it was heated since the start, and not all of that has arrived.
    pub const fn is_warming(&self) -> bool {
        self.under_way.has_heated() && !self.under_way.is_over()
    }

    /// Whether all heat has arrived, so that it does not rise by itself.
    pub const fn is_settled(&self) -> bool {
        self.under_way.is_over()
    }

    /// What the guards have made of the settings, to be summed up with them.
    pub const fn numbers(&self) -> &Numbers {
        self.balance.numbers()
    }

    /// Looks at a control period. Every guard does, whatever others have found; a switch that sticks is the worst.
    pub fn look(&mut self, settings: &HeaterSettings, now: &Watched) -> Option<Alarm> {
        self.follow(settings, now.duty > 0);
        let before = self.smooth.unwrap_or(now.measured);
        let smooth = before.saturating_add(now.measured.saturating_sub(before) >> SMOOTHING);
        self.smooth = Some(smooth);
        let seen = Seen {
            measured: now.measured,
            smooth,
            duty: now.duty,
            is_settled: self.under_way.is_over(),
            warmed_to: now.warmed_to,
        };
        let (hold, goal, is_believed) = match now.aim {
            Aim::Off | Aim::Pulse => (None, None, now.aim == Aim::Off),
            Aim::Hold(target) => (Some(target), Some(target), true),
            Aim::Tune(target) => (None, Some(target), false),
        };
        let is_heated = is_believed && !seen.is_settled;
        // One that has just been switched off has the duty of the period before, and nothing to warm up for.
        let given = if now.aim == Aim::Off { 0 } else { now.duty };
        let found = [
            self.window.look(settings.too_hot(), now.measured),
            self.while_off.look(settings.guards.off_rise, &seen),
            self.at_target.look(&settings.guards, self.floor, hold, &seen),
            self.frozen.look(self.floor, now.measured, now.duty),
            self.gain.look(self.floor, goal, smooth, (given, now.most)),
            self.balance.look(is_heated, &seen, now.power, now.fan, now.filament),
        ];
        let is_worst = |alarm: &&Alarm| alarm.cause.is_stuck_on();
        let mut alarms = found.iter().flatten();
        alarms.clone().find(is_worst).or_else(|| alarms.next()).copied()
    }
}
