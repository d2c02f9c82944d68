//! The commanded rectangle, as belt travel of the two motors over time.
//!
//! The tool is sent round a square at constant speed, with no ramps, counter-clockwise from the lower left corner, which is
//! the origin, as in section III A of the paper. Equation 1 turns places into belt travel: r phi1 = x + y, r phi2 = x - y.

use super::parameters::PULSE;

/// Side of the square, m; assumed, for the paper does not say it.
pub(super) const SIDE: f64 = 0.020;

/// How the motors are told where to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// At every instant where the path is.
    Continuous,
    /// In pulses of 0.0812 mm of belt travel: each motor stands at the multiple that is nearest to its continuous command.
    Pulses,
}

/// A corner where the path turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// Where, m.
    pub place: [f64; 2],
    /// Unit vector of the side that ends here.
    pub into: [f64; 2],
    /// Unit vector of the side that begins here.
    pub out_of: [f64; 2],
}

/// The three corners: x to y, y to x, x to y again.
pub(super) const CORNERS: [Corner; 3] = [
    Corner { place: [SIDE, 0.0], into: [1.0, 0.0], out_of: [0.0, 1.0] },
    Corner { place: [SIDE, SIDE], into: [0.0, 1.0], out_of: [-1.0, 0.0] },
    Corner { place: [0.0, SIDE], into: [-1.0, 0.0], out_of: [0.0, -1.0] },
];

/// A time in which the inputs of the motors go evenly from one value to another.
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
pub(super) fn sides(speed: f64, command: Command) -> Vec<Vec<Piece>> {
    let [first, second, third] = CORNERS.map(|corner| corner.place);
    let start = [0.0, 0.0];
    let ends = [(start, first), (first, second), (second, third), (third, start)];
    let side = |(from, to)| Piece { duration: SIDE / speed, from: belt(from), to: belt(to) };
    ends.map(side)
        .into_iter()
        .map(|side| match command {
            Command::Continuous => vec![side],
            Command::Pulses => pulses(&side),
        })
        .collect()
}

/// Belt travel of motors 1 and 2 (equation 1).
fn belt([x, y]: [f64; 2]) -> [f64; 2] {
    [x + y, x - y]
}

/// The same piece with the motors standing still between pulses.
fn pulses(piece: &Piece) -> Vec<Piece> {
    let held = |part: f64| piece.at(part).map(|travel| (travel / PULSE).round() * PULSE);
    let mut cuts = vec![0.0, 1.0];
    cuts.extend([0, 1].into_iter().flat_map(|motor| pulse_times(piece.from[motor], piece.to[motor])));
    cuts.sort_by(f64::total_cmp);
    // Motors that step together do so within rounding errors: no piece for these.
    cuts.dedup_by(|later, earlier| *later - *earlier < 1e-9);
    let between = |cut: &[f64]| {
        let at = held(0.5 * (cut[0] + cut[1]));
        Piece { duration: (cut[1] - cut[0]) * piece.duration, from: at, to: at }
    };
    cuts.windows(2).map(between).collect()
}

/// When a motor gets its pulses, as parts of the piece: where it is half a pulse from both places.
fn pulse_times(from: f64, to: f64) -> Vec<f64> {
    let number = |travel: f64| travel / PULSE - 0.5;
    let first = number(from.min(to)).ceil() as i64;
    let last = number(from.max(to)).floor() as i64;
    (first..=last).map(|k| ((k as f64 + 0.5) * PULSE - from) / (to - from)).collect()
}
