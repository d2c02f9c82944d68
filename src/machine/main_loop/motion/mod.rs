//! Motion: the look-ahead, the queue to the step generator, and where the machine really stands.
//!
//! ```text
//!   plan ──▶ look-ahead ── hand_on ──▶ move queue ──▶ step generator
//!             waiting        ▲          queued
//!                            └── release: what may leave now, how much of the feed
//! ```
//!
//! Commands read here where the machine is; they plan, finish and stop by the waits in [`stream`](super::stream). Only
//! the main loop changes anything, and each change keeps planner, queue and position in step.
//!
//! | file | for |
//! |---|---|
//! | this one | positions, the grouping of motors, the queue |
//! | [`look_ahead`] | moves into the look-ahead |
//! | [`hand_on`] | moves out of it, a part of every turn |
//! | [`babystep`] | steps that z stands aside of its path, live |
//!
//! | word | means |
//! |---|---|
//! | waiting | moves in the look-ahead; their speeds may still change |
//! | queued | moves that have left it and are not stepped yet |
//! | final, dry, underrun, share, gathering | see `release` |

mod babystep;
pub(super) mod hand_on;
mod look_ahead;

use crate::kinematics::{Grouping, Groupings, Groups};
use crate::machine::release::policy::ReleasePolicy;
use crate::machine::state::advance_in_use::AdvanceInUse;
use crate::machine::state::position::RealPosition;
use crate::motion::{Link, MoveMemory, Planner, QueueObserver, SurfaceFrame, Work, surface_work};
use crate::motors::MOST_GROUPS;
use crate::port::Wake;
use crate::settings::{AxisSettings, Settings};
use crate::surface::{Heights, Mesh};
use crate::units::{Instant, Mm, Seconds, Steps, SubTicks, TICKS_PER_MS};
use babystep::Babystep;

/// The motion, from the look-ahead to the counts of steps.
pub(in crate::machine) struct Motion<'m, W: Wake> {
    link: Link<'m, W>,
    planner: Planner<'m>,
    policy: ReleasePolicy,
    real: RealPosition<'m>,
    advance_in_use: AdvanceInUse,
    /// It has ever followed one, so that the generator has to get it.
    has_followed: bool,
    babystep: Babystep,
}

impl<'m, W: Wake> Motion<'m, W> {
    pub(super) fn new(
        link: Link<'m, W>,
        memory: &'m mut MoveMemory,
        groupings: &'m Groupings,
        settings: &Settings,
        position: [Mm; 4],
    ) -> Self {
        Self {
            link,
            planner: Planner::new(memory, settings, position),
            policy: ReleasePolicy::new(),
            real: RealPosition::new(groupings),
            advance_in_use: AdvanceInUse::new(),
            has_followed: false,
            babystep: Babystep::default(),
        }
    }

    /// This one sees each entry before it is queued.
    pub fn observe(&mut self, observer: &'m dyn QueueObserver) {
        self.link.observe(observer);
    }

    /// Whether no motion was requested since the start.
    pub const fn is_fresh(&self) -> bool {
        self.link.is_fresh()
    }

    /// Whether anything planned has not been stepped yet.
    pub fn has_motion(&self) -> bool {
        !self.planner.is_empty() || !self.link.is_idle() || self.link.is_shifting()
    }

    /// Makes the Stepper read the endstops.
    pub fn look_at_endstops(&self) {
        self.link.look_at_endstops();
    }

