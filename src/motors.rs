//! Motors and endstops: their numbers, names of motors, and sets of them as bits.
//!
//! The Z probe is an endstop, [`EndstopSet::PROBE`]. A machine may have a plug for it (`Settings::probe_plug`), in any
//! input of its board. It is read like a switch (`step_pins.rs`), M119 reports it, and `machine::probe` touches the bed
//! with it.

mod name;
pub mod prototype;

pub use name::{MotorName, OfMotor};

/// Motors that a machine may have.
pub const MOTORS: usize = 8;

/// A list with an entry for each motor: these for the first ones, and `rest` for all others.
#[must_use]
pub const fn per_motor<T: Copy>(listed: &[T], rest: T) -> [T; MOTORS] {
    let mut all = [rest; MOTORS];
    all.split_at_mut(listed.len()).0.copy_from_slice(listed);
    all
}

/// A motor by its number: its bit in a [`MotorSet`] and its column in a step trace.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Motor(u8);

impl Motor {
    /// Every motor in the order of the trace's columns.
    pub const ALL: [Self; MOTORS] = {
        let mut all = [Self(0); MOTORS];
        let mut number = 0;
        while number < MOTORS {
            all[number] = Self(number as u8);
            number += 1;
        }
        all
    };

    /// Its place in a list with one entry a motor.
    #[must_use]
    #[inline(always)]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Its number.
    #[must_use]
    pub const fn number(self) -> u8 {
        self.0
    }
}

/// A set of motors, one bit each.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotorSet(pub u8);

impl MotorSet {
    /// No motor.
    pub const NONE: Self = Self(0);
    /// Every motor.
    pub const ALL: Self = Self(((1 << MOTORS) - 1) as u8);

    /// The set of one motor.
    #[must_use]
    pub const fn of(motor: Motor) -> Self {
        Self(1 << motor.0)
    }

    /// Whether `motor` is in the set.
    #[must_use]
    // Called for every motor in every event, also in builds that inline nothing else.
    #[inline(always)]
    pub const fn has(self, motor: Motor) -> bool {
        self.0 & (1 << motor.0) != 0
    }

    /// Its motors.
    pub fn iter(self) -> impl Iterator<Item = Motor> + Clone {
        Motor::ALL.into_iter().filter(move |motor| self.has(*motor))
    }

    /// Whether the set is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The motors of either set.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The motors of this set that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether a motor is in both sets.
    #[must_use]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

/// Groups of motors that always step together; no machine has more: four for x, y and z, and the extruder.
pub const MOST_GROUPS: usize = 5;

/// A set of groups of motors, one bit each, in the order of [`Groups`](crate::kinematics::Groups).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct GroupSet(pub u8);

impl GroupSet {
    /// No group.
    pub const NONE: Self = Self(0);

    /// Whether the set is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Which motors a step of each group turns.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Coupling {
    /// Motors that turn forward when the group's coordinate grows, and those that turn backward.
    groups: [(MotorSet, MotorSet); MOST_GROUPS],
}

impl Coupling {
    /// These turn forward and these backward, a pair a group.
    #[must_use]
    pub const fn new(groups: [(MotorSet, MotorSet); MOST_GROUPS]) -> Self {
        Self { groups }
    }

    /// A step of the group of this number turns one motor forward; no other motor turns.
    #[must_use]
    pub fn of_one(number: usize, motor: Motor) -> Self {
        let mut groups = [(MotorSet::NONE, MotorSet::NONE); MOST_GROUPS];
        if let Some(group) = groups.get_mut(number) {
            *group = (MotorSet::of(motor), MotorSet::NONE);
        }
        Self { groups }
    }

    /// The motors of these groups.
    #[must_use]
    pub fn motors(&self, groups: GroupSet) -> MotorSet {
        self.sum(
            |number, (with, against)| {
                if groups.0 >> number & 1 == 1 { with.with(against) } else { MotorSet::NONE }
            },
        )
    }

    /// The motors that turn forward if the coordinates of these groups increase and the others decrease.
    #[must_use]
    pub fn forward_motors(&self, groups: GroupSet) -> MotorSet {
        self.sum(|number, (with, against)| if groups.0 >> number & 1 == 1 { with } else { against })
    }

    /// The steps of each motor, given the steps of the groups.
    #[must_use]
    pub fn motor_counts(&self, counts: [i32; MOST_GROUPS]) -> [i32; MOTORS] {
        Motor::ALL.map(|motor| {
            let count = |((with, against), count): (&(MotorSet, MotorSet), i32)| {
                if with.has(motor) {
                    Some(count)
                } else if against.has(motor) {
                    Some(count.wrapping_neg())
                } else {
                    None
                }
            };
            self.groups.iter().zip(counts).find_map(count).unwrap_or_default()
        })
    }

    fn sum(&self, motors: impl Fn(usize, (MotorSet, MotorSet)) -> MotorSet) -> MotorSet {
        let each = self.groups.iter().enumerate();
        each.fold(MotorSet::NONE, |set, (number, group)| set.with(motors(number, *group)))
    }
}

/// A set of endstop inputs, one bit each; a set bit is a switch that is pressed.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EndstopSet(pub u8);

impl EndstopSet {
    /// No endstop.
    pub const NONE: Self = Self(0);
    /// The switch of X.
    pub const X: Self = Self(1);
    /// The switch of Y.
    pub const Y: Self = Self(2);
    /// The switch of Z.
    pub const Z: Self = Self(4);
    /// The Z probe on the tool.
    pub const PROBE: Self = Self(8);
    /// The switches that every machine has.
    pub const SWITCHES: Self = Self(7);
    /// Everything that a move may watch for.
    pub const ALL: Self = Self::SWITCHES.with(Self::PROBE);

    /// Whether every endstop of `other` is in the set.
    #[must_use]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The endstops of either set.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The endstops of both sets.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether the set is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}
