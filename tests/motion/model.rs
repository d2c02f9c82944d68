//! An independent model of look-ahead and trapezoids, in floating point and with the whole path known.
//!
//! It shares no code with the planner. It follows the firmware's documentation. This covers the line of moves of at
//! least 1 mm along x or y, on which the belt motors stand. It also covers the junction-deviation law, the trend of the
//! path, the minimum cruise ratio, and the limits.

use corehbot::settings::{CornerRule, Settings};

/// One move: where it ends in steps, and its trapezoid.
#[derive(Clone, Debug)]
pub struct Trapezoid {
    pub from: [f64; 4],
    pub to: [f64; 4],
    pub length: f64,
    pub entry: f64,
    pub peak: f64,
    pub exit: f64,
    pub a: f64,
}

impl Trapezoid {
    pub fn rise(&self) -> f64 {
        (self.peak.powi(2) - self.entry.powi(2)) / (2.0 * self.a)
    }

    pub fn fall(&self) -> f64 {
        (self.peak.powi(2) - self.exit.powi(2)) / (2.0 * self.a)
    }

    pub fn time(&self) -> f64 {
        let level = (self.length - self.rise() - self.fall()).max(0.0);
        (2.0 * self.peak - self.entry - self.exit) / self.a + level / self.peak
    }

    /// Where all axes are after `t` s, before its begin and after its end too.
    pub fn at(&self, t: f64) -> [f64; 4] {
        let rise = (self.peak - self.entry) / self.a;
        let fall = (self.peak - self.exit) / self.a;
        let whole = self.time();
        let t = t.clamp(0.0, whole);
        let s = if t < rise {
            self.entry * t + self.a * t * t / 2.0
        } else if t < whole - fall {
            self.rise() + self.peak * (t - rise)
        } else {
            let left = whole - t;
            self.length - self.exit * left - self.a * left * left / 2.0
        };
        let f = if t >= whole { 1.0 } else { s / self.length };
        std::array::from_fn(|i| self.from[i] + f * (self.to[i] - self.from[i]))
    }

    /// The time in s at the fraction `f` of the length.
    pub fn when(&self, f: f64) -> f64 {
        let s = f * self.length;
        if s <= self.rise() {
            return ((self.entry.powi(2) + 2.0 * self.a * s).sqrt() - self.entry) / self.a;
        }
        let left = self.length - s;
        if left <= self.fall() {
            let back = ((self.exit.powi(2) + 2.0 * self.a * left).max(0.0).sqrt() - self.exit) / self.a;
            return self.time() - back;
        }
        (self.peak - self.entry) / self.a + (s - self.rise()) / self.peak
    }
}

struct Way {
    from: [f64; 4],
    to: [f64; 4],
    length: f64,
    unit: [f64; 3],
    ratio: f64,
    speed: f64,
    a: f64,
    /// The acceleration that is commanded for its purpose.
    commanded: f64,
}

fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| p * q).sum()
}

fn way(from: [f64; 4], asked: [f64; 4], target: [f64; 4], speed: f64, s: &Settings) -> Option<Way> {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    // An axis with the same target again stays where it is.
    let mut to: [f64; 4] = std::array::from_fn(|i| if target[i] == asked[i] { from[i] } else { target[i] * pitch[i] });
    let mm = |to: [f64; 4]| -> [f64; 4] { std::array::from_fn(|i| (to[i] - from[i]) / pitch[i]) };
    let mut d = mm(to);
    let mut tool = dot([d[0], d[1], d[2]], [d[0], d[1], d[2]]).sqrt();
    if tool < 0.000_5 {
        // Too short to be a move of the tool.
        to = [from[0], from[1], from[2], to[3]];
        d = mm(to);
        tool = 0.0;
    }
    let length = if tool > 0.0 { tool } else { d[3].abs() };
    if length < 0.000_5 {
        return None;
    }
    let unit = [d[0] / length, d[1] / length, d[2] / length];
    let ratio = d[3] / length;
    let bound = |wanted: f64, axes: [f64; 4], motor: f64| {
        let shares = [unit[0], unit[1], unit[2], ratio];
        let mut v = wanted;
        for (share, most) in shares.iter().zip(axes) {
            if share.abs() > 0.0 {
                v = v.min(most / share.abs());
            }
        }
        for share in [unit[0] + unit[1], unit[0] - unit[1]] {
            if share.abs() > 0.0 {
                v = v.min(motor / share.abs());
            }
        }
        v
    };
    let wanted = if tool == 0.0 {
        s.retract_acceleration
    } else if d[3] != 0.0 {
        s.print_acceleration
    } else {
        s.travel_acceleration
    };
    let speeds = s.axes.map(|a| a.max_speed.to_num::<f64>()).to_array();
    let accelerations = s.axes.map(|a| a.max_acceleration.to_num::<f64>()).to_array();
    Some(Way {
        from,
        to,
        length,
        unit: if tool > 0.0 { unit } else { [0.0; 3] },
        ratio,
        speed: bound(speed, speeds, s.motor_max_speed.to_num()),
        a: bound(wanted.to_num(), accelerations, s.motor_max_acceleration.to_num()),
        commanded: wanted.to_num(),
    })
}

