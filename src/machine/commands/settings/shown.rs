//! Settings as the lines that set them: one each for the command without words, all of them for M503.

use crate::gcode::Number;
use crate::machine::commands::drivers::DriverValue;
use crate::machine::commands::retraction::Retraction;
use crate::machine::commands::shaping::shortest;
use crate::machine::console::{Console, PortSet};
use crate::machine::reports::answer::Answer;
use crate::port::Pend;
use crate::settings::CornerRule;
use crate::units::Mm;
use fixed::types::I32F32;

/// What one line sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Setting {
    /// M92.
    Resolutions,
    /// M203.
    MaxSpeeds,
    /// M201.
    MaxAccelerations,
    /// M204.
    Accelerations,
    /// M205.
    Corners,
    /// SET_VELOCITY_LIMIT.
    VelocityLimit,
    /// M593.
    Shapers,
    /// M900 and M572.
    Advance,
    /// M207.
    Retraction,
    /// M208.
    Recovery,
}

impl Setting {
    const ALL: [Self; 10] = [
        Self::Resolutions,
        Self::MaxSpeeds,
        Self::MaxAccelerations,
        Self::Accelerations,
        Self::Corners,
        Self::VelocityLimit,
        Self::Shapers,
        Self::Advance,
        Self::Retraction,
        Self::Recovery,
    ];

    /// Itself as an answer.
    pub const fn answer(self) -> Answer<'static> {
        Answer::Setting(self)
    }
}

/// A setting with as many decimals as reading it back needs.
pub(in crate::machine) fn exact(value: impl Into<I32F32>) -> Number {
    Number::saturating(value.into())
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M503: every setting that G-code can set, and as a comment how far the look-ahead reaches.
    pub(in crate::machine) fn say_settings(&mut self) {
        self.say(format_args!("echo:  G21"));
        for setting in Setting::ALL {
            self.say_setting(setting);
        }
        self.say_driver_settings();
        self.say_space();
        let (soft, keepalive) = (u8::from(self.settings.soft_endstops), self.settings.keepalive_s);
        self.say(format_args!("echo:  M211 S{soft}"));
        self.say(format_args!("echo:  M113 S{keepalive}"));
        let lookahead = shortest(self.settings.lookahead_time);
        self.say(format_args!("echo:; Look-ahead: {lookahead} s"));
    }

    pub(in crate::machine) fn say_setting(&mut self, setting: Setting) {
        let s = &self.settings;
        match setting {
            Setting::Resolutions => self.say_axes("M92", s.axes.map(|a| exact(a.steps_per_mm)).to_array()),
            Setting::MaxSpeeds => self.say_axes("M203", s.axes.map(|a| exact(a.max_speed)).to_array()),
            Setting::MaxAccelerations => self.say_axes("M201", s.axes.map(|a| exact(a.max_acceleration)).to_array()),
            Setting::Accelerations => {
                let accelerations = [s.print_acceleration, s.retract_acceleration, s.travel_acceleration];
                let [p, r, t] = accelerations.map(exact);
                self.say(format_args!("echo:  M204 P{p} R{r} T{t}"));
            }
            Setting::Corners => {
                let [e, feed, travel] = [s.extruder_jerk, s.min_feed, s.min_travel].map(exact);
                match s.corner {
                    CornerRule::JunctionDeviation(d) => {
                        self.say(format_args!("echo:  M205 J{} E{e} S{feed} T{travel}", exact(d)));
                    }
                    CornerRule::SquareCorner(v) => {
                        let v = exact(v);
                        self.say(format_args!("echo:  M205 X{v} Y{v} E{e} S{feed} T{travel}"));
                    }
                }
            }
            Setting::VelocityLimit => {
                let ratio = shortest(s.minimum_cruise_ratio);
                self.say(format_args!("echo:  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO={ratio}"));
            }
            Setting::Shapers => {
                let shapers = s.shapers;
                self.say_shaper('X', shapers.x);
                self.say_shaper('Y', shapers.y);
            }
            Setting::Advance => {
                let [time, window] = [s.advance.time, s.advance.window].map(shortest);
                self.say(format_args!("echo:  M900 K{time}"));
                self.say(format_args!("echo:  M572 W{window}"));
            }
            Setting::Retraction => {
                let Retraction { length, speed, lift, .. } = self.retraction;
                let (length, feed, lift) = (exact(length), exact(Mm::from(speed) * 60), exact(lift));
                self.say(format_args!("echo:  M207 S{length} F{feed} Z{lift}"));
            }
            Setting::Recovery => {
                let Retraction { extra, recover_speed, .. } = self.retraction;
                let (extra, feed) = (exact(extra), exact(Mm::from(recover_speed) * 60));
                self.say(format_args!("echo:  M208 S{extra} F{feed}"));
            }
        }
    }

    /// Says the line of a command that takes a number for each axis.
    fn say_axes(&mut self, code: &str, values: [Number; 4]) {
        let [x, y, z, e] = values;
        self.say(format_args!("echo:  {code} X{x} Y{y} Z{z} E{e}"));
    }

    /// M503, the part that only a machine file sets, as comments: the reachable space, and how its axes are homed.
    fn say_space(&mut self) {
        let [x, y, z, _] = self.settings.axes.map(|a| exact(a.length)).to_array();
        self.say(format_args!("echo:; reachable: X{x} Y{y} Z{z} mm"));
        let homing = self.settings.homing;
        for (axis, homing) in [('X', homing.x), ('Y', homing.y), ('Z', homing.z)] {
            let (fast, slow, back) = (shortest(homing.fast), shortest(homing.slow), exact(homing.back_off));
            self.say(format_args!("echo:; homing {axis}: {fast} mm/s, {back} mm back, {slow} mm/s"));
        }
        let needed = if self.settings.require_homing { "needed before moves" } else { "not needed before moves" };
        self.say(format_args!("echo:; homing is {needed}"));
    }

    /// M503, the part of the drivers.
    fn say_driver_settings(&mut self) {
        if self.drivers.lines().is_empty() {
            return;
        }
        let groups = self.settings.drivers;
        for (group, axes) in [(groups.belt, "X Y"), (groups.z, "Z"), (groups.e, "E")] {
            self.say(format_args!("echo:  M569 S{} {axes}", u8::from(group.stealth)));
        }
        for value in [DriverValue::Current, DriverValue::HybridThreshold, DriverValue::StallThreshold] {
            let [belt, z, e] = [groups.belt, groups.z, groups.e].map(|group| value.number(&group));
            self.say_axes(value.code(), [belt, belt, z, e]);
        }
    }
}
