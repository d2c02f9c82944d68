//! Wall: error of the tool on the walls of a printed part, with a shaper and modes that give way.
//!
//! A shaper rounds a corner, because it spreads the command over a time with the standard deviation s: for slow changes
//! by `s^2/2` of the acceleration. But belts give way. The tool is behind the command, by `1/w^2` of the acceleration,
//! the other way. So the tool itself is off by `(s^2/2 - 1/w^2) a`, and most of the rounding cancels: of `a/w^2`, ZV
//! leaves 0.23, MZV 0.63 and EI 1.6.
//!
//! The same on whole walls, with ringing and corner speed. A square of 10 mm and a hole of 8 mm are driven with
//! trapezoids of speed. Each axis gives way by its modes,
//!
//! ```text
//! e'' + 2 z w e' + w^2 e = -y'',    tool = y + sum part e
//! ```
//!
//! and the distance of the shaped tool from their outlines is the error of the wall. The equation is solved exactly for
//! constant acceleration and for the jumps of speed at corners. On the square ringing counts most, on the hole
//! rounding.

use super::shaper::Impulse;
use crate::math::{self, exp, hypot, sin_cos};
use serde::Serialize;
use std::f64::consts::TAU;

/// Side of the square in mm, and sides that are driven.
const SIDE_MM: f64 = 10.0;
const SIDES: usize = 8;

/// Radius of the hole in mm, and turns that are driven.
const RADIUS_MM: f64 = 4.0;
const TURNS: f64 = 2.0;

/// Distance of the places in s; a straight line between two is right to `a / 8` of its square.
const STEP_S: f64 = 2e-4;

/// Ringing goes on for so long after the last corner, in s.
const REST_S: f64 = 0.06;

/// A mode of an axis, by which the tool lags behind the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Its frequency.
    pub frequency_hz: f64,
    /// Damping as a ratio to critical damping.
    pub damping_ratio: f64,
    /// Its part in the slow motion of the tool; all parts add up to 1.
    pub part: f64,
}

/// How the walls are printed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Print {
    /// Acceleration.
    pub acceleration_mm_s2: f64,
    /// Speed of the walls.
    pub speed_mm_s: f64,
    /// Speed at corners.
    pub corner_speed_mm_s: f64,
}

impl Default for Print {
    /// Acceleration and corner speed for which Klipper states its smoothing, at a usual speed of outer walls.
    fn default() -> Self {
        Self { acceleration_mm_s2: 5000.0, speed_mm_s: 100.0, corner_speed_mm_s: 5.0 }
    }
}

/// Error of a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WallError {
    /// Root mean square along the wall.
    pub rms_um: f64,
    /// Greatest.
    pub max_um: f64,
}

/// The error of slow changes of acceleration, in `a/w^2` of the strongest mode: positive is inside of a corner.
#[must_use]
pub fn net_rounding(impulses: &[Impulse], modes: &[Lag]) -> f64 {
    let mean: f64 = impulses.iter().map(|i| i.amount * i.time_s).sum();
    let variance: f64 = impulses.iter().map(|i| i.amount * math::square(i.time_s - mean)).sum();
    let softness = |mode: &Lag| mode.part / math::square(TAU * mode.frequency_hz);
    let lag: f64 = modes.iter().map(softness).sum();
    let unit = modes.first().map_or(1.0, |mode| 1.0 / math::square(TAU * mode.frequency_hz));
    (variance / 2.0 - lag) / unit
}

/// An event of the command of an axis: from here on this acceleration, after a jump of the speed.
#[derive(Clone, Copy)]
struct Event {
    at_s: f64,
    acceleration: f64,
    jump: f64,
}

/// A line that the tool should keep to.
#[derive(Clone, Copy, Debug)]
enum Outline {
    /// From (0, 0) to (side, side).
    Square,
    /// Around (0, 0).
    Hole,
}

/// The tool without a shaper at even times, for one machine; shapers are sums of it.
#[derive(Debug)]
pub struct Unshaped {
    parts: [(Outline, [Vec<f64>; 2]); 2],
}

