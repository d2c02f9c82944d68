//! The commanded rectangle, as belt travel of the two motors over time.
//!
//! The tool follows a square at constant speed, without ramps, from the lower left corner, which is the origin (section
//! III A of the paper). The paper went counter-clockwise (its figure 3). Equation 1 turns places into belt travel:
//! r phi1 = x + y, r phi2 = x - y.

use super::parameters::PULSE;

/// Side of the square, m; assumed, because the paper does not give it.
pub(super) const SIDE: f64 = 0.020;

/// How positions are commanded to the motors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Continuously along the path.
    Continuous,
    /// In pulses of 0.0812 mm: x and y are each at the multiple nearest to the path. A controller that works in whole
    /// steps of x and y does the same, and its motors get their sums and differences.
    Pulses,
}

/// A corner where the path turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// Its place, m.
    pub place: [f64; 2],
    /// Unit vector of the side that ends here.
    pub into: [f64; 2],
    /// Unit vector of the side that begins here.
    pub out_of: [f64; 2],
}

/// The three corners: y to x, x to y, y to x again. The first is reached from rest.
const CLOCKWISE: [Corner; 3] = [
    Corner { place: [0.0, SIDE], into: [0.0, 1.0], out_of: [1.0, 0.0] },
    Corner { place: [SIDE, SIDE], into: [1.0, 0.0], out_of: [0.0, -1.0] },
    Corner { place: [SIDE, 0.0], into: [0.0, -1.0], out_of: [-1.0, 0.0] },
];

/// The same the other way: x to y, y to x, x to y.
const COUNTER_CLOCKWISE: [Corner; 3] = [
    Corner { place: [SIDE, 0.0], into: [1.0, 0.0], out_of: [0.0, 1.0] },
    Corner { place: [SIDE, SIDE], into: [0.0, 1.0], out_of: [-1.0, 0.0] },
    Corner { place: [0.0, SIDE], into: [-1.0, 0.0], out_of: [0.0, -1.0] },
];

/// The way round the square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Along y first.
    Clockwise,
    /// Along x first, as in figure 3 of the paper.
    CounterClockwise,
}

impl Direction {
    /// Its corners, in order.
    pub(super) const fn corners(self) -> [Corner; 3] {
        match self {
            Direction::Clockwise => CLOCKWISE,
            Direction::CounterClockwise => COUNTER_CLOCKWISE,
        }
    }

    /// Index of the corner from x to y, and from y to x, that the tool does not reach from rest.
    pub(super) const fn turns(self) -> [usize; 2] {
        match self {
            Direction::Clockwise => [1, 2],
            Direction::CounterClockwise => [2, 1],
        }
    }
}

/// A time in which the motor inputs change linearly from one value to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// s.
    pub duration: f64,
    /// Inputs of motors 1 and 2 at the start: belt travel in m, or volts.
    pub from: [f64; 2],
    /// At the end.
    pub to: [f64; 2],
}

impl Piece {
    /// The inputs at a part of the piece from 0 to 1.
    pub fn at(&self, part: f64) -> [f64; 2] {
        [0, 1].map(|motor| self.from[motor] + part * (self.to[motor] - self.from[motor]))
    }
}

/// The four sides, each as its pieces.
pub(super) fn sides(speed: f64, command: Command, direction: Direction) -> Vec<Vec<Piece>> {
    let [first, second, third] = direction.corners().map(|corner| corner.place);
    let start = [0.0, 0.0];
    let ends = [(start, first), (first, second), (second, third), (third, start)];
    let duration = SIDE / speed;
    let side = |(from, to)| match command {
        Command::Continuous => vec![Piece { duration, from: belt(from), to: belt(to) }],
        Command::Pulses => pulses(from, to, duration),
    };
    ends.map(side).into_iter().collect()
}

/// Belt travel of motors 1 and 2 (equation 1).
fn belt([x, y]: [f64; 2]) -> [f64; 2] {
    [x + y, x - y]
}

/// A side along x or y; the motors are at rest between pulses.
fn pulses(from: [f64; 2], to: [f64; 2], duration: f64) -> Vec<Piece> {
    let place = |part: f64| [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
    let held = |part: f64| belt(place(part).map(|travel| (travel / PULSE).round() * PULSE));
    let mut cuts = vec![0.0, 1.0];
    cuts.extend([0, 1].into_iter().flat_map(|axis| pulse_times(from[axis], to[axis])));
    cuts.sort_by(f64::total_cmp);
    let between = |cut: &[f64]| {
        let at = held(0.5 * (cut[0] + cut[1]));
        Piece { duration: (cut[1] - cut[0]) * duration, from: at, to: at }
    };
    cuts.windows(2).map(between).collect()
}

/// Pulse times of a coordinate, as parts of the side: half a pulse from both places.
fn pulse_times(from: f64, to: f64) -> Vec<f64> {
    let number = |travel: f64| travel / PULSE - 0.5;
    let first = number(from.min(to)).ceil() as i64;
    let last = number(from.max(to)).floor() as i64;
    (first..=last).map(|k| ((k as f64 + 0.5) * PULSE - from) / (to - from)).collect()
}
