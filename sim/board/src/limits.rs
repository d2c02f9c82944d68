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
//! than `sqrt(8 a d)` may jump. For a turn with the share n of the axis, a is at most `A / n`. The jump of the axis is
//! n times that of the tool. No corner is taken with more than the commanded acceleration c, either. A square-corner
//! velocity w is the same law with `d = w^2 (sqrt 2 - 1) / c`, so an axis that bears less than c gets less than w.
//!
//! This is the table of corners (`Corners`): it is computed from the print's own words, and shares nothing with the
//! planner. The terms of a jump are
//!
//! | term | what it is |
//! |---|---|
//! | corner | the law above, for x, y, z and belt motors; the jerk for the extruder |
//! | cap | the jerk of z (M205 Z), if that is less |
//! | mesh | where z is capped: the jump of x and y in a corner, on a slope of `STEEPEST` |
//! | advance | the jump of the extruder enters and leaves the window of the pressure advance |
//! | stop | the speed of a touch, while something ends all motion (`Checker::stopped`) |
//!
//! A live offset of z (M290) stays within z's acceleration together with the moves, so it has no term. A rule for
//! corners counts if something moved under it: the block at a slicer's begin replaces the rules of the settings.
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
use corehbot::kinematics::{Group, Groups, direction};
use corehbot::settings::{Alignment, AxisEnd, AxisSettings, Belt, CornerRule, Settings, ranges};
use corehbot::storage::split_at_gap;
use corehbot::units::{Mm, MmPerSec, MmPerSec2, Seconds};
use corehbot_machine_file::NamedText;
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
    /// Greatest speed at which it may fall when an endstop stops the motion at once, then alone; 0 if nothing does.
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

/// The steepest slope of a mesh: 4 mm over 200 mm.
const STEEPEST: f64 = 0.02;

/// What is in force for corners: the rule, and the limits that count beside it.
#[derive(Clone, Copy, PartialEq)]
struct Corners {
    rule: CornerRule,
    /// Accelerations of moves that print, and of others.
    commanded: [f64; 2],
    /// Accelerations of x, y, z and e.
    own: [f64; 4],
    z: f64,
    extruder: f64,
}

impl Corners {
    fn of(s: &Settings) -> Self {
        Self {
            rule: s.corner,
            commanded: [s.print_acceleration, s.travel_acceleration].map(|a| a.to_num()),
            own: s.axes.map(|axis| axis.max_acceleration.to_num()).to_array(),
            z: s.z_jerk.to_num(),
            extruder: s.extruder_jerk.to_num(),
        }
    }

    /// The greatest jump of a coordinate that bears this acceleration and moves by `reach` for one of the tool.
    fn jump(&self, reach: f64, acceleration: f64) -> f64 {
        let of = |deviation: f64, commanded: f64| {
            let (own, tool) = (8.0 * reach * acceleration * deviation, 8.0 * commanded * deviation);
            own.sqrt().min(reach * tool.sqrt())
        };
        let jumps = self.commanded.map(|commanded| match self.rule {
            CornerRule::JunctionDeviation(d) => of(d.to_num(), commanded),
            CornerRule::SquareCorner(w) => of(square(w.to_num()) * (SQRT_2 - 1.0) / commanded, commanded),
        });
        jumps[0].max(jumps[1])
    }

    /// The greatest jump of z with this acceleration, where a corner makes x and y jump so.
    fn jump_of_z(&self, acceleration: f64, of_others: f64) -> f64 {
        self.jump(1.0, acceleration).min(self.z + STEEPEST * of_others)
    }

    /// Takes in a line of M204 (P, T, S) or M205. The firmware leaves a line alone of which a value is illegal.
    fn set(&mut self, code: f64, words: &[(char, f64)]) {
        let legal = |(letter, value): &(char, f64)| match (code as u32, letter) {
            (204, _) => ranges::ACCELERATION.holds(MmPerSec2::saturating_from_num(*value)),
            (_, 'J') => ranges::TOLERANCE.holds(Mm::saturating_from_num(*value)),
            (_, 'X' | 'Y' | 'E') => ranges::SPEED.holds(MmPerSec::saturating_from_num(*value)),
            _ => (0.0..=3000.0).contains(value),
        };
        if !words.iter().all(legal) {
            return;
        }
        let word = |wanted: char| words.iter().find(|(letter, _)| *letter == wanted).map(|(_, value)| *value);
        if code == 204.0 {
            let [print, travel] = self.commanded;
            self.commanded =
                [('P', print), ('T', travel)].map(|(letter, old)| word(letter).or(word('S')).unwrap_or(old));
            return;
        }
        let old = if let CornerRule::SquareCorner(w) = self.rule { w.to_num() } else { f64::INFINITY };
        let square = match (word('X'), word('Y')) {
            (Some(x), y) => Some(x.min(y.unwrap_or(x))),
            (None, y) => y.map(|y| y.min(old)),
        };
        if let Some(deviation) = word('J') {
            self.rule = CornerRule::JunctionDeviation(Mm::saturating_from_num(deviation));
        } else if let Some(w) = square {
            self.rule = CornerRule::SquareCorner(MmPerSec::saturating_from_num(w));
        }
        (self.z, self.extruder) = (word('Z').unwrap_or(self.z), word('E').unwrap_or(self.extruder));
    }
}

