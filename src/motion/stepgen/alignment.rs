//! Alignment: a long move along one axis follows the line on which its motors stand.
//!
//! Take two belts with the coordinates u = x + y and v = x - y, in steps. In a move along x both belts step in the same
//! instants if u and v cross the middle between two counts together. They do if 2 y = u - v is a whole number. Motors
//! at rest stand on whole counts of u and v, so 2 y is whole there. That y is within half a step of the commanded y. So
//! a long move along x is laid at the y of the motors, which needs no step to get there, and ends at the planned x. The
//! tool stays at that y, off the planned path, until a move commands another y. All other moves end at their planned
//! positions, so errors do not add up.
//!
//! (Half a step cannot be reduced for every corner. Between a move along x and one along y both 2 x and 2 y must be
//! whole. Every other such position is between two counts of both motors, and the tool would leave it with a step of
//! one motor alone.)
//!
//! Where four coordinates hold three axes, the four counts may contradict each other and then belong to no position.
//! There long moves end on whole steps of x, y and z instead.

use crate::kinematics::{Groups, count_at};
use crate::motion::moves::Move;
use crate::motion::trajectory::Position;
use crate::motors::MOST_GROUPS;
use crate::units::{Length, Steps};

/// A long move: a millimetre (lengths have 30 bits). An offset of half a step bends a following move of that length by
/// less than 0.4 degrees. Shorter moves are chords of curves, where it would cause speed ripple.
const LONG: Length = Length((1 << 32) - 8);

/// Fraction of a position between two counts.
const HALF: u32 = 1 << 31;

/// The axis that a surface raises.
const Z: usize = 2;

/// The axes x, y and z.
type Tool = [Steps; 3];

/// Real positions of the planned moves.
pub(super) struct Alignment {
    /// The other axes that share motors with x, y and z: a bit each.
    sharing: [u8; 3],
    is_redundant: bool,
    /// Planned end of the last move.
    planned: Tool,
}

impl Alignment {
    /// For this mechanism.
    pub fn new(groups: &Groups) -> Self {
        let share = |axis: usize, other: usize| axis != other && groups.mechanism().share(axis, other);
        // Motors with different pulleys do not step in the same instants at any position.
        let share = |axis, other| !groups.mechanism().has_multiples() && share(axis, other);
        let sharing = |axis: usize| (0..3).map(|other| u8::from(share(axis, other)) << other).sum();
        Self { sharing: core::array::from_fn(sharing), is_redundant: groups.is_redundant(), planned: [Steps::ZERO; 3] }
    }

    /// The machine is at its planned position.
    pub const fn stand_at(&mut self, planned: Tool) {
        self.planned = planned;
    }

    /// The positions between which a move is laid, given the end of the last one, and the motors' counts there if they
    /// have reached it. A step that is due within the last tick may not be made yet. Whether z follows no surface.
    pub fn ends(
        &mut self,
        m: &Move,
        position: &Position,
        counts: Option<[i32; MOST_GROUPS]>,
        groups: &Groups,
        is_flat: bool,
    ) -> (Position, Position) {
        let [x, y, z, e] = m.end;
        // Commanded ends are compared, because real ones may be half a step aside.
        let before = core::mem::replace(&mut self.planned, [x, y, z]);
        let (mut begin, [.., advance]) = (*position, *position);
        let mut end = [x, y, z, e, advance.wrapping_add(m.advance)];
        let mut moving = 0u8;
        for (axis, (planned, before)) in self.planned.iter().zip(before).enumerate() {
            if *planned != before {
                moving |= 1 << axis;
            } else if let (Some(end), Some(position)) = (end.get_mut(axis), position.get(axis)) {
                // For the same commanded position it stays where it is.
                *end = *position;
            }
        }
        let is_long = moving != 0 && m.length >= LONG;
        if self.is_redundant {
            // The counts may contradict each other here, so whole steps of the axes take their place (see the head).
            if is_long {
                end.iter_mut().take(3).for_each(|at| *at = at.wrapping_round());
            }
            return (begin, end);
        }
        for (axis, sharing) in self.sharing.iter().enumerate() {
            // Two axes on the same motors that both move make a slope, on which the motors' steps cannot coincide.
            if moving >> axis & 1 == 0 || *sharing == 0 || moving & sharing != 0 {
                continue;
            }
            // On a surface z moves all the time, and its motors stand on no line.
            if !is_flat && (axis == Z || sharing >> Z & 1 == 1) {
                continue;
            }
            if is_long {
                // Motors that lag behind a shaper will come to the counts of the position.
                let [x, y, z, _] = groups.position(counts.unwrap_or_else(|| counts_at(position, groups)));
                let stands = [x, y, z];
                for (other, stands) in stands.iter().enumerate().filter(|(other, _)| sharing >> other & 1 == 1) {
                    for position in [&mut begin, &mut end] {
                        if let Some(at) = position.get_mut(other) {
                            *at = *stands;
                        }
                    }
                }
            }
            if is_between_counts(&end, axis, groups)
                && let (Some(end), Some(begin)) = (end.get_mut(axis), begin.get(axis))
            {
                // It stops just short of it, where all its motors are at counts on the line.
                let back = if *end > *begin { -Steps::DELTA } else { Steps::DELTA };
                *end = end.wrapping_add(back);
            }
        }
        (begin, end)
    }
}

/// A position without the advance.
const fn without_advance(position: &Position) -> [Steps; 4] {
    let [x, y, z, e, _] = *position;
    [x, y, z, e]
}

/// Counts of the motors at a position.
fn counts_at(position: &Position, groups: &Groups) -> [i32; MOST_GROUPS] {
    let mut counts = [0; MOST_GROUPS];
    for (count, group) in counts.iter_mut().zip(groups.iter()) {
        *count = count_at(group.coordinate(without_advance(position)));
    }
    counts
}

/// Whether a motor of an axis is exactly between two counts at a position.
fn is_between_counts(position: &Position, axis: usize, groups: &Groups) -> bool {
    let follows = |row: &[i8; 4]| row.get(axis).is_some_and(|times| *times != 0);
    let mut groups = groups.iter().filter(|group| follows(&group.row));
    groups.any(|group| group.coordinate(without_advance(position)).to_bits() as u32 == HALF)
}
