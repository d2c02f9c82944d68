//! Rules: the limits of axes, motors and moves in force, followed with the commands of a print.
//!
//! They are numbers of mm and s, computed from a direction in double precision and by another way than the planner's,
//! so that a mistake of the planner does not hide here.

use super::Limit;
use crate::file_line::words;
use corehbot::kinematics::{Groups, direction};
use corehbot::settings::{Axes, AxisSettings, Settings};
use corehbot::units::Seconds;

/// The limits that a print may change.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Rules {
    /// Greatest speed and acceleration of x, y, z and e.
    pub speeds: [f64; 4],
    pub accelerations: [f64; 4],
    /// Acceleration of moves that print, of retractions, and of travels (M204 P, R, T).
    pub purposes: [f64; 3],
    /// The part of a move that is to be run at one speed.
    pub cruise_ratio: f64,
    /// Whether there is a pressure advance.
    pub has_advance: bool,
}

impl Rules {
    /// Those of a machine.
    pub fn new(s: &Settings) -> Self {
        let Axes { x, y, z, e } = s.axes;
        let of = |value: fn(&AxisSettings) -> f64| [x, y, z, e].each_ref().map(value);
        Self {
            speeds: of(|axis| axis.max_speed.to_num()),
            accelerations: of(|axis| axis.max_acceleration.to_num()),
            purposes: [s.print_acceleration, s.retract_acceleration, s.travel_acceleration].map(|a| a.to_num()),
            cruise_ratio: s.minimum_cruise_ratio.to_num(),
            has_advance: s.advance.time > Seconds::ZERO,
        }
    }

    /// Takes in a command, with mm in the unit of lines.
    pub fn read(&mut self, command: &str, unit: f64) {
        let mut all = words(command);
        let code = all.next();
        let positive =
            all.filter_map(|(letter, value)| Some((letter, value? * unit))).filter(|(_, value)| *value >= 0.0);
        match code {
            Some(('M', Some(201.0))) => set("XYZE", &mut self.accelerations, positive),
            Some(('M', Some(203.0))) => set("XYZE", &mut self.speeds, positive),
            Some(('M', Some(204.0))) => {
                for (letter, value) in positive.filter(|(_, value)| *value > 0.0) {
                    match letter {
                        'P' => self.purposes[0] = value,
                        'R' => self.purposes[1] = value,
                        'T' => self.purposes[2] = value,
                        'S' => (self.purposes[0], self.purposes[2]) = (value, value),
                        _ => {}
                    }
                }
            }
            Some(('M', Some(572.0 | 900.0))) => {
                if let Some((_, value)) = positive.into_iter().find(|(letter, _)| matches!(letter, 'K' | 'S')) {
                    self.has_advance = value > 0.0;
                }
            }
            _ => self.read_klipper(command),
        }
    }

    /// SET_VELOCITY_LIMIT, always in mm, and SET_PRESSURE_ADVANCE.
    fn read_klipper(&mut self, command: &str) {
        let Some((name, rest)) = command.split_once(' ') else { return };
        if !matches!(name, "SET_VELOCITY_LIMIT" | "SET_PRESSURE_ADVANCE") {
            return;
        }
        for (key, value) in rest.split_whitespace().filter_map(|word| word.split_once('=')) {
            match (key, value.parse::<f64>()) {
                ("ACCEL", Ok(value)) => (self.purposes[0], self.purposes[2]) = (value, value),
                ("MINIMUM_CRUISE_RATIO", Ok(value)) => self.cruise_ratio = value,
                ("ADVANCE", Ok(value)) => self.has_advance = value > 0.0,
                _ => {}
            }
        }
    }
}

fn set(letters: &str, values: &mut [f64; 4], words: impl Iterator<Item = (char, f64)>) {
    for (letter, value) in words.filter(|(_, value)| *value > 0.0) {
        if let Some(index) = letters.find(letter) {
            values[index] = value;
        }
    }
}

