//! Limits: the bounds of each axis in a print, for the checker.
//!
//! They come from the settings, widened by the limits that the print itself sets (M201, M203, M205). The checker sees
//! only steps and cannot know when a command took effect, so the widest limit counts for the whole print. Stored
//! settings count too, next to the settings at the machine's start.
//!
//! # Jumps of speed
//! A corner may change the speed at once. Under junction deviation d, a corner of half angle t (between the moves) is
//! taken at `v^2 = a d s / (1 - s)` with `s = sin t`. The change of velocity is `2 v cos t`. Its square is
//! `4 a d s (1 + s)`, at most `8 a d` however flat the corner. So along an axis that bears the acceleration a, no more
//! than `sqrt(8 a d)` may jump. A square-corner velocity w is the same law with `a d = w^2 (sqrt 2 - 1)`.
//!
//! # Shaping
//! An input shaper is a mean of the path at several times, which is no faster than the path. Pressure advance K over a
//! window h pushes the filament ahead by `K (e(t + h/2) - e(t - h/2)) / h`. That adds `(q(t + h/2) - q(t - h/2)) / h`
//! to the extruder's speed, where q is K times the speed of printed filament.
//!
//! The planner keeps the sum within the extruder's speed and acceleration
//! (docs/explanation/shaping.md#what-the-extruder-bears), so neither limit is wider for an advance. A corner's jump
//! enters the window and leaves it again, each time as a jump of its own within the extruder's jerk. Both, and a
//! corner's own jump, may fall into one measurement.

use crate::file_line::{command_of, words};
use corehbot::gcode::{Command, MotionCommand, MotorCommand, Number, SettingCommand, VelocityWords, parse};
use corehbot::kinematics::{Group, Groups, direction};
use corehbot::settings::{Alignment, AxisEnd, AxisSettings, Belt, CornerRule, Settings, ranges};
use corehbot::units::{Mm, Seconds};
use corehbot_rig::bed::has_probe;
use corehbot_twin::math::square;
use std::f64::consts::SQRT_2;

/// The limits of one coordinate, in mm and s.
#[derive(Clone, PartialEq, Debug)]
pub struct Limit {
    /// The coordinate's name in messages.
    pub name: String,
    /// Length of one step.
    pub step: f64,
    /// Greatest speed.
    pub speed: f64,
    /// Greatest acceleration.
    pub acceleration: f64,
    /// Greatest sudden change of speed in a corner.
    pub jump: f64,
    /// Greatest speed at which it may fall when an endstop stops the motion at once; 0 if nothing does.
    pub hard_stop: f64,
    /// The same if it grows.
    pub hard_stop_up: f64,
}

/// The limits of x, y, z, e and of the coordinates of the belt motors, in this order.
#[derive(Clone, PartialEq, Debug)]
pub struct Limits {
    /// One limit a coordinate.
    pub of: Vec<Limit>,
    /// Whether speeds and accelerations can be judged: not if steps/mm change under way (M92, M501).
    pub is_judged: bool,
    /// Whether a closed belt may run round: motors that are one group then step each for itself.
    pub circulates: bool,
    /// Whether motors of one belt may be turned against each other, one at a time.
    pub trims: bool,
    /// Motors of z turn alone.
    pub levels: bool,
}

/// Settings of corners and of the advance, the widest that were in force.
struct Widest {
    deviation: f64,
    square: f64,
    extruder: f64,
    /// Whether there is a pressure advance.
    has_advance: bool,
}

impl Widest {
    const NONE: Self = Self { deviation: 0.0, square: 0.0, extruder: 0.0, has_advance: false };

    /// Takes in the limits of one set of settings.
    fn widen(&mut self, s: &Settings) {
        self.extruder = self.extruder.max(s.extruder_jerk.to_num());
        match s.corner {
            CornerRule::JunctionDeviation(d) => self.deviation = self.deviation.max(d.to_num()),
            CornerRule::SquareCorner(w) => self.square = self.square.max(w.to_num()),
        }
        self.has_advance |= s.advance.time > Seconds::ZERO;
    }
}

