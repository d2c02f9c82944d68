//! Wiring: which motor hangs on which driver and which way it turns, from the ways that the tool went when each was
//! moved alone (STEPPER_BUZZ).
//!
//! ```text
//!   rows of the mechanism ──▶ n! * 2^n wirings: where would the tool go? ──▶ those that fit what was seen
//!                                              └──▶ the next buzz: the one that tells most of them apart
//! ```
//!
//! In a buzz one motor moves, some turn freely and all others stand. So the tool goes where the rows of these motors
//! say. A motor and the other one of its pair bring the tool to the same places; only with another one free do they
//! differ. A closed belt may circulate meanwhile, which is a fourth unknown.
//!
//! Two wirings of a closed belt stay: that each motor is the opposite one and turns the other way makes no difference
//! but to the way round of the belt. So there is one more question, which motor turns ([`Belt::mirrored`]).

use corehbot::kinematics::Residuals;
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;

/// Unknowns: x, y, z and the circulation of the belt.
const UNKNOWNS: usize = 4;

/// A part of the longest component that counts as no movement: what a person sees are straight lines and diagonals.
const UNSEEN: f64 = 0.3;

/// Where the tool goes along x, y and z: -1, 0 or 1 for each. Positive is right, back, and nozzle and bed apart.
pub(super) type Way = [i8; 3];

/// Motors that share axes, so that their plugs may be in each other's place.
pub(super) struct Belt {
    pub motors: Vec<Motor>,
    rows: Vec<[f64; UNKNOWNS]>,
    residuals: Residuals,
}

/// One motor moves alone. Numbers are places in [`Belt::motors`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Buzz {
    pub moved: usize,
    pub free: Vec<usize>,
}

/// The motor behind each driver, and whether it turns the other way.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Wiring(pub Vec<(usize, bool)>);

impl Wiring {
    /// How many plugs are not as they should be.
    fn changes(&self) -> usize {
        self.0.iter().enumerate().filter(|(driver, (motor, reversed))| driver != motor || *reversed).count()
    }

    /// The driver of a motor, and whether it turns the motor the other way.
    pub fn driver_of(&self, motor: usize) -> Option<(usize, bool)> {
        let found = self.0.iter().enumerate().find(|(_, (turned, _))| *turned == motor);
        found.map(|(driver, (_, reversed))| (driver, *reversed))
    }

    /// Every wiring of `count` motors, the straight one first, then those with the fewest changes.
    pub fn all(count: usize) -> Vec<Self> {
        let mut orders = vec![Vec::new()];
        for _ in 0..count {
            let longer = |order: Vec<usize>| {
                let rest: Vec<_> = (0..count).filter(|motor| !order.contains(motor)).collect();
                rest.into_iter().map(move |motor| order.iter().copied().chain([motor]).collect::<Vec<_>>())
            };
            orders = orders.into_iter().flat_map(longer).collect();
        }
        let signed = |order: Vec<usize>| {
            (0..1_u32 << count).map(move |signs| {
                let wires = order.iter().enumerate().map(|(driver, motor)| (*motor, signs >> driver & 1 == 1));
                Self(wires.collect())
            })
        };
        let mut all: Vec<_> = orders.into_iter().flat_map(signed).collect();
        all.sort_by_key(Self::changes);
        all
    }
}

impl Belt {
    /// The motors that share axes with this one.
    pub fn of(s: &Settings, motor: Motor) -> Self {
        let mut set = MotorSet::of(motor);
        // Each round takes in the motors of one more axis.
        for _ in 0..3 {
            let axes = (0..3).map(|axis| s.mechanism.motors_of(axis)).filter(|motors| motors.intersects(set));
            set = axes.fold(set, MotorSet::with);
        }
        let circulates = s.belt.is_closed && set.intersects(s.mechanism.belt_motors());
        let row = |motor: &Motor| {
            let [x, y, z, _] = s.mechanism.rows[motor.index()].map(f64::from);
            let longest = x.abs().max(y.abs()).max(z.abs()).max(1.0);
            [x / longest, y / longest, z / longest, if circulates { 1.0 } else { 0.0 }]
        };
        let motors: Vec<_> = set.iter().collect();
        let residuals = Residuals::new(&s.mechanism, s.belt.is_closed);
        Self { rows: motors.iter().map(row).collect(), motors, residuals }
    }

    /// The motors of some places.
    pub fn set(&self, places: &[usize]) -> MotorSet {
        places.iter().fold(MotorSet::NONE, |set, place| set.with(MotorSet::of(self.motors[*place])))
    }

    /// The buzz of a motor as the firmware makes it without FREE.
    pub fn usual(&self, moved: usize) -> Buzz {
        let row = self.rows[moved].map(f64::abs);
        let alike = (0..self.motors.len()).filter(|other| self.rows[*other].map(f64::abs) == row);
        let is_pair = |other: &usize| {
            let same = (0..3).all(|axis| self.rows[*other][axis] == self.rows[moved][axis]);
            same || (0..3).all(|axis| self.rows[*other][axis] == -self.rows[moved][axis])
        };
        let pair: Vec<_> = alike.filter(is_pair).collect();
        let free = self.residuals.to_free(self.motors[moved], self.set(&pair));
        Buzz { moved, free: self.places(free) }
    }