impl Unshaped {
    /// With these modes along both axes, each frequency times `factor`.
    #[must_use]
    pub fn new(print: &Print, modes: &[Lag], factor: f64) -> Self {
        let part = |outline: Outline| {
            let (events, start, lasts) = match outline {
                Outline::Square => square(print),
                Outline::Hole => hole(print),
            };
            let count = ((lasts + REST_S) / STEP_S) as usize;
            let [x, y] = events.map(|events| tool(&events, modes, factor, count));
            let from = |axis: Vec<f64>, start: f64| axis.into_iter().map(|v| start + v).collect();
            (outline, [from(x, start[0]), from(y, start[1])])
        };
        Self { parts: [Outline::Square, Outline::Hole].map(part) }
    }

    /// Error of the walls with a shaper.
    #[must_use]
    pub fn error(&self, impulses: &[Impulse]) -> WallError {
        let end = impulses.last().map_or(0.0, |last| last.time_s);
        let taps: Vec<(f64, f64)> = impulses.iter().map(|i| (i.amount, i.time_s / STEP_S)).collect();
        let (mut squares, mut length, mut most) = (0.0, 0.0, 0.0_f64);
        for (outline, axes) in &self.parts {
            let mut before: Option<[f64; 2]> = None;
            for i in 0..axes[0].len() + (end / STEP_S).ceil() as usize {
                let place = axes
                    .each_ref()
                    .map(|axis| taps.iter().map(|(amount, late)| amount * at(axis, i as f64 - late)).sum::<f64>());
                let off = outline.distance(place);
                if let Some(before) = before {
                    let moved = hypot(place[0] - before[0], place[1] - before[1]);
                    squares += off * off * moved;
                    length += moved;
                }
                before = Some(place);
                most = most.max(off.abs());
            }
        }
        WallError { rms_um: 1000.0 * (squares / length.max(1e-9)).sqrt(), max_um: 1000.0 * most }
    }
}

impl Outline {
    /// Distance from the line.
    fn distance(self, place: [f64; 2]) -> f64 {
        match self {
            Self::Square => {
                let [x, y] = place.map(|v| (v - SIDE_MM / 2.0).abs() - SIDE_MM / 2.0);
                hypot(x.max(0.0), y.max(0.0)) + x.max(y).min(0.0)
            }
            Self::Hole => hypot(place[0], place[1]) - RADIUS_MM,
        }
    }
}

/// A value between two; the ends go on.
fn at(values: &[f64], place: f64) -> f64 {
    if place <= 0.0 {
        return values.first().copied().unwrap_or(0.0);
    }
    let (below, part) = (place as usize, place.fract());
    let last = values.last().copied().unwrap_or(0.0);
    let from = values.get(below).copied().unwrap_or(last);
    let to = values.get(below + 1).copied().unwrap_or(last);
    from + (to - from) * part
}

/// The command of both axes, where it begins, and its duration.
type Command = ([Vec<Event>; 2], [f64; 2], f64);

/// Round the square.
fn square(print: &Print) -> Command {
    let (a, vj) = (print.acceleration_mm_s2, print.corner_speed_mm_s.min(print.speed_mm_s));
    let (mut x, mut y, mut now) = (Vec::new(), Vec::new(), 0.0);
    for side in 0..SIDES {
        let own = if side % 2 == 0 { &mut x } else { &mut y };
        let sign = if side % 4 < 2 { 1.0 } else { -1.0 };
        let (from, to) = (if side == 0 { 0.0 } else { vj }, if side + 1 == SIDES { 0.0 } else { vj });
        // Highest speed that the side has room for.
        let top = print.speed_mm_s.min((a * SIDE_MM + (from * from + to * to) / 2.0).sqrt());
        let (up, down) = ((top - from) / a, (top - to) / a);
        let ramps = (top * top - from * from + top * top - to * to) / (2.0 * a);
        let cruise = (SIDE_MM - ramps).max(0.0) / top;
        own.push(Event { at_s: now, acceleration: sign * a, jump: sign * from });
        own.push(Event { at_s: now + up, acceleration: 0.0, jump: 0.0 });
        own.push(Event { at_s: now + up + cruise, acceleration: -sign * a, jump: 0.0 });
        now += up + cruise + down;
        own.push(Event { at_s: now, acceleration: 0.0, jump: -sign * to });
    }
    ([x, y], [0.0, 0.0], now)
}