/// Limits of the settings alone.
fn limits_of(s: &Settings) -> Vec<Limit> {
    // A step of the motor that makes the fewest for a step of the axis.
    let fewest =
        |axis: usize| s.mechanism.rows.iter().map(|row| row[axis].unsigned_abs()).filter(|times| *times > 0).min();
    let axis = |name: &str, a: AxisSettings| Limit {
        name: name.to_owned(),
        step: 1.0 / (a.steps_per_mm.to_num::<f64>() * f64::from("xyze".find(name).and_then(fewest).unwrap_or(1))),
        speed: a.max_speed.to_num(),
        acceleration: a.max_acceleration.to_num(),
        jump: 0.0,
        hard_stop: 0.0,
        hard_stop_up: 0.0,
    };
    let belt = |group: &Group| Limit {
        step: 1.0 / s.steps_per_mm(group.lead).to_num::<f64>(),
        speed: s.motor_max_speed.to_num(),
        acceleration: s.motor_max_acceleration.to_num(),
        ..axis(&belt_name(s, group), s.axes.x)
    };
    let a = s.axes;
    let mut limits = vec![axis("x", a.x), axis("y", a.y), axis("z", a.z), axis("e", a.e)];
    limits.extend(belts(s).iter().map(belt));
    limits
}

/// The groups for which the limits of a belt motor hold, in the order of [`Limits::of`] after the axes.
#[must_use]
pub fn belts(s: &Settings) -> Vec<Group> {
    Groups::new(&s.mechanism).iter().filter(|group| group.is_belt()).copied().collect()
}

/// `belt 4/11`: its motors by their names, a leading m apart, so those of a CoreH-bot by the numbers of their pulleys.
fn belt_name(s: &Settings, group: &Group) -> String {
    let names = group.motors().iter().map(|motor| s.name_of(motor).as_str().trim_start_matches('m').to_owned());
    format!("belt {}", names.collect::<Vec<_>>().join("/"))
}

/// Limits that grow with the commands of a print.
pub struct Widening {
    settings: [Option<Settings>; 2],
    limits: Limits,
    widest: Widest,
    /// mm in the unit of the print.
    unit: f64,
}

/// Whether motors are trimmed as they get power.
fn has_phases(s: &Settings) -> bool {
    s.belt.phases.iter().any(|phase| *phase < Belt::NO_PHASE)
}

impl Widening {
    /// The limits of a machine that was made with settings `s` and has others `stored`.
    #[must_use]
    pub fn new(s: &Settings, stored: Option<&Settings>) -> Self {
        let mut limits =
            Limits { of: limits_of(s), is_judged: true, circulates: false, trims: has_phases(s), levels: false };
        let mut widest = Widest::NONE;
        widest.widen(s);
        if let Some(stored) = stored {
            limits.is_judged = stored.axes.map(|a| a.steps_per_mm) == s.axes.map(|a| a.steps_per_mm);
            widest.widen(stored);
            limits.trims |= has_phases(stored);
            for (limit, other) in limits.of.iter_mut().zip(limits_of(stored)) {
                limit.speed = limit.speed.max(other.speed);
                limit.acceleration = limit.acceleration.max(other.acceleration);
            }
        }
        // Commands of many names lower the probe, and it stops Z alone.
        for s in [Some(s), stored].into_iter().flatten().filter(|s| has_probe(s)) {
            limits.allow_stops(s, [0.0, 0.0, s.probe.fast.to_num()], [AxisEnd::Min; 3]);
        }
        Self { settings: [Some(*s), stored.copied()], limits, widest, unit: 1.0 }
    }

    /// Takes in the limits set by a command of the print, without its comments.
    pub fn command(&mut self, command: &str) {
        let Self { settings, limits, widest, unit } = self;
        for s in settings.iter().flatten() {
            limits.widen(command, s, widest, unit);
        }
    }

    /// The limits of the whole print.
    #[must_use]
    pub fn finish(self) -> Limits {
        let Self { settings, mut limits, widest, .. } = self;
        let belts = settings[0].as_ref().map(belts).unwrap_or_default();
        limits.set_jumps(&widest, &belts);
        limits.add_advance(&widest);
        limits
    }
}

impl Limits {
    /// The limits of a machine that was made with settings `s`, has others `stored`, and runs `gcode`.
    #[must_use]
    pub fn new(s: &Settings, stored: Option<&Settings>, gcode: &str) -> Self {
        let mut limits = Widening::new(s, stored);
        for line in gcode.lines() {
            limits.command(&command_of(line).0);
        }
        limits.finish()
    }