/// The known part of the path behind. It holds the lead of its direction over its means over 0.08 to 1.28 mm. It also
/// holds its lead over a velocity that keeps to the acceleration, and the greatest recent one.
#[derive(Default)]
struct Path {
    ahead: [[f64; 3]; 5],
    lead: [f64; 3],
    greatest: f64,
}

fn sum(p: [f64; 3], q: [f64; 3], times: f64) -> [f64; 3] {
    std::array::from_fn(|i| p[i] + times * q[i])
}

fn size(p: [f64; 3]) -> f64 {
    dot(p, p).sqrt()
}

/// The greatest speed through the corner from `p` to `q`, and the path goes on along `q`.
fn corner(p: &Way, q: &Way, path: &mut Path, s: &Settings) -> f64 {
    let (still_p, still_q) = (p.unit == [0.0; 3], q.unit == [0.0; 3]);
    let most = p.speed.min(q.speed);
    if still_p || still_q {
        *path = Path::default();
        return if still_p && still_q && p.ratio.signum() == q.ratio.signum() { most } else { 0.0 };
    }
    let half = ((1.0 + dot(p.unit, q.unit)) / 2.0).max(0.0).sqrt();
    // The change of direction, and the limits of the axes along it.
    let turn = sum(q.unit, p.unit, -1.0);
    let along = |wanted: f64, turn: [f64; 3], axes: [f64; 4], motor: f64| {
        [turn[0], turn[1], turn[2], turn[0] + turn[1], turn[0] - turn[1]]
            .iter()
            .zip([axes[0], axes[1], axes[2], motor, motor])
            .map(|(share, most)| most * size(turn) / share.abs())
            .fold(wanted, f64::min)
    };
    let axes = s.axes.map(|a| a.max_acceleration.to_num::<f64>()).to_array();
    let bears = |turn| along(q.a, turn, axes, s.motor_max_acceleration.to_num());
    // The difference of two neighbouring means, less its rounding error, is the turn of the path over the shorter
    // distance.
    let mut curve = f64::INFINITY;
    let x = q.length / 1.28;
    let wide = 1.0 + x + x.powi(2) / 2.0 + x.powi(3) / 6.0 + x.powi(4) / 24.0;
    let mut sharpest = 0.0;
    // The turn over 0.08 mm before this corner goes to the same side.
    let goes_on = dot(path.ahead[4], turn) > 0.25 * dot(turn, turn);
    for (i, ahead) in path.ahead.iter_mut().enumerate() {
        *ahead = sum(*ahead, turn, 1.0).map(|v| v / wide.powi(1 << i));
    }
    for i in 1..5 {
        let (bend, distance) = (sum(path.ahead[i - 1], path.ahead[i], -1.0), 1.28 / f64::from(1 << i));
        let curvature = (size(bend) - 0.0006 / distance) / distance;
        if curvature > sharpest {
            sharpest = curvature;
            curve = bears(bend) / curvature;
        }
    }
    // All corners of a bend together count as one, less the part that time makes up for.
    let (lead, past) = (sum(path.lead, turn, 1.0), path.greatest);
    let greatest = size(lead).max(past);
    let mut bend = curve;
    if greatest > 1e-6 {
        let a = bears(if size(lead) > size(turn) + 1e-12 { lead } else { turn });
        let [first, base] = match s.corner {
            CornerRule::JunctionDeviation(d) => [f64::INFINITY, a * d.to_num::<f64>()],
            // For each move what it bears, as a part of what is commanded.
            CornerRule::SquareCorner(w) => {
                [p.a / p.commanded, a / q.commanded].map(|part| part * w.to_num::<f64>().powi(2) * (2f64.sqrt() - 1.0))
            }
        };
        let jump = |turn: f64| 8.0 * base / turn.powi(2);
        if size(turn) > 1e-6 {
            let base = base.min(first);
            let jump = |turn: f64| 8.0 * base / turn.powi(2);
            let (arc, row) = (base * half / (1.0 - half).max(1e-30), jump(size(lead) + past));
            // A row of chords is a circle: its radius is half a chord over the tangent of half the turn.
            let circle = |chord: f64, turn: f64| a * chord * half / turn.max(1e-30);
            let shorter = p.length.min(q.length);
            let least = arc.min(circle(shorter, size(turn)));
            bend = bend.min(if shorter >= 1.0 {
                row.min(least)
            } else {
                // The same corner may come again.
                let chord = if p.length.max(q.length) >= 1.0 { shorter } else { (p.length + q.length) / 2.0 };
                let own = if goes_on && chord < 0.08 { 0.0 } else { 0.25 * arc };
                let again = circle(chord, size(turn)).max(own);
                let is_known = curve < 1.05 * again;
                arc.min(row).min(if is_known { f64::INFINITY } else { again }).max(least)
            });
        }
        let speeds = s.axes.map(|a| a.max_speed.to_num::<f64>()).to_array();
        let fastest = along(f64::INFINITY, q.unit, speeds, s.motor_max_speed.to_num()).min(speeds[3] / q.ratio.abs());
        let gain = a * q.length;
        let slow = bend.min(jump(greatest)).min(fastest.powi(2));
        // Corners more than 4 ms apart belong to different bends.
        let is_over = q.length >= 0.004 * slow.sqrt() + 0.5 * q.a * 0.004f64.powi(2);
        let made_up = if is_over { f64::INFINITY } else { 1.15 * gain / slow.max(gain) };
        path.lead = lead.map(|v| v * (1.0 - made_up / size(lead).max(1e-30)).max(0.0));
        path.greatest = (greatest - made_up).max(0.0);
    }
    let jump = (p.ratio - q.ratio).abs();
    let jerk = if jump > 0.0 { s.extruder_jerk.to_num::<f64>() / jump } else { f64::INFINITY };
    // Less what rounding to a thousandth makes of the slope.
    let rise = turn[2].abs() - 0.001 / p.length - 0.001 / q.length;
    let z_jerk = if rise > 0.0 { s.z_jerk.to_num::<f64>() / rise } else { f64::INFINITY };
    most.min(bend.sqrt()).min(jerk).min(z_jerk)
}