/// The rules for corners under which something may have moved.
struct Widest {
    now: Corners,
    /// Whether [`now`](Self::now) is among those that were used.
    is_used: bool,
    used: Vec<Corners>,
    /// The greatest accelerations under which the print has homed.
    homed: [f64; 4],
    /// Whether there is a pressure advance.
    has_advance: bool,
}

impl Widest {
    fn new(s: &Settings) -> Self {
        let has_advance = s.advance.time > Seconds::ZERO;
        Self { now: Corners::of(s), is_used: false, used: Vec::new(), homed: [0.0; 4], has_advance }
    }

    /// Something moves.
    fn use_it(&mut self) {
        if !std::mem::replace(&mut self.is_used, true) && !self.used.contains(&self.now) {
            self.used.push(self.now);
        }
    }

    fn change(&mut self, change: impl FnOnce(&mut Corners)) {
        change(&mut self.now);
        self.is_used = false;
    }
}

/// Lines under which no corner is passed: settings, modes, fans, temperatures, reports. In homing each move begins and
/// ends at rest.
fn stands(letter: char, code: f64) -> bool {
    let codes: &[f64] = match letter {
        'G' => &[17.0, 20.0, 21.0, 28.0, 90.0, 91.0, 92.0],
        'M' => &[
            73.0, 82.0, 83.0, 84.0, 92.0, 104.0, 105.0, 106.0, 107.0, 109.0, 110.0, 115.0, 117.0, 118.0, 140.0, 155.0,
            190.0, 201.0, 203.0, 204.0, 205.0, 220.0, 221.0, 413.0, 500.0, 503.0, 572.0, 593.0, 862.0, 900.0, 907.0,
        ],
        _ => &[],
    };
    // M862.3 is a number of its own.
    codes.contains(&code) || codes.contains(&code.trunc()) && letter == 'M' && code.trunc() == 862.0
}

/// Whether a command has that name.
fn is_named(command: &str, name: &str) -> bool {
    command.split_whitespace().next().is_some_and(|first| first.eq_ignore_ascii_case(name))
}

/// A line of a text with `{KEY:default}` as its default and `{KEY}` as nothing.
fn with_defaults(line: &str) -> String {
    let (mut filled, mut rest) = (Vec::new(), line.as_bytes());
    while let Some((before, gap, after)) = split_at_gap(rest) {
        filled.extend([before, gap.default.unwrap_or_default()].concat());
        rest = after;
    }
    filled.extend(rest);
    String::from_utf8_lossy(&filled).into_owned()
}

/// The number of a word `NAME=`.
fn pair(command: &str, name: &str) -> Option<f64> {
    let mut words = command.split_whitespace().filter_map(|word| word.split_once('='));
    words.rfind(|(known, _)| known.eq_ignore_ascii_case(name))?.1.trim_matches('"').parse().ok()
}

