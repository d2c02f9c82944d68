//! Groups: motors that always step at the same instant, because one coordinate drives them all.
//!
//! They follow from the [`Mechanism`]: motors with equal or opposite rows form a group. Motion counts groups, not
//! motors, so a second ball screw or the second motor of a pair costs no time.

use super::forward::{ForwardKinematics, greatest_divisor};
use super::mechanism::{Mechanism, mirrored};
use super::row::Row;
use crate::motors::{Coupling, GroupSet, MOST_GROUPS, MOTORS, Motor, MotorSet};
use crate::units::Steps;

/// The first motor of a group in this order leads it, and this order is that of the groups. Any order serves; with this
/// one, u = x + y of a CoreH-bot's fourth motor comes before v = x - y of its third: A and B of a CoreXY.
fn leaders() -> impl Iterator<Item = Motor> {
    let (first, others) = Motor::ALL.split_at(4);
    first.iter().rev().chain(others).copied()
}

/// One coordinate and the motors that it drives.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Group {
    /// The coordinate as a sum of x, y, z and e with these factors.
    pub row: Row,
    /// Motors that turn forward when the coordinate grows.
    pub with: MotorSet,
    /// Motors that turn backward when the coordinate grows.
    pub against: MotorSet,
    /// The motor with this coordinate as its count.
    pub lead: Motor,
}

impl Group {
    /// No motors. All zeros, like every initial value here: such memory costs no flash.
    const NONE: Self = Self { row: [0; 4], with: MotorSet::NONE, against: MotorSet::NONE, lead: Motor::ALL[0] };

    /// The group's coordinate at a position in steps of x, y, z and e.
    #[must_use]
    pub fn coordinate(&self, position: [Steps; 4]) -> Steps {
        let mut sum = Steps::ZERO;
        for (times, steps) in self.row.iter().zip(position) {
            sum = sum.wrapping_add(steps.wrapping_mul_int(i64::from(*times)));
        }
        sum
    }

    /// All its motors.
    #[must_use]
    pub const fn motors(&self) -> MotorSet {
        self.with.with(self.against)
    }

    /// Whether it has motors, and they move the tool.
    #[must_use]
    pub const fn is_tool(&self) -> bool {
        let [x, y, z, _] = self.row;
        x != 0 || y != 0 || z != 0
    }

    /// Whether the limits of belt motors apply: it moves x or y.
    #[must_use]
    pub const fn is_belt(&self) -> bool {
        let [x, y, ..] = self.row;
        x != 0 || y != 0
    }

    /// The axis of its coordinate, if it is a single one.
    #[must_use]
    pub fn axis(&self) -> Option<usize> {
        let mut axes = self.row.iter().enumerate().filter(|(_, times)| **times != 0).map(|(axis, _)| axis);
        axes.next().filter(|_| axes.next().is_none())
    }
}

/// Step count of a group at a coordinate: the nearest whole step, and the even one of two. So groups that mirror each
/// other about a whole step have mirrored counts and step together.
#[must_use]
pub const fn count_at(coordinate: Steps) -> i32 {
    const HALF: i64 = 1 << 31;
    let bits = coordinate.to_bits();
    let is_odd = bits >> 32 & 1;
    (bits.wrapping_add(HALF - 1 + is_odd) >> 32) as i32
}

/// A mechanism, sorted into groups.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Groups {
    mechanism: Mechanism,
    fitted: MotorSet,
    groups: [Group; MOST_GROUPS],
    back: ForwardKinematics<MOST_GROUPS>,
}

impl Groups {
    /// No motors at all.
    pub const NONE: Self = Self {
        mechanism: Mechanism { rows: [[0; 4]; MOTORS] },
        fitted: MotorSet::NONE,
        groups: [Group::NONE; MOST_GROUPS],
        back: ForwardKinematics::NONE,
    };

    /// Groups of a mechanism that passes [`Mechanism::check`].
    #[must_use]
    #[inline(never)]
    pub fn new(mechanism: &Mechanism) -> Self {
        let fitted = mechanism.fitted();
        let mut groups = Self { mechanism: *mechanism, fitted, ..Self::NONE };
        let mut taken = MotorSet::NONE;
        for lead in leaders() {
            if taken.has(lead) || !fitted.has(lead) {
                continue;
            }
            let Some(&row) = mechanism.rows.get(lead.index()) else { continue };
            let (mut with, mut against) = (MotorSet::NONE, MotorSet::NONE);
            for (motor, its_row) in mechanism.motors() {
                if its_row == row {
                    with = with.with(MotorSet::of(motor));
                } else if its_row == mirrored(row) {
                    against = against.with(MotorSet::of(motor));
                }
            }
            taken = taken.with(with).with(against);
            if let Some(group) = groups.groups.iter_mut().find(|group| group.motors().is_empty()) {
                *group = Group { row, with, against, lead };
            }
        }
        // Groups instead of motors: all motors of a group have one count.
        groups.back = ForwardKinematics::new(groups.groups.map(|group| group.row)).unwrap_or(ForwardKinematics::NONE);
        groups
    }

    /// The mechanism of these groups.
    #[must_use]
    pub const fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// The fitted motors.
    #[must_use]
    pub const fn fitted(&self) -> MotorSet {
        self.fitted
    }