    /// Every buzz that strains nothing, the usual ones first.
    fn possible(&self) -> Vec<Buzz> {
        let count = self.motors.len();
        let usual = (0..count).map(|moved| self.usual(moved));
        let others = (0..count).flat_map(|moved| (0..count).map(move |free| Buzz { moved, free: vec![free] }));
        let is_possible = |buzz: &Buzz| {
            let strained = self.residuals.without(self.set(&buzz.free)).motors();
            // Without residuals another free motor would leave the tool loose.
            !buzz.free.contains(&buzz.moved)
                && !strained.has(self.motors[buzz.moved])
                && self.residuals.motors().has(self.motors[buzz.moved])
        };
        usual.chain(others.filter(is_possible)).collect()
    }

    fn places(&self, set: MotorSet) -> Vec<usize> {
        (0..self.motors.len()).filter(|place| set.has(self.motors[*place])).collect()
    }

    /// Where the tool goes in a buzz with this wiring.
    pub fn way(&self, wiring: &Wiring, buzz: &Buzz) -> Way {
        // Least squares: the sum of all rows that hold or move, and a trifle so that a loose unknown stays where it is.
        let mut sums = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        for (unknown, sum) in sums.iter_mut().enumerate() {
            sum[unknown] = 1e-9;
        }
        for (driver, (motor, reversed)) in wiring.0.iter().enumerate().filter(|(at, _)| !buzz.free.contains(at)) {
            let turn = match (driver == buzz.moved, reversed) {
                (false, _) => 0.0,
                (true, false) => 1.0,
                (true, true) => -1.0,
            };
            let row = self.rows[*motor];
            for (sum, factor) in sums.iter_mut().zip(row) {
                for (entry, other) in sum.iter_mut().zip(row.into_iter().chain([turn])) {
                    *entry += factor * other;
                }
            }
        }
        let [x, y, z, _] = solved(sums);
        let most = x.abs().max(y.abs()).max(z.abs());
        let sign = |v: f64| if v.abs() <= UNSEEN * most || most < 1e-3 { 0 } else { v.signum() as i8 };
        [x, y, z].map(sign)
    }

    /// The wirings of `among` that agree with a buzz that was seen.
    pub fn fitting(&self, among: Vec<Wiring>, buzz: &Buzz, seen: Way) -> Vec<Wiring> {
        among.into_iter().filter(|wiring| self.way(wiring, buzz) == seen).collect()
    }

    /// A buzz in which these two wirings of a closed belt turn other motors, and a motor that turns in the first one
    /// alone.
    pub fn mirrored(&self, among: &[Wiring]) -> Option<(Buzz, usize)> {
        let [Wiring(one), Wiring(other)] = among else { return None };
        let turns = |wires: &[(usize, bool)], buzz: &Buzz, motor: usize| {
            let moving = buzz.free.iter().chain([&buzz.moved]);
            moving.filter_map(|driver| wires.get(*driver)).any(|(turned, _)| *turned == motor)
        };
        let mut pairs = self.possible().into_iter().filter_map(|buzz| Some((one.get(buzz.moved)?.0, buzz)));
        let differs = |(motor, buzz): &(usize, Buzz)| !turns(other, buzz, *motor);
        let circulates = self.rows.iter().all(|row| row[UNKNOWNS - 1] != 0.0);
        pairs.find(differs).filter(|_| circulates).map(|(motor, buzz)| (buzz, motor))
    }

    /// Where a motor of a closed belt stands, from its row (docs/explanation/kinematics.md#the-coreh-bot).
    pub fn place(&self, motor: usize) -> &'static str {
        let [x, y, ..] = self.rows[motor];
        match (x > 0.0, y > 0.0) {
            (false, true) => "front left",
            (false, false) => "front right",
            (true, false) => "back right",
            (true, true) => "back left",
        }
    }

    /// The buzz that tells most of these wirings apart; `None` if none does.
    pub fn next(&self, among: &[Wiring]) -> Option<Buzz> {
        let largest = |buzz: &Buzz| {
            let mut ways: Vec<Way> = among.iter().map(|wiring| self.way(wiring, buzz)).collect();
            ways.sort_unstable();
            ways.chunk_by(|a, b| a == b).map(<[Way]>::len).max().unwrap_or_default()
        };
        let sized = self.possible().into_iter().map(|buzz| (largest(&buzz), buzz));
        sized.min_by_key(|(size, _)| *size).filter(|(size, _)| *size < among.len()).map(|(_, buzz)| buzz)
    }
}

/// Solves equations by elimination; each has its right side at its end. They are positive definite.
fn solved(mut sums: [[f64; UNKNOWNS + 1]; UNKNOWNS]) -> [f64; UNKNOWNS] {
    for pivot in 0..UNKNOWNS {
        let row = sums[pivot];
        for (_, sum) in sums.iter_mut().enumerate().filter(|(other, _)| *other != pivot) {
            let factor = sum[pivot] / row[pivot];
            for (entry, from) in sum.iter_mut().zip(row) {
                *entry -= factor * from;
            }
        }
    }
    std::array::from_fn(|unknown| sums[unknown][UNKNOWNS] / sums[unknown][unknown])
}

#[cfg(test)]
mod tests;