/// The time of pressure advance in s, if a command sets it.
fn advance_of(command: &str) -> Option<f64> {
    if is_named(command, "SET_PRESSURE_ADVANCE") {
        return pair(command, "ADVANCE");
    }
    let mut words = words(command);
    let letter = match words.next()? {
        ('M', Some(900.0)) => 'K',
        ('M', Some(572.0)) => 'S',
        _ => return None,
    };
    words.filter(|(known, _)| *known == letter).last()?.1
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
    settings: [Option<(Settings, Widest)>; 2],
    limits: Limits,
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
        if let Some(stored) = stored {
            limits.is_judged = stored.axes.map(|a| a.steps_per_mm) == s.axes.map(|a| a.steps_per_mm);
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
        let settings = [Some(s), stored].map(|s| s.map(|s| (*s, Widest::new(s))));
        Self { settings, limits, unit: 1.0 }
    }

    /// Takes in the limits set by a command of the print, without its comments.
    pub fn command(&mut self, command: &str) {
        let Self { settings, limits, unit } = self;
        for (s, widest) in settings.iter_mut().flatten() {
            limits.widen(command, s, widest, unit);
        }
    }

    /// Takes in the limits set by the owner's texts, any of which the print may call. Of a word of the call the default
    /// counts.
    pub fn texts(&mut self, texts: &[NamedText]) {
        for line in texts.iter().flat_map(|text| &text.lines) {
            self.command(&with_defaults(line));
        }
    }

    /// The limits of the whole print.
    #[must_use]
    pub fn finish(self) -> Limits {
        let Self { settings, mut limits, .. } = self;
        let belts = settings[0].as_ref().map(|(s, _)| belts(s)).unwrap_or_default();
        let mut has_advance = false;
        limits.of.iter_mut().take(4).for_each(|limit| limit.acceleration = 0.0);
        for (_, mut widest) in settings.into_iter().flatten() {
            widest.use_it();
            has_advance |= widest.has_advance;
            for accelerations in widest.used.iter().map(|corners| corners.own).chain([widest.homed]) {
                let both = limits.of.iter_mut().zip(accelerations);
                both.for_each(|(limit, a)| limit.acceleration = limit.acceleration.max(a));
            }
            widest.used.iter().for_each(|corners| limits.widen_jumps(corners, &belts));
        }
        if has_advance {
            limits.add_advance();
        }
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
        if let Some(time) = advance_of(command) {
            // The firmware leaves other lines alone.
            widest.has_advance |= time > 0.0 && ranges::ADVANCE.holds(Seconds::saturating_from_num(time));
            return;
        }
        if is_named(command, "SET_VELOCITY_LIMIT") {
            if let Some(w) = pair(command, "SQUARE_CORNER_VELOCITY").map(MmPerSec::saturating_from_num)
                && ranges::SPEED.holds(w)
            {
                widest.change(|corners| corners.rule = CornerRule::SquareCorner(w));
            }
            if let Some(a) = pair(command, "ACCEL").map(MmPerSec2::saturating_from_num)
                && ranges::ACCELERATION.holds(a)
            {
                widest.change(|corners| corners.commanded = [a.to_num(); 2]);
            }
            return;
        }
        // As it is built in, it homes.
        if ["START_PRINT", "PRINT_START"].into_iter().any(|name| is_named(command, name)) {
            return self.widen("G28", s, widest, unit);
        }
        self.trims |= is_named(command, "STEPPER_BUZZ");
        self.levels |= ["Z_TILT_ADJUST", "QUAD_GANTRY_LEVEL"].into_iter().any(|name| is_named(command, name));
        let mut words = words(command);
        let Some((letter, Some(code))) = words.next() else {
            widest.use_it();
            return;
        };
        let wide = |slot: &mut f64, value: f64| *slot = slot.max(value);
        if !stands(letter, code) {
            widest.use_it();
        }
        match (letter, code) {
            ('G', 0.0 | 1.0) if words.clone().any(|(letter, _)| letter == 'C') => self.circulates |= s.belt.is_closed,
            ('G', 34.0) => self.levels = true,
            ('M', 501.0 | 502.0) => widest.change(|corners| *corners = Corners::of(s)),
            ('G', 20.0) => *unit = 25.4,
            ('G', 21.0) => *unit = 1.0,
            ('M', 915.0) => self.trims = true,
            ('G', 28.0) => {
                let both = widest.homed.iter_mut().zip(widest.now.own);
                both.for_each(|(most, a)| *most = most.max(a));
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
                    if code == 201.0 {
                        widest.change(|corners| corners.own[i] = v);
                    } else {
                        wide(&mut self.of[i].speed, v);
                    }
                }
            }
            ('M', 204.0 | 205.0) => {
                let words: Vec<_> = words.filter_map(|(what, value)| Some((what, value? * *unit))).collect();
                widest.change(|corners| corners.set(code, &words));
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

    /// Takes in the jumps of speed under these rules.
    fn widen_jumps(&mut self, corners: &Corners, belts: &[Group]) {
        let of_others = corners.own[0..2].iter().map(|own| corners.jump(1.0, *own)).sum();
        for (i, limit) in self.of.iter_mut().enumerate() {
            // A unit vector of the tool reaches the length of the row in a belt coordinate: sqrt 2 if it sums two axes.
            let belt = i.checked_sub(4).and_then(|i| belts.get(i));
            let reach = belt.map_or(1.0, |belt| {
                direction(belt.row).map(|times| square(f64::from(times))).iter().sum::<f64>().sqrt()
            });
            let own = corners.own.get(i).copied().unwrap_or(limit.acceleration);
            let jump = match i {
                2 => corners.jump_of_z(own, of_others),
                3 => corners.extruder,
                _ => corners.jump(reach, own),
            };
            limit.jump = limit.jump.max(jump);
        }
    }

    /// Adds the jumps of pressure advance.
    fn add_advance(&mut self) {
        self.of[3].jump *= 3.0;
    }
}

#[cfg(test)]
mod tests;