/// Round the hole, in short times of constant acceleration.
fn hole(print: &Print) -> Command {
    let a = print.acceleration_mm_s2;
    // Centripetal acceleration is within the limit too.
    let way = TURNS * TAU * RADIUS_MM;
    let top = print.speed_mm_s.min((a * RADIUS_MM).sqrt()).min((a * way).sqrt());
    let (ramp, cruise) = (top / a, way / top - top / a);
    let (mut x, mut y, mut now) = (Vec::new(), Vec::new(), 0.0);
    for (lasts, from, along, before) in
        [(ramp, 0.0, a, 0.0), (cruise, top, 0.0, top * ramp / 2.0), (ramp, top, -a, way - top * ramp / 2.0)]
    {
        let count = (lasts / STEP_S).ceil().max(1.0) as usize;
        for i in 0..count {
            let t = (i as f64 + 0.5) * lasts / count as f64;
            let speed = from + along * t;
            let (sin, cos) = sin_cos((before + from * t + along * t * t / 2.0) / RADIUS_MM);
            let inwards = speed * speed / RADIUS_MM;
            let at_s = now + i as f64 * lasts / count as f64;
            x.push(Event { at_s, acceleration: -along * sin - inwards * cos, jump: 0.0 });
            y.push(Event { at_s, acceleration: along * cos - inwards * sin, jump: 0.0 });
        }
        now += lasts;
    }
    let rest = Event { at_s: now, acceleration: 0.0, jump: 0.0 };
    x.push(rest);
    y.push(rest);
    ([x, y], [RADIUS_MM, 0.0], now)
}

/// Places of an axis of the tool.
fn tool(events: &[Event], modes: &[Lag], factor: f64, count: usize) -> Vec<f64> {
    let mut axis = Axis { states: modes.iter().map(|mode| State::new(mode, factor)).collect(), ..Axis::default() };
    let mut next = events.iter().peekable();
    let place = |i: usize| {
        let to = i as f64 * STEP_S;
        while let Some(event) = next.next_if(|event| event.at_s <= to) {
            axis.advance(event.at_s);
            axis.turn(event);
        }
        axis.advance(to);
        axis.place()
    };
    (0..count).map(place).collect()
}

/// An axis under way: its command, and how far each mode is behind.
#[derive(Default)]
struct Axis {
    now_s: f64,
    commanded: f64,
    speed: f64,
    acceleration: f64,
    states: Vec<State>,
}

impl Axis {
    fn advance(&mut self, to_s: f64) {
        let (t, a) = (to_s - self.now_s, self.acceleration);
        self.commanded += self.speed * t + a * t * t / 2.0;
        self.speed += a * t;
        self.states.iter_mut().for_each(|state| state.advance(t, a));
        self.now_s = to_s;
    }

    /// The tool cannot jump, so it falls behind a jump of the command.
    fn turn(&mut self, event: &Event) {
        self.speed += event.jump;
        self.acceleration = event.acceleration;
        self.states.iter_mut().for_each(|state| state.speed -= event.jump);
    }

    fn place(&self) -> f64 {
        self.commanded + self.states.iter().map(|state| state.part * state.place).sum::<f64>()
    }
}

/// How far a mode is behind the command.
struct State {
    part: f64,
    omega: f64,
    damping: f64,
    place: f64,
    speed: f64,
}

impl State {
    fn new(mode: &Lag, factor: f64) -> Self {
        let omega = TAU * mode.frequency_hz * factor;
        Self { part: mode.part, omega, damping: mode.damping_ratio, place: 0.0, speed: 0.0 }
    }