    /// The groups in their order, followed by empty ones.
    pub fn iter(&self) -> core::slice::Iter<'_, Group> {
        self.groups.iter()
    }

    /// Whether more coordinates than axes hold the tool, so that their counts must agree: five of them hold four axes.
    #[must_use]
    pub const fn is_redundant(&self) -> bool {
        let [.., last] = &self.groups;
        !last.motors().is_empty()
    }

    /// Position of x, y, z and e in steps, given the counts of the groups. If no position has these counts, it is the
    /// nearest position.
    #[must_use]
    pub fn position(&self, counts: [i32; MOST_GROUPS]) -> [Steps; 4] {
        self.back.position(&counts.map(i64::from))
    }

    /// The steps of each motor, given the steps of the groups.
    #[must_use]
    pub fn motor_counts(&self, counts: [i32; MOST_GROUPS]) -> [i32; MOTORS] {
        self.coupling().motor_counts(counts)
    }

    /// Factor of each group's count in the one sum that no position changes: 0 at rest to within a step. `None` if
    /// there is no such sum, because all counts are possible.
    #[must_use]
    pub fn constraint(&self) -> Option<[i32; MOST_GROUPS]> {
        if !self.is_redundant() {
            return None;
        }
        // Four rows of three: each factor is the volume that the other three span, with alternating signs (Cramer).
        let mut tool = [(0, [0; 3]); 4];
        for (slot, (number, group)) in tool.iter_mut().zip(self.iter().enumerate().filter(|(_, group)| group.is_tool()))
        {
            let [x, y, z, _] = group.row.map(i32::from);
            *slot = (number, [x, y, z]);
        }
        let [(i, a), (j, b), (k, c), (l, d)] = tool;
        let weights = [(i, span(b, c, d)), (j, -span(a, c, d)), (k, span(a, b, d)), (l, -span(a, b, c))];
        let common =
            weights.iter().fold(0, |common, (_, weight)| greatest_divisor(common, i64::from(*weight))).max(1) as i32;
        let mut constraint = [0; MOST_GROUPS];
        for (number, weight) in weights {
            if let Some(slot) = constraint.get_mut(number) {
                *slot = weight / common;
            }
        }
        Some(constraint)
    }

    /// The motors that a step of each group turns.
    #[must_use]
    pub fn coupling(&self) -> Coupling {
        Coupling::new(self.groups.map(|group| (group.with, group.against)))
    }

    /// The coupling of [`Grouping::Trim`] and [`Grouping::Screw`]: a step of z turns `motor`, and no other motor turns.
    #[must_use]
    pub fn trim_coupling(&self, motor: Motor) -> Coupling {
        let is_z = |group: &Group| group.axis() == Some(2);
        Coupling::of_one(self.groups.iter().position(is_z).unwrap_or(MOST_GROUPS), motor)
    }
}

/// Which coordinates the motors of x and y are grouped for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Grouping {
    /// The tool alone; a closed belt is at rest, or follows the tool.
    Tool,
    /// The tool and a closed belt in the place of z ([`Mechanism::circulating`]).
    Circulation,
    /// A single motor of the belt in the place of z ([`Mechanism::trimming`]).
    Trim,
    /// The same for a single motor of z: it has the resolution and the limits of z.
    Screw,
}

impl Grouping {
    /// The rows of a mechanism in this grouping.
    #[must_use]
    pub fn rows_of(self, mechanism: &Mechanism) -> Mechanism {
        match self {
            Self::Tool => *mechanism,
            Self::Circulation => mechanism.circulating(),
            Self::Trim | Self::Screw => Mechanism::trimming(),
        }
    }
}

/// Groups of a mechanism in each of its groupings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Groupings {
    /// [`Grouping::Tool`].
    pub tool: Groups,
    /// [`Grouping::Circulation`]; unused without a closed belt.
    pub circulation: Groups,
    /// [`Grouping::Trim`] and [`Grouping::Screw`].
    pub trim: Groups,
}

impl Groupings {
    /// No motors at all.
    pub const NONE: Self = Self { tool: Groups::NONE, circulation: Groups::NONE, trim: Groups::NONE };

    /// Groups of a mechanism that passes [`Mechanism::check`].
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let groups = |grouping: Grouping| Groups::new(&grouping.rows_of(mechanism));
        Self { tool: groups(Grouping::Tool), circulation: groups(Grouping::Circulation), trim: groups(Grouping::Trim) }
    }

    /// The groups of one grouping.
    #[must_use]
    pub const fn of(&self, grouping: Grouping) -> &Groups {
        match grouping {
            Grouping::Tool => &self.tool,
            Grouping::Circulation => &self.circulation,
            Grouping::Trim | Grouping::Screw => &self.trim,
        }
    }
}

/// The volume that three rows span.
const fn span(a: [i32; 3], b: [i32; 3], c: [i32; 3]) -> i32 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Number of sets of groups.
pub const SETS: usize = 1 << MOST_GROUPS;

/// [`Coupling::motors`] and [`Coupling::forward_motors`] of every set, for callers without the time to compute them.
#[derive(Clone, Copy, Debug)]
pub struct MotorTable {
    motors: [MotorSet; SETS],
    forward: [MotorSet; SETS],
}

impl MotorTable {
    /// The table of this coupling.
    #[must_use]
    pub fn new(coupling: &Coupling) -> Self {
        let of = |motors: fn(&Coupling, GroupSet) -> MotorSet| {
            let mut sets = [MotorSet::NONE; SETS];
            for (number, set) in sets.iter_mut().enumerate() {
                *set = motors(coupling, GroupSet(number as u8));
            }
            sets
        };
        Self { motors: of(Coupling::motors), forward: of(Coupling::forward_motors) }
    }

    /// The motors of these groups.
    #[must_use]
    #[inline(always)]
    pub const fn motors(&self, groups: GroupSet) -> MotorSet {
        self.motors[groups.0 as usize % SETS]
    }

    /// The motors that turn forward if the coordinates of these groups grow and the other coordinates fall.
    #[must_use]
    #[inline(always)]
    pub const fn forward_motors(&self, groups: GroupSet) -> MotorSet {
        self.forward[groups.0 as usize % SETS]
    }
}
