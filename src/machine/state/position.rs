//! Where the machine really stands: the homed axes, and the position behind a motor group's count.
//!
//! Counts of steps begin at 0 with the reset and are never set. So a position is a count and an origin: the steps that
//! the group's coordinate was at when its count was 0.

use super::level::Level;
use crate::kinematics::{Grouping, Groupings, Groups, Mechanism, count_at};
use crate::motors::MOST_GROUPS;
use crate::port::MotorSet;
use crate::units::Steps;

/// The axes with a known position.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Homed {
    axes: [bool; 3],
    /// An axis is being homed.
    is_under_way: bool,
    /// The path of the tool in mm when x and y met their switches last.
    met: [Option<u32>; 2],
    /// The axes with a position that was ever known, or searched for in vain.
    ever: [bool; 3],
    /// The axes with a position that was lost in a search for an endstop. They do not move until they are homed, or
    /// until their motors lose power.
    failed: [bool; 3],
    /// Whether the screws of z are level.
    level: Level,
    /// Where the probe has found the bed: z of the planner when it triggered. It is known until a motor of z loses its
    /// power, although z may not be homed any more.
    found_bed: Option<Steps>,
}

impl Homed {
    /// These of x, y and z are homed.
    pub const fn new(axes: [bool; 3]) -> Self {
        let (failed, level) = ([false; 3], Level::Unknown);
        Self { axes, is_under_way: false, met: [None; 2], ever: axes, failed, level, found_bed: None }
    }

    /// Whether x, y and z are homed.
    pub const fn axes(&self) -> [bool; 3] {
        self.axes
    }

    /// Whether one of the axes that move is not homed.
    pub fn lacks_one_of(&self, moves: [bool; 3]) -> bool {
        moves.into_iter().zip(self.axes).any(|(moves, is_homed)| moves && !is_homed)
    }

    /// Whether one of the axes that move was homed, and its position is not known any more.
    pub fn has_lost_one_of(&self, moves: [bool; 3]) -> bool {
        moves
            .into_iter()
            .zip(self.axes)
            .zip(self.ever)
            .any(|((moves, is_homed), was_ever)| moves && was_ever && !is_homed)
    }

    /// Whether homing failed for one of the axes that move.
    pub fn has_failed_one_of(&self, moves: [bool; 3]) -> bool {
        moves.into_iter().zip(self.failed).any(|(moves, has_failed)| moves && has_failed)
    }

    /// The axis is being homed.
    pub fn begin(&mut self, axis: usize) {
        self.is_under_way = true;
        self.set(axis, false);
    }

    /// The axis has met its endstop.
    pub fn arrive(&mut self, axis: usize) {
        self.set(axis, true);
    }

    /// Homing failed for an axis. `pressed` are motors that may have been driven against the end of an axis: they may
    /// have skipped, each by its own number of steps. So every axis that they move is lost.
    pub fn fail(&mut self, axis: usize, pressed: MotorSet, mechanism: &Mechanism) {
        for lost in 0..self.axes.len() {
            if lost == axis || mechanism.motors_of(lost).intersects(pressed) {
                self.set(lost, false);
                if let (Some(ever), Some(failed)) = (self.ever.get_mut(lost), self.failed.get_mut(lost)) {
                    (*ever, *failed) = (true, true);
                }
            }
        }
    }

    /// The axis was to be homed in vain, and nothing has moved: a print needs its place.
    pub fn note_sought(&mut self, axis: usize) {
        if let Some(ever) = self.ever.get_mut(axis) {
            *ever = true;
        }
    }

    /// The screws of z were levelled, or it was tried in vain.
    pub const fn note_level(&mut self, is_level: bool) {
        self.level = if is_level { Level::Kept } else { Level::Unknown };
    }

    /// What is known of the screws of z.
    pub const fn level(&self) -> Level {
        self.level
    }

    /// Z of the planner when the probe has found the bed, as long as that is where the bed is.
    pub const fn found_bed(&self) -> Option<Steps> {
        self.found_bed
    }

    /// The probe has found the bed with the planner's z there; or z has another zero, and the bed is where that says.
    pub const fn note_bed(&mut self, z: Option<Steps>) {
        self.found_bed = z;
    }

    /// The tool stands so much higher above the bed from now on, with the same z of the planner.
    pub fn note_shifted(&mut self, by: Steps) {
        self.found_bed = self.found_bed.map(|z| z.wrapping_sub(by));
    }

    /// The axis met its endstop when the path of the tool was so long.
    pub fn note_met(&mut self, axis: usize, path_mm: u32) {
        if let Some(met) = self.met.get_mut(axis) {
            *met = Some(path_mm);
        }
    }