    /// Takes in the limits set by one command.
    fn widen(&mut self, command: &str, s: &Settings, widest: &mut Widest, unit: &mut f64) {
        if let Command::Setting(SettingCommand::Advance { time: Some(time), .. }) = parse(command.as_bytes()) {
            // The firmware leaves other lines alone.
            widest.has_advance |=
                time > Number::ZERO && ranges::ADVANCE.holds(Seconds::saturating_from_num(time.value()));
            return;
        }
        if let Command::Setting(SettingCommand::VelocityLimit(VelocityWords { square_corner: Some(number), .. })) =
            parse(command.as_bytes())
        {
            widest.square = widest.square.max(number.value().to_num());
            return;
        }
        match parse(command.as_bytes()) {
            Command::Motor(MotorCommand::Buzz { .. }) => self.trims = true,
            Command::Motor(MotorCommand::LevelScrews(_)) => self.levels = true,
            _ => {}
        }
        if let Command::Motion(MotionCommand::Circulate { .. }) = parse(command.as_bytes()) {
            self.circulates |= s.belt.is_closed;
        }
        let mut words = words(command);
        let Some((letter, Some(code))) = words.next() else { return };
        let wide = |slot: &mut f64, value: f64| *slot = slot.max(value);
        match (letter, code) {
            ('G', 20.0) => *unit = 25.4,
            ('G', 21.0) => *unit = 1.0,
            ('M', 915.0) => self.trims = true,
            ('G', 28.0) => {
                self.trims |= s.belt.alignment == Alignment::Automatic;
                self.circulates |= s.belt.is_closed && s.belt.homing_advance > Mm::ZERO;
                let homing = s.homing.to_array().map(|h| h.fast.to_num::<f64>());
                self.allow_stops(s, homing, s.endstops.to_array().map(|switch| switch.end));
            }
            ('M', 112.0) => self.of.iter_mut().for_each(|l| l.hard_stop = f64::INFINITY),
            ('M', 92.0) => self.is_judged = false,
            ('M', 201.0 | 203.0) => {
                let most =
                    if code == 201.0 { ranges::ACCELERATION.most.to_num::<f64>() } else { ranges::SPEED.most.to_num() };
                let named = words.filter_map(|(axis, value)| Some(("XYZE".find(axis)?, value? * *unit)));
                let named: Vec<_> = named.collect();
                // With one value out of range the firmware leaves the line alone.
                let legal = named.iter().all(|(_, v)| *v > 0.0 && *v <= most);
                for (i, v) in named.into_iter().filter(|_| legal) {
                    let limit = &mut self.of[i];
                    wide(if code == 201.0 { &mut limit.acceleration } else { &mut limit.speed }, v);
                }
            }
            ('M', 205.0) => {
                for (what, value) in words {
                    let v = value.unwrap_or(0.0) * *unit;
                    match what {
                        'J' => wide(&mut widest.deviation, v),
                        'X' | 'Y' => wide(&mut widest.square, v),
                        'E' => wide(&mut widest.extruder, v),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }

    /// Endstops may stop each axis at such a speed on its way to that end.
    fn allow_stops(&mut self, s: &Settings, speeds: [f64; 3], ends: [AxisEnd; 3]) {
        let stop = |limit: &mut Limit, speed: f64, end: AxisEnd| {
            let slot = match end {
                AxisEnd::Min => &mut limit.hard_stop,
                AxisEnd::Max => &mut limit.hard_stop_up,
            };
            *slot = slot.max(speed);
        };
        self.of.iter_mut().zip(speeds.into_iter().zip(ends)).for_each(|(limit, (v, end))| stop(limit, v, end));
        for (limit, belt) in self.of.iter_mut().skip(4).zip(belts(s)) {
            for (times, (v, end)) in belt.row.into_iter().zip(speeds.into_iter().zip(ends)) {
                match times {
                    1.. => stop(limit, v, end),
                    0 => {}
                    ..0 => stop(limit, v, end.other()),
                }
            }
        }
    }

    fn set_jumps(&mut self, widest: &Widest, belts: &[Group]) {
        let law = |reach: f64, acceleration: f64| {
            let deviation = (8.0 * reach * acceleration * widest.deviation).sqrt();
            let square = reach * widest.square * (8.0 * (SQRT_2 - 1.0)).sqrt();
            deviation.max(square)
        };
        for (i, limit) in self.of.iter_mut().enumerate() {
            // A unit vector of the tool reaches the length of the row in a belt coordinate: sqrt 2 if it sums two axes.
            let belt = i.checked_sub(4).and_then(|i| belts.get(i));
            let reach = belt.map_or(1.0, |belt| {
                direction(belt.row).map(|times| square(f64::from(times))).iter().sum::<f64>().sqrt()
            });
            limit.jump = if i == 3 { widest.extruder } else { law(reach, limit.acceleration) };
        }
    }

    /// Adds the jumps of pressure advance.
    fn add_advance(&mut self, widest: &Widest) {
        let e = &mut self.of[3];
        e.jump *= if widest.has_advance { 3.0 } else { 1.0 };
    }
}

#[cfg(test)]
mod tests;