    /// The groups of motors in use.
    pub const fn groups(&self) -> &'m Groups {
        self.real.groups()
    }

    /// For which coordinates motors step together.
    pub const fn grouping(&self) -> Grouping {
        self.real.grouping()
    }

    /// Where the last planned move ends.
    pub const fn end(&self) -> [Steps; 4] {
        self.planner.end()
    }

    /// The same in mm.
    pub fn end_mm(&self) -> [Mm; 4] {
        self.planner.mm(self.planner.end())
    }

    /// The path of the tool that was planned so far, in mm; it wraps.
    pub const fn path(&self) -> u32 {
        self.planner.path()
    }

    /// A position in steps.
    pub fn to_steps(&self, position: [Mm; 4]) -> [Steps; 4] {
        self.planner.steps(position)
    }

    /// A position in mm.
    pub fn to_mm(&self, position: [Steps; 4]) -> [Mm; 4] {
        self.planner.mm(position)
    }

    /// Where the machine really is on its path, in steps of x, y, z and e; on a surface, z is counted from there.
    pub fn real_steps(&self) -> [Steps; 4] {
        let [x, y, z, e] = self.real.of_axes(self.link.counts());
        self.to_planned([x, y, z.wrapping_sub(self.aside()), e])
    }

    /// The mesh of the bed, whether z follows it or not.
    pub fn mesh(&self) -> Option<&Mesh> {
        self.planner.mesh()
    }

    /// Whether z follows the mesh now.
    pub const fn is_on_surface(&self) -> bool {
        !self.planner.surface().is_none()
    }

    /// Has another mesh, or none; z follows none now.
    pub(super) fn set_mesh(&mut self, mesh: Option<&Mesh>) {
        self.planner.set_mesh(mesh.copied());
    }

    /// Follows the surface or not, at rest. Returns the position that the machine has then, which has to be adopted.
    pub(super) fn use_surface(&mut self, is_on: bool, settings: &Settings) -> [Steps; 4] {
        let real = self.planner.to_real(self.planner.end());
        self.planner.use_mesh(is_on, settings);
        self.has_followed |= is_on;
        self.planner.to_planned(real)
    }

    /// The parts of the work by which the generator gets the surface; none if there never was one.
    pub(super) fn surface_work(&self, part: usize) -> Option<Work> {
        let is_of_tool = self.real.grouping() == Grouping::Tool;
        let frame = if is_of_tool { *self.planner.surface() } else { SurfaceFrame::NONE };
        let heights = self.mesh().filter(|_| !frame.is_none()).map_or(&Heights::NONE, Mesh::heights);
        surface_work(frame, heights).nth(part).filter(|_| self.has_followed)
    }

    /// The motors' position for a position of the planner. While something else has the place of z, z is no height.
    fn to_real(&self, position: [Steps; 4]) -> [Steps; 4] {
        if self.real.grouping() == Grouping::Tool { self.planner.to_real(position) } else { position }
    }

    /// The planner's position for a position of the motors.
    fn to_planned(&self, position: [Steps; 4]) -> [Steps; 4] {
        if self.real.grouping() == Grouping::Tool { self.planner.to_planned(position) } else { position }
    }

    /// The steps that each group of motors has made.
    pub(super) fn counts(&self) -> [i32; MOST_GROUPS] {
        self.link.counts()
    }

    /// Where the groups of motors stand.
    pub(super) const fn real(&self) -> &RealPosition<'m> {
        &self.real
    }

    /// Whether the host was waited for when motion came to rest.
    pub(super) const fn has_waited(&self) -> bool {
        self.policy.has_waited()
    }

    /// A position of the planner as people see it. While the belt has the place of z, z stands at `z`; while one motor
    /// of it has, the tool is held at `held`.
    pub(super) fn seen(&self, position: [Mm; 4], z: Mm, held: [Steps; 4]) -> [Mm; 4] {
        match self.real.grouping() {
            Grouping::Tool => position,
            Grouping::Circulation => {
                let [x, y, _, e] = position;
                [x, y, z, e]
            }
            Grouping::Trim | Grouping::Screw => {
                let ([.., e], [x, y, z, _]) = (position, self.planner.mm(held));
                [x, y, z, e]
            }
        }
    }

    /// The motors are grouped so, with these settings; the machine is at rest, and its position follows.
    pub(super) fn regroup(&mut self, grouping: Grouping, settings: &Settings) {
        self.real.regroup(grouping);
        let (planner, groups) = (&mut self.planner, self.real.groups());
        of_grouping(grouping, settings, |settings| planner.regroup(settings, groups));
    }

    /// The groups of motors as they are when they are grouped so.
    pub(super) const fn groups_in(&self, grouping: Grouping) -> &'m Groups {
        self.real.groups_in(grouping)
    }

    /// Whether the groups in use equal groups computed again. Others are checked when they come into use.
    pub(super) fn are_groups_whole(&self, settings: &Settings) -> bool {
        *self.real.groups() == Groups::new(&self.real.grouping().rows_of(&settings.mechanism))
    }

    /// Whether the values derived from settings equal values computed again.
    pub(super) fn is_whole(&self, settings: &Settings) -> bool {
        self.are_groups_whole(settings)
            && self.planner.has_advance_window(self.advance_in_use.window())
            && of_grouping(self.real.grouping(), settings, |settings| {
                self.planner.is_whole(settings, self.real.groups())
            })
    }

    /// Takes over new resolutions at rest; the position follows.
    pub(super) fn set_resolution(&mut self, settings: &Settings) {
        self.planner.set_resolution(settings);
        self.resize_shifts(settings.axes.z.steps_per_mm);
    }

    /// Whether motion must rest before the advance of `wanted` counts.
    pub(super) fn needs_rest(&self, settings: &Settings, wanted: &Settings) -> bool {
        self.advance_in_use.needs_rest(settings, wanted)
    }

    /// The advance of these settings is in use from now on. Returns its window, which the generator has to follow.
    pub(super) fn use_advance(&mut self, settings: &Settings) -> Option<Seconds> {
        let window = self.advance_in_use.follow(settings);
        self.planner.set_advance_window(window);
        window
    }

    /// Whether the queue has room for more work.
    pub(super) fn has_room_for_work(&self) -> bool {
        self.link.has_room()
    }

    /// Queues work; there is room for it.
    pub(super) fn send(&mut self, work: Work) {
        self.link.send(work);
    }

    /// Queues time in which nothing moves; there is room for it.
    pub(super) fn dwell(&mut self, ms: u32) {
        self.link.send(Work::Dwell(SubTicks::of_ticks(u64::from(ms) * u64::from(TICKS_PER_MS))));
    }

    /// Whether all work and all steps are gone after motion was dropped.
    pub(super) fn is_dropped(&self) -> bool {
        self.link.is_dropped()
    }

    /// Whether all queued work is done.
    pub(super) fn is_idle(&self) -> bool {
        self.link.is_idle()
    }

    /// Work ever queued, and work that is done or dropped; both wrap.
    pub(super) fn work(&self) -> (u32, u32) {
        (self.link.entries(), self.link.entries_done())
    }

    /// Motion slows down along its path. The path may lead on into moves that are still in the planner, so they keep
    /// leaving it.
    pub(super) fn brake(&mut self) {
        self.link.brake();
    }

    /// Whether it has come to rest so.
    pub(super) fn has_stopped(&self) -> bool {
        self.link.has_stopped()
    }

    /// Drops all that is queued, at once.
    pub(super) fn abort(&mut self) {
        self.link.abort();
    }

    /// Drops all motion, at once.
    pub(super) fn drop_all(&mut self) {
        self.planner.stand_at(self.planner.end());
        self.link.abort();
    }

    /// After that, when the steps have stopped: returns where the machine is, short of the planned end.
    pub(super) fn restart(&mut self, now: Instant) -> [Steps; 4] {
        self.link.restart();
        self.policy.note_awaited();
        self.policy.come_to_rest(now);
        let real = self.real_steps();
        self.planner.fall_short(real);
        self.note_path();
        real
    }

    /// The machine has come to rest.
    pub(super) const fn come_to_rest(&mut self, now: Instant) {
        self.policy.come_to_rest(now);
    }

    /// The position nearest to `position` that is whole steps from where the machine really is.
    pub(super) fn whole_steps_away(&self, position: [Steps; 4]) -> [Steps; 4] {
        if !self.real.groups().is_redundant() {
            return position;
        }
        self.to_planned(self.real.whole_steps_away(self.to_real(position), self.link.counts()))
    }

    /// The machine, which is at rest, stands at a position that rounds to where every motor stands. Returns the
    /// grouping of motors if the generator has to get it.
    pub(super) fn adopt(&mut self, position: [Steps; 4]) -> Option<Grouping> {
        self.planner.stand_at(position);
        self.take_in_shifts();
        self.real.adopt(self.to_real(position), self.link.counts());
        self.real.has_regrouped().then_some(self.real.grouping())
    }
}

/// Calls `work` with the settings that give the planner its resolutions and limits.
fn of_grouping<R>(grouping: Grouping, settings: &Settings, work: impl FnOnce(&Settings) -> R) -> R {
    match grouping {
        Grouping::Tool | Grouping::Screw => work(settings),
        Grouping::Circulation | Grouping::Trim => work(&circulating(settings)),
    }
}

/// The settings of motion while the belt has the place of z.
fn circulating(s: &Settings) -> Settings {
    let z = AxisSettings {
        steps_per_mm: s.axes.x.steps_per_mm,
        max_speed: s.belt.max_speed,
        max_acceleration: s.belt.max_acceleration,
        length: s.axes.z.length,
    };
    let mut settings = *s;
    settings.axes.z = z;
    settings
}
