//! An independent model of look-ahead and trapezoids, in floating point and with the whole path known.
//!
//! It shares no code with the planner. What it takes from the firmware's documentation: moves of at least
//! 1 mm in x or y end on whole steps of x and y, the junction-deviation law, the trend of the path, the minimum cruise
//! ratio, and the limits.

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

    /// When the fraction `f` of the way is behind, in s.
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
}

fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| p * q).sum()
}

fn way(from: [f64; 4], asked: [f64; 4], target: [f64; 4], speed: f64, s: &Settings) -> Option<Way> {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    // An axis that is asked for the same again stays where it is.
    let mut to: [f64; 4] = std::array::from_fn(|i| if target[i] == asked[i] { from[i] } else { target[i] * pitch[i] });
    let mm = |to: [f64; 4]| -> [f64; 4] { std::array::from_fn(|i| (to[i] - from[i]) / pitch[i]) };
    let d = mm(to);
    if d[0].abs().max(d[1].abs()) >= 1.0 {
        to[0] = to[0].round();
        to[1] = to[1].round();
    }
    let mut d = mm(to);
    let mut tool = dot([d[0], d[1], d[2]], [d[0], d[1], d[2]]).sqrt();
    if tool < 0.000_5 {
        // Too short to be a move of the tool; the next target makes up for it.
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
    })
}

/// The direction of the path averaged over 0.3 mm, once and twice, behind each way: two low-passes in a row, of which a
/// way is so much left as `1 / (1 + x + x^2/2 + x^3/6 + x^4/24)` says.
fn trends(ways: &[Way]) -> Vec<[[f64; 3]; 2]> {
    let mut trend = [[0.0; 3]; 2];
    ways.iter()
        .map(|w| {
            if w.unit != [0.0; 3] {
                let x = w.length / 0.3;
                let left = 1.0 / (1.0 + x + x.powi(2) / 2.0 + x.powi(3) / 6.0 + x.powi(4) / 24.0);
                let [once, twice] = trend;
                let at = |i: usize| (once[i] - w.unit[i], twice[i] - w.unit[i]);
                trend = [
                    std::array::from_fn(|i| w.unit[i] + left * at(i).0),
                    std::array::from_fn(|i| w.unit[i] + left * (at(i).1 + x * at(i).0)),
                ];
            }
            trend
        })
        .collect()
}

/// The greatest speed through the corner from `p` to `q`, with which the path has got that trend.
fn corner(p: &Way, q: &Way, trend: &[[f64; 3]; 2], s: &Settings) -> f64 {
    let (still_p, still_q) = (p.unit == [0.0; 3], q.unit == [0.0; 3]);
    let most = p.speed.min(q.speed);
    if still_p || still_q {
        return if still_p && still_q && p.ratio.signum() == q.ratio.signum() { most } else { 0.0 };
    }
    let half = ((1.0 + dot(p.unit, q.unit)) / 2.0).max(0.0).sqrt();
    // The change of direction, and what the axes bear along it.
    let turn: [f64; 3] = std::array::from_fn(|i| q.unit[i] - p.unit[i]);
    let bears = |turn: [f64; 3]| {
        let axes = s.axes.map(|a| a.max_acceleration.to_num::<f64>()).to_array();
        let motor = s.motor_max_acceleration.to_num::<f64>();
        [turn[0], turn[1], turn[2], turn[0] + turn[1], turn[0] - turn[1]]
            .iter()
            .zip([axes[0], axes[1], axes[2], motor, motor])
            .map(|(share, most)| most * dot(turn, turn).sqrt() / share.abs())
            .fold(q.a, f64::min)
    };
    let a = bears(turn);
    let base = match s.corner {
        CornerRule::JunctionDeviation(d) => a * d.to_num::<f64>(),
        CornerRule::SquareCorner(w) => w.to_num::<f64>().powi(2) * (2f64.sqrt() - 1.0),
    };
    let bend = if half >= 1.0 { f64::INFINITY } else { base * half / (1.0 - half) };
    // A row of chords is a circle: its radius is half a chord over the tangent of half the turn.
    let other = ((1.0 - dot(p.unit, q.unit)) / 2.0).max(0.0).sqrt();
    let curve = if other > 0.0 { a * p.length.min(q.length) / 2.0 * half / other } else { f64::INFINITY };
    // Corners that leave the path by less than rounding does may be as fast as the path bends on average.
    let [once, twice] = trend;
    let lag: [f64; 3] = std::array::from_fn(|i| once[i] - twice[i]);
    let radius = 0.3 * (dot(*twice, *twice) / dot(lag, lag)).sqrt();
    let average = if dot(lag, lag) > 0.0 { bears(lag) * radius } else { f64::INFINITY };
    let curve = curve.max(average.min(a * 0.0016 * half / (1.0 - half)));
    let jump = (p.ratio - q.ratio).abs();
    let jerk = if jump > 0.0 { s.extruder_jerk.to_num::<f64>() / jump } else { f64::INFINITY };
    most.min(bend.sqrt()).min(curve.sqrt()).min(jerk)
}

/// The trapezoids of a path from the origin, planned with all of it in view.
pub fn trapezoids(targets: &[([f64; 4], f64)], s: &Settings) -> Vec<Trapezoid> {
    let mut ways: Vec<Way> = Vec::new();
    let mut at = [0.0; 4];
    let mut asked = [0.0; 4];
    for (target, speed) in targets {
        if let Some(w) = way(at, asked, *target, *speed, s) {
            at = w.to;
            asked = if w.unit == [0.0; 3] { [asked[0], asked[1], asked[2], target[3]] } else { *target };
            ways.push(w);
        }
    }
    let trends = trends(&ways);
    let mut entry: Vec<f64> =
        (0..ways.len()).map(|i| if i == 0 { 0.0 } else { corner(&ways[i - 1], &ways[i], &trends[i], s) }).collect();
    entry.push(0.0);
    for i in (0..ways.len()).rev() {
        entry[i] = entry[i].min((entry[i + 1].powi(2) + 2.0 * ways[i].a * ways[i].length).sqrt());
    }
    for i in 0..ways.len() {
        entry[i + 1] = entry[i + 1].min((entry[i].powi(2) + 2.0 * ways[i].a * ways[i].length).sqrt());
    }
    ways.iter()
        .enumerate()
        .map(|(i, w)| {
            // Both ramps together are at most so long, if the ends allow it; the extruder alone need not cruise.
            let cruise = if w.unit == [0.0; 3] { 0.0 } else { s.minimum_cruise_ratio.to_num::<f64>() };
            let ramps = w.length * (1.0 - cruise);
            let meet = ((entry[i].powi(2) + entry[i + 1].powi(2)) / 2.0 + w.a * ramps).sqrt();
            let meet = meet.max(entry[i]).max(entry[i + 1]);
            Trapezoid {
                from: w.from,
                to: w.to,
                length: w.length,
                entry: entry[i],
                peak: w.speed.min(meet),
                exit: entry[i + 1],
                a: w.a,
            }
        })
        .collect()
}

/// The instants in s at which a coordinate crosses from one step to the next within a trapezoid, counted
/// from its begin; `row` gives the coordinate as a sum of x, y, z and e.
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