/// The limits of belt motors, which no print changes.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Motors {
    /// The ways of each belt motor for a mm of x, y and z.
    rows: Vec<[f64; 3]>,
    pub speed: f64,
    pub acceleration: f64,
}

impl Motors {
    pub fn new(s: &Settings) -> Self {
        let belts = Groups::new(&s.mechanism);
        let rows = belts.iter().filter(|group| group.is_belt()).map(|group| {
            let [x, y, z, _] = direction(group.row);
            [x, y, z].map(f64::from)
        });
        Self {
            rows: rows.collect(),
            speed: s.motor_max_speed.to_num(),
            acceleration: s.motor_max_acceleration.to_num(),
        }
    }

    /// The way of the motor that goes farthest for a mm in that direction.
    fn most_of(&self, [x, y, z]: [f64; 3]) -> f64 {
        self.rows.iter().map(|[a, b, c]| (a * x + b * y + c * z).abs()).fold(0.0, f64::max)
    }
}

/// The bounds of a value along a move, each with its limit.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Bounds(pub [(Limit, f64); 3]);

impl Bounds {
    /// Those of axes, motors and extruder for a move of that length, given what each bears.
    pub fn new(way: [f64; 4], length: f64, axes: &[f64; 4], motors: &Motors, of_motors: f64) -> Self {
        let share = way.map(|way| if length > 0.0 { way.abs() / length } else { 0.0 });
        let most = |limit: f64, share: f64| if share > 0.0 { limit / share } else { f64::INFINITY };
        let axis = (0..3).map(|i| most(axes[i], share[i])).fold(f64::INFINITY, f64::min);
        let direction = std::array::from_fn(|i| if length > 0.0 { way[i] / length } else { 0.0 });
        let motor = most(of_motors, motors.most_of(direction));
        Self([(Limit::Axis, axis), (Limit::Motor, motor), (Limit::Extruder, most(axes[3], share[3]))])
    }

    /// The least of them.
    pub fn least(&self) -> f64 {
        self.0.iter().map(|(_, bound)| *bound).fold(f64::INFINITY, f64::min)
    }

    /// The one that equals a value within a part of it.
    pub fn equal_to(&self, value: f64, within: f64) -> Option<Limit> {
        let off = |bound: f64| (bound / value - 1.0).abs();
        let (limit, bound) = self.0.into_iter().min_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
        (off(bound) <= within).then_some(limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_follow_the_words_of_a_print() {
        let mut rules = Rules::new(&Settings::prototype());
        for command in [
            "M201 X900 E4000",
            "M203 Z7",
            "M204 P800 T1500",
            "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.2",
            "M900 K0.05",
        ] {
            rules.read(command, 1.0);
        }
        assert_eq!((rules.accelerations[0], rules.accelerations[3], rules.speeds[2]), (900.0, 4000.0, 7.0));
        assert_eq!((rules.purposes[0], rules.purposes[2], rules.cruise_ratio), (800.0, 1500.0, 0.2));
        assert!(rules.has_advance);
        rules.read("SET_PRESSURE_ADVANCE ADVANCE=0", 1.0);
        assert!(!rules.has_advance);
        rules.read("SET_PRESSURE_ADVANCE ADVANCE=0.04", 1.0);
        assert!(rules.has_advance);
        rules.read("M204 S1000", 1.0);
        assert_eq!((rules.purposes[0], rules.purposes[2]), (1000.0, 1000.0));
    }

    #[test]
    fn a_diagonal_is_bounded_by_its_motors() {
        let s = Settings::prototype();
        let bounds = Bounds::new([10.0, 10.0, 0.0, 0.0], 200f64.sqrt(), &[300.0; 4], &Motors::new(&s), 450.0);
        // As src/motion/planner/geometry.rs has it by hand: 450 / 1.414, below the axes' 300 * 1.414.
        assert!((bounds.least() - 318.198).abs() < 0.001, "{bounds:?}");
        assert_eq!(bounds.equal_to(318.2, 1e-3), Some(Limit::Motor));
    }
}