    /// The path length since x and y met their endstops, for those that are homed.
    pub fn since_met(&self, path_mm: u32) -> [Option<u32>; 2] {
        let [x, y, _] = self.axes;
        let [met_x, met_y] = self.met.map(|met| met.map(|met| path_mm.wrapping_sub(met)));
        [met_x.filter(|_| x), met_y.filter(|_| y)]
    }

    fn set(&mut self, axis: usize, is_homed: bool) {
        if let (Some(flag), Some(ever)) = (self.axes.get_mut(axis), self.ever.get_mut(axis)) {
            *flag = is_homed;
            *ever |= is_homed;
        }
        if let Some(failed) = self.failed.get_mut(axis).filter(|_| is_homed) {
            *failed = false;
        }
    }

    /// Restores the homed flags from before, and where the bed was; the times when the axes met their switches since
    /// then stay.
    pub const fn believe(&mut self, before: &Self) {
        (self.axes, self.found_bed) = (before.axes, before.found_bed);
    }

    /// No axis is being homed any more; true if one was.
    pub const fn stop(&mut self) -> bool {
        core::mem::replace(&mut self.is_under_way, false)
    }

    /// These motors lose their power: the axes that they held are no longer homed.
    pub fn release(&mut self, motors: MotorSet, mechanism: &Mechanism) {
        if mechanism.motors_of(2).intersects(motors) {
            self.found_bed = None;
            if self.level == Level::Kept {
                self.level = Level::Lost;
            }
        }
        for (axis, (is_homed, failed)) in self.axes.iter_mut().zip(&mut self.failed).enumerate() {
            let own = mechanism.motors_of(axis);
            let are_held = own.without(motors) == own;
            *is_homed &= are_held;
            *failed &= are_held;
        }
    }
}

/// Where the motor groups stand, given the steps that were really made.
pub(in crate::machine) struct RealPosition<'m> {
    groupings: &'m Groupings,
    grouping: Grouping,
    /// They were ever grouped otherwise than at the start.
    has_regrouped: bool,
    /// Position of each group at count 0, in steps.
    origin: [i32; MOST_GROUPS],
}

impl<'m> RealPosition<'m> {
    /// All groups stand at 0 and have counted nothing.
    pub const fn new(groupings: &'m Groupings) -> Self {
        Self { groupings, grouping: Grouping::Tool, has_regrouped: false, origin: [0; MOST_GROUPS] }
    }

    /// The motor groups as they are now.
    pub const fn groups(&self) -> &'m Groups {
        self.groupings.of(self.grouping)
    }

    /// Their present grouping.
    pub const fn grouping(&self) -> Grouping {
        self.grouping
    }

    /// From now on they are grouped so. The meaning of a count has to be adopted again.
    pub const fn regroup(&mut self, grouping: Grouping) {
        (self.grouping, self.has_regrouped) = (grouping, true);
    }

    /// Whether they were ever grouped otherwise than at the start, so that the generator has to get the grouping.
    pub const fn has_regrouped(&self) -> bool {
        self.has_regrouped
    }

    /// The motor groups as they are when they are grouped so.
    pub const fn groups_in(&self, grouping: Grouping) -> &'m Groups {
        self.groupings.of(grouping)
    }

    /// The machine stands at `position` now, at these counts.
    pub fn adopt(&mut self, position: [Steps; 4], counts: [i32; MOST_GROUPS]) {
        let groups = self.groups();
        for ((origin, group), count) in self.origin.iter_mut().zip(groups.iter()).zip(counts) {
            *origin = count_at(group.coordinate(position)).wrapping_sub(count);
        }
    }

    /// The position of each motor group, in steps.
    pub fn of_groups(&self, counts: [i32; MOST_GROUPS]) -> [i32; MOST_GROUPS] {
        let mut real = self.origin;
        for (real, count) in real.iter_mut().zip(counts) {
            *real = real.wrapping_add(count);
        }
        real
    }

    /// The position in steps of x, y, z and e.
    pub fn of_axes(&self, counts: [i32; MOST_GROUPS]) -> [Steps; 4] {
        self.groups().position(self.of_groups(counts))
    }

    /// The position nearest to `position` that is whole steps from where the machine really is. Where four coordinates
    /// hold three axes, only such positions keep their counts in agreement. A position between whole steps would make
    /// them strain each other by a step, and the next position by another.
    pub fn whole_steps_away(&self, position: [Steps; 4], counts: [i32; MOST_GROUPS]) -> [Steps; 4] {
        if !self.groups().is_redundant() {
            return position;
        }
        let mut near = self.of_axes(counts);
        for (near, wanted) in near.iter_mut().zip(position) {
            *near = near.wrapping_add(wanted.wrapping_sub(*near).wrapping_round());
        }
        let ([x, y, z, _], [.., e]) = (near, position);
        [x, y, z, e]
    }
}
