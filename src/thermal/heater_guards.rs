//! The guards of one heater, and their inputs.

use super::guard::{Alarm, AtTarget, Floor, Frozen, Gain, HeatBalance, HeatSums, Leak, LowReading, MissingHeat};
use super::guard::{Numbers, Seen, Subject, UnderWay, WhileOff};
use crate::connectors::Heater;
use crate::settings::HeaterSettings;
use crate::status::HeatFigures;
use crate::units::{Celsius, Power, Ratio};
use fixed::types::I8F24;

/// A reading is smoothed over 1/2^4 of its history: 0.3 s.
const SMOOTHING: u32 = 4;

/// The task of a heater.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Aim {
    /// Nothing.
    Off,
    /// Hold this temperature.
    Hold(Celsius),
    /// Swing around this temperature (M303); the guards do not use its model.
    Tune(Celsius),
    /// Warm a little (self-test); the guards do not use its model.
    Pulse,
}

/// One control period.
#[derive(Clone, Copy, Debug)]
pub struct Watched {
    /// Its task.
    pub aim: Aim,
    /// The reading.
    pub measured: Celsius,
    /// The requested duty, of 65,535. A relay may be off although power is requested.
    pub duty: u16,
    /// Its greatest permitted duty.
    pub most: u16,
    /// The given power.
    pub power: Power,
    /// The part fan's duty, of 1.
    pub fan: Ratio,
    /// Heat that the filament takes away for each K, in W/K.
    pub filament: I8F24,
    /// Temperature up to which another heater may warm it.
    pub warmed_to: Celsius,
    /// It reads too hot since the first reading: with or without heat under way, it must not get warmer.
    pub is_too_hot: bool,
    /// It gets no power for now.
    pub rests: bool,
    /// Its model is its own, not the one that any heater begins with.
    pub is_tuned: bool,
    /// How many times too low another heater reads, by its heat; 0 is not known.
    pub other: u16,
}

/// The guards of one heater.
pub struct HeaterGuards {
    floor: &'static Floor,
    under_way: UnderWay,
    /// The reading without its noise, after the first one.
    smooth: Option<Celsius>,
    gain: Gain,
    balance: HeatBalance,
    sums: HeatSums,
    missing: MissingHeat,
    low: LowReading,
    at_target: AtTarget,
    while_off: WhileOff,
    leak: Leak,
    frozen: Frozen,
}

impl HeaterGuards {
    /// Guards without observations.
    pub fn new(heater: Heater, settings: &HeaterSettings) -> Self {
        let floor = Floor::of(heater);
        Self {
            floor,
            under_way: UnderWay::new(),
            smooth: None,
            gain: Gain::new(),
            balance: HeatBalance::new(settings, floor.is_quick),
            sums: HeatSums::new(),
            missing: MissingHeat::new(),
            low: LowReading::new(),
            at_target: AtTarget::new(),
            while_off: WhileOff::new(),
            leak: Leak::new(),
            frozen: Frozen::new(),
        }
    }

    /// Sets other numbers. Observations still count; otherwise settings that keep coming would delay every alarm. Only
    /// what was learned of another model does not.
    pub fn configure(&mut self, settings: &HeaterSettings) {
        let before = self.balance.numbers().of_heat();
        self.balance.configure(settings, self.floor.is_quick);
        if self.balance.numbers().of_heat() != before {
            self.missing = MissingHeat::new();
            self.low = LowReading::new();
        }
    }

    /// Ends all episodes, because there is no reading. Given power still counts.
    pub fn end(&mut self) {
        self.smooth = None;
        (self.at_target, self.while_off, self.frozen) = (AtTarget::new(), WhileOff::new(), Frozen::new());
        self.sums = HeatSums::new();
        self.low.end();
        self.leak = Leak::new();
    }

    /// Follows the power of a period without a reading.
    pub fn follow(&mut self, settings: &HeaterSettings, is_powered: bool) {
        self.under_way.follow(is_powered, &settings.model, self.floor);
    }