/// Between which places the ways are really gone. An axis that is not asked to move stays where it is. In a long move
/// along x or y that is where the belt motors' counts say that it is, from the begin on.
fn gone(ways: &[Way]) -> Vec<([f64; 4], [f64; 4])> {
    let mut place = [0.0; 4];
    ways.iter()
        .map(|w| {
            let moves = |i: usize| w.from[i] != w.to[i];
            let mut from = place;
            let mut to: [f64; 4] = std::array::from_fn(|i| if moves(i) { w.to[i] } else { place[i] });
            if w.unit != [0.0; 3] && w.length >= 1.0 && moves(0) != moves(1) {
                let (u, v) = ((place[0] + place[1]).round(), (place[0] - place[1]).round());
                let other = usize::from(moves(0));
                from[other] = if other == 0 { (u + v) / 2.0 } else { (u - v) / 2.0 };
                to[other] = from[other];
            }
            place = to;
            (from, to)
        })
        .collect()
}

/// The trapezoids of a path from the origin, planned with all of it in view.
pub fn trapezoids(targets: &[([f64; 4], f64)], s: &Settings) -> Vec<Trapezoid> {
    let mut ways: Vec<Way> = Vec::new();
    let mut at = [0.0; 4];
    let mut asked = [0.0; 4];
    for (target, speed) in targets {
        if let Some(w) = way(at, asked, *target, *speed, s) {
            at = w.to;
            ways.push(w);
        }
        asked = *target;
    }
    let mut path = Path::default();
    let mut entry: Vec<f64> =
        (0..ways.len()).map(|i| if i == 0 { 0.0 } else { corner(&ways[i - 1], &ways[i], &mut path, s) }).collect();
    entry.push(0.0);
    for i in (0..ways.len()).rev() {
        entry[i] = entry[i].min((entry[i + 1].powi(2) + 2.0 * ways[i].a * ways[i].length).sqrt());
    }
    for i in 0..ways.len() {
        entry[i + 1] = entry[i + 1].min((entry[i].powi(2) + 2.0 * ways[i].a * ways[i].length).sqrt());
    }
    let gone = gone(&ways);
    ways.iter()
        .enumerate()
        .map(|(i, w)| {
            let (from, to) = gone[i];
            // Both ramps together are at most so long, if the ends allow it; the extruder alone need not cruise.
            let cruise = if w.unit == [0.0; 3] { 0.0 } else { s.minimum_cruise_ratio.to_num::<f64>() };
            let ramps = w.length * (1.0 - cruise);
            let meet = ((entry[i].powi(2) + entry[i + 1].powi(2)) / 2.0 + w.a * ramps).sqrt();
            let meet = meet.max(entry[i]).max(entry[i + 1]);
            Trapezoid {
                from,
                to,
                length: w.length,
                entry: entry[i],
                peak: w.speed.min(meet),
                exit: entry[i + 1],
                a: w.a,
            }
        })
        .collect()
}

/// The instants in s at which a coordinate crosses from one step to the next within a trapezoid, counted from its
/// begin. `row` gives the coordinate as a sum of x, y, z and e.
pub fn crossings(t: &Trapezoid, row: [f64; 4]) -> Vec<(f64, i8)> {
    let value = |p: &[f64; 4]| -> f64 { p.iter().zip(row).map(|(p, r)| p * r).sum() };
    let (from, to) = (value(&t.from), value(&t.to));
    let mut all = Vec::new();
    if to > from {
        let mut edge = (from - 0.5).floor() + 1.5;
        while edge <= to {
            if edge > from {
                all.push((t.when((edge - from) / (to - from)), 1));
            }
            edge += 1.0;
        }
    } else if to < from {
        let mut edge = (from + 0.5).ceil() - 1.5;
        while edge > to {
            if edge <= from {
                all.push((t.when((edge - from) / (to - from)), -1));
            }
            edge -= 1.0;
        }
    }
    all
}