    /// Exactly, while the command has this acceleration.
    fn advance(&mut self, t: f64, acceleration: f64) {
        let Self { omega, damping, .. } = *self;
        let rest = -acceleration / (omega * omega);
        let (decay, turn) = (damping * omega, omega * (1.0 - damping * damping).sqrt());
        let (off, speed) = (self.place - rest, self.speed);
        let (sin, cos) = sin_cos(turn * t);
        let left = exp(-decay * t);
        let b = (speed + decay * off) / turn;
        self.place = rest + left * (off * cos + b * sin);
        self.speed = left * (speed * cos - (decay * b + turn * off) * sin);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaping::shaper::{ShaperKind, impulses};

    fn mode(frequency_hz: f64, damping_ratio: f64) -> Lag {
        Lag { frequency_hz, damping_ratio, part: 1.0 }
    }

    /// pi^2/8 - 1 and so on, without damping.
    #[test]
    fn most_of_the_rounding_cancels() {
        let modes = [mode(60.0, 1e-6)];
        for (i, known, tolerance) in [(0, 0.2337, 1e-3), (1, 0.6262, 1e-3), (3, 1.59, 0.02)] {
            let net = net_rounding(&impulses(ShaperKind::ALL[i], 60.0, 1e-6), &modes);
            assert!((net - known).abs() < tolerance, "{}: {net}", ShaperKind::ALL[i].name());
        }
    }

    #[test]
    fn a_rigid_machine_without_a_shaper_keeps_to_the_outlines() {
        let none = [Impulse { amount: 1.0, time_s: 0.0 }];
        let error = Unshaped::new(&Print::default(), &[], 1.0).error(&none);
        assert!(error.max_um < 0.5, "{error:?}");
        // Slower than the side has room for, too.
        let weak = Print { acceleration_mm_s2: 300.0, speed_mm_s: 200.0, corner_speed_mm_s: 5.0 };
        assert!(Unshaped::new(&weak, &[], 1.0).error(&none).max_um < 0.5);
    }

    /// The solution by small steps, without the closed form.
    #[test]
    fn a_mode_follows_its_equation() {
        let mut state = State::new(&mode(50.0, 0.07), 1.0);
        state.speed = -5.0;
        let (mut e, mut v, dt) = (0.0, -5.0, 1e-7);
        let (w, z) = (TAU * 50.0, 0.07);
        for _ in 0..100_000 {
            v += (-3000.0 - 2.0 * z * w * v - w * w * e) * dt;
            e += v * dt;
        }
        state.advance(0.004, 3000.0);
        state.advance(0.006, 3000.0);
        assert!((state.place - e).abs() < 2e-5 && (state.speed / v - 1.0).abs() < 1e-2, "{} {e}", state.place);
    }

    /// On a hole at constant speed, the radius is off by the net rounding of the centripetal acceleration.
    #[test]
    fn a_hole_is_off_by_the_net_rounding() {
        let modes = [mode(60.0, 0.05)];
        let mut machine = Unshaped::new(&Print { speed_mm_s: 60.0, ..Print::default() }, &modes, 1.0);
        // The middle of the way alone.
        for (_, axes) in &mut machine.parts {
            axes.iter_mut().for_each(|axis| *axis = axis[axis.len() / 4..axis.len() / 2].to_vec());
        }
        let [_, (_, [x, y])] = &machine.parts;
        for shaper in [ShaperKind::Zv, ShaperKind::Mzv, ShaperKind::Ei] {
            let impulses = impulses(shaper, 60.0, 0.05);
            let place =
                |axis: &[f64]| impulses.iter().map(|i| i.amount * at(axis, 500.0 - i.time_s / STEP_S)).sum::<f64>();
            let off = RADIUS_MM - place(x).hypot(place(y));
            let known = net_rounding(&impulses, &modes) * (60.0 * 60.0 / RADIUS_MM) / (TAU * 60.0_f64).powi(2);
            assert!((off / known - 1.0).abs() < 0.05, "{}: {off} {known}", shaper.name());
        }
    }

    #[test]
    fn a_shaper_leaves_less_than_none_and_a_wrong_one_more() {
        let modes = [mode(50.0, 0.05)];
        let unshaped = Unshaped::new(&Print::default(), &modes, 1.0);
        let none = unshaped.error(&[Impulse { amount: 1.0, time_s: 0.0 }]);
        let right = unshaped.error(&impulses(ShaperKind::Zv, 50.0, 0.05));
        let wrong = unshaped.error(&impulses(ShaperKind::Zv, 80.0, 0.05));
        assert!(right.rms_um < 0.3 * none.rms_um && right.rms_um < wrong.rms_um, "{none:?} {right:?} {wrong:?}");
    }
}