    /// Whether it has had power since the start.
    pub const fn has_heated(&self) -> bool {
        self.under_way.has_heated()
    }

    /// Whether it has heated since the start, and some heat is still under way.
    pub const fn is_warming(&self) -> bool {
        self.under_way.has_heated() && !self.under_way.is_over()
    }

    /// Whether all heat has arrived, so that it does not rise by itself.
    pub const fn is_settled(&self) -> bool {
        self.under_way.is_over()
    }

    /// Whether it warms so slowly that a wait for it is in vain.
    pub const fn is_slow(&self) -> bool {
        self.gain.is_slow()
    }

    /// The duty that a wanted duty becomes, at most `most`, for a reading that is so far below the target.
    pub fn dither(&mut self, wanted: u16, most: u16, below: Celsius) -> u16 {
        if !self.floor.has_dither {
            return wanted;
        }
        self.low.dither().apply(self.balance.numbers(), self.floor.is_quick, wanted, most, below)
    }

    /// The power that the dither gave in the last period, and the answer that the reading has of it.
    pub const fn told(&self) -> (Power, Celsius) {
        self.low.told()
    }

    /// The baseline of its heat, as it was stored; zeros begin to learn it.
    pub const fn know(&mut self, baseline: [u16; 2]) {
        self.low.know(baseline);
    }

    /// What its heat has shown.
    pub const fn figures(&self) -> HeatFigures {
        self.low.figures()
    }

    /// Numbers that the guards derive from the settings, for their sum.
    pub const fn numbers(&self) -> &Numbers {
        self.balance.numbers()
    }

    /// Follows a control period. Every guard runs, whatever others have found; a switch that sticks counts most.
    pub fn look(&mut self, settings: &HeaterSettings, now: &Watched) -> Option<Alarm> {
        self.follow(settings, now.duty > 0);
        let before = self.smooth.unwrap_or(now.measured);
        let smooth = before.saturating_add(now.measured.saturating_sub(before) >> SMOOTHING);
        self.smooth = Some(smooth);
        let seen = Seen {
            measured: now.measured,
            smooth,
            duty: now.duty,
            is_settled: self.under_way.is_over() || now.is_too_hot,
            warmed_to: now.warmed_to,
            rests: now.rests,
        };
        let (hold, goal, is_believed) = match now.aim {
            Aim::Off | Aim::Pulse => (None, None, now.aim == Aim::Off),
            Aim::Hold(target) => (Some(target), Some(target), true),
            Aim::Tune(target) => (None, Some(target), false),
        };
        let is_heated = is_believed && !seen.is_settled;
        // A heater that was just switched off still has the duty of the last period, and no task.
        let given = if now.aim == Aim::Off { 0 } else { now.duty };
        let n = self.balance.numbers();
        let leaving = n.leaving(now.fan, now.filament);
        let is_quick = self.floor.is_quick;
        let mut low = None;
        if self.floor.has_dither {
            self.sums.follow(n, is_quick, &seen, now.power, leaving);
            let subject = Subject { is_quick, is_tuned: now.is_tuned, other: now.other };
            low = self.low.look(n, subject, hold, &seen, &self.sums);
        }
        let (missing, leak) = if is_quick {
            let missing = self.missing.look(n, hold.is_some(), &self.sums, now.power);
            (missing, self.leak.look(n, self.missing.shown(), &seen, leaving))
        } else {
            (None, None)
        };
        let found = [
            leak,
            missing,
            low,
            self.while_off.look(settings.guards.off_rise, &seen),
            self.at_target.look(&settings.guards, self.floor, hold, &seen),
            self.frozen.look(self.floor, [hold, goal], &seen),
            self.gain.look(self.floor, goal, smooth, (given, now.most)),
            self.balance.look(is_heated, &seen, now.power, leaving),
        ];
        let is_worst = |alarm: &&Alarm| alarm.cause.is_stuck_on();
        let mut alarms = found.iter().flatten();
        alarms.clone().find(is_worst).or_else(|| alarms.next()).copied()
    }
}
