//! C in G0 and G1: the belt runs round, with the tool standing or moving in x and y.

use crate::fault::{Cause, Fault};
use crate::gcode::{AxisWords, Flaw, Number};
use crate::kinematics::Grouping;
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::modal::FARTHEST;
use crate::machine::state::soft_endstops::clamp;
use crate::motion::Target;
use crate::motors::Coupling;
use crate::port::{DriverBus, EndstopSet, Pend};
use crate::settings::{AxisSettings, Settings};
use crate::units::{Mm, MmPerSec, Steps};

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

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// What the planner has its resolutions and limits from.
    pub(in crate::machine) fn with_motion_settings<R>(&self, work: impl FnOnce(&Settings) -> R) -> R {
        match self.real.grouping() {
            Grouping::Tool => work(&self.settings),
            Grouping::Circulation | Grouping::Trim => work(&circulating(&self.settings)),
        }
    }

    /// A position of the planner as people see it: z stands where it stood when the belt took its place.
    pub(in crate::machine) fn seen(&self, position: [Mm; 4]) -> [Mm; 4] {
        match self.real.grouping() {
            Grouping::Tool => position,
            Grouping::Circulation => {
                let ([x, y, _, e], (_, z)) = (position, self.circulation.z());
                [x, y, z, e]
            }
            Grouping::Trim => {
                let ([.., e], [x, y, z, _]) = (position, self.planner.mm(self.trimming.held()));
                [x, y, z, e]
            }
        }
    }

    /// G0, G1 with C. The move begins and ends at rest.
    pub(in crate::machine) async fn circulate(
        &mut self,
        to: &AxisWords,
        belt: Number,
        feed: Option<Number>,
    ) -> Result<Answer<'static>, Interrupt> {
        if !self.settings.belt.is_closed {
            return Ok(Answer::Malformed(Flaw::NoAxis(b'C')));
        }
        if to.z.is_some() || to.e.is_some() {
            return Ok(Answer::Line("echo:line ignored: C goes with X, Y and F alone"));
        }
        let speed = self.clamps.feed(&self.modal, feed).unwrap_or(self.modal.feed);
        let wanted = self.target(to).await?.position;
        let at = self.modal.position;
        if !self.may_move([0, 1, 2].map(|axis| wanted.get(axis) != at.get(axis))).await? {
            return Ok(Answer::NotHomed);
        }
        let (inside, moved) = clamp(wanted, at, self.homed, &self.settings);
        if moved {
            self.tell_of_edge().await?;
        }
        let belt = self.modal.length(belt);
        let target = if self.modal.absolute { belt } else { self.circulation.commanded.saturating_add(belt) };
        if !FARTHEST.holds(target) {
            self.tell_of_edge().await?;
        }
        let [x, y, ..] = inside;
        self.run_round([x, y], FARTHEST.clamp(target), speed).await?;
        self.modal.feed = speed;
        self.modal.position = inside;
        Ok(Answer::Nothing)
    }

    /// Has a belt that can run round do so a little, after homing, so that it does not always bend at the same teeth.
    pub(in crate::machine) async fn advance_belt(&mut self) -> Result<(), Interrupt> {
        let belt = self.settings.belt;
        if !belt.is_closed || belt.homing_advance == Mm::ZERO {
            return Ok(());
        }
        let position = self.modal.position;
        let [x, y, ..] = position;
        let farther = self.circulation.commanded + belt.homing_advance;
        // Round and round: no farther than numbers go.
        let target = if FARTHEST.holds(farther) { farther } else { self.circulation.commanded - belt.homing_advance };
        self.run_round([x, y], target, belt.max_speed).await?;
        self.modal.position = position;
        Ok(())
    }

    /// The tool goes to x and y while the belt runs on up to `belt`.
    async fn run_round(&mut self, to: [Mm; 2], belt: Mm, speed: MmPerSec) -> Result<(), Interrupt> {
        self.finish().await?;
        self.power(self.real.groups().mechanism().belt_motors()).await?;
        // Where the motors stand, which may be beside the end of the last move (`motion::stepgen::alignment`).
        let ([x, y, ..], [.., z, e]) = (self.real_steps(), self.planner.end());
        let [.., z_mm, _] = self.planner.mm(self.planner.end());
        self.circulation.begin((z, z_mm));
        self.regroup(Grouping::Circulation, [x, y, Steps::ZERO, e]).await?;
        let [.., filament] = self.planner.mm(self.planner.end());
        let [to_x, to_y] = to;
        let [to_x, to_y, to, e] = self.planner.steps([to_x, to_y, belt, filament]);
        let way = to.wrapping_round().wrapping_sub(Steps::wrapping_from_num(self.circulation.steps()));
        self.plan_whole([to_x, to_y, way, e], speed, true);
        self.finish().await?;
        self.end_circulation().await?;
        self.circulation.commanded = belt;
        Ok(())
    }

    /// Plans a move to the whole steps next to a position, where the counts of all motors agree.
    pub(super) fn plan_whole(&mut self, position: [Steps; 4], speed: MmPerSec, has_overrides: bool) {
        let [x, y, c, e] = position;
        let [x, y, c] = [x, y, c].map(Steps::wrapping_round);
        let target = Target { position: self.planner.mm([x, y, c, e]), speed, has_overrides, watch: EndstopSet::NONE };
        self.planner.push(&target, &circulating(&self.settings));
        self.policy.note_news();
        self.note_path();
    }

    /// The belt has run as far as it should, or was stopped: z has its place again. Motion rests.
    pub(in crate::machine) async fn end_circulation(&mut self) -> Result<(), Interrupt> {
        if self.real.grouping() != Grouping::Circulation {
            return Ok(());
        }
        // No way at all, unless it was stopped between two places where the counts agree.
        self.plan_whole(self.planner.end(), self.settings.belt.max_speed, false);
        self.finish().await?;
        let [x, y, c, e] = self.planner.end();
        self.circulation.add(c.wrapping_round().to_num());
        self.circulation.commanded = self.circulation.length(self.settings.axes.x.steps_per_mm);
        let (z, _) = self.circulation.z();
        self.regroup(Grouping::Tool, [x, y, z, e]).await?;
        self.modal.position = self.retraction.commanded(self.planner.mm(self.planner.end()));
        Ok(())
    }

    /// Regroups the motors at rest; the machine stands at `position` then.
    async fn regroup(&mut self, grouping: Grouping, position: [Steps; 4]) -> Result<(), Interrupt> {
        let coupling = self.real.groups_in(grouping).coupling();
        self.couple(grouping, &coupling, position).await
    }

    /// The same with a coupling of its own.
    pub(super) async fn couple(
        &mut self,
        grouping: Grouping,
        coupling: &Coupling,
        position: [Steps; 4],
    ) -> Result<(), Interrupt> {
        self.real.regroup(grouping);
        if !self.are_groups_whole() {
            // Nobody has looked at those that were not in use.
            self.link.status().fault().set(Fault::plain(Cause::SettingsDamaged));
        }
        self.ports.drivers.couple(coupling);
        let groups = self.real.groups();
        match grouping {
            Grouping::Tool => self.planner.regroup(&self.settings, groups),
            Grouping::Circulation | Grouping::Trim => self.planner.regroup(&circulating(&self.settings), groups),
        }
        self.adopt_exactly(position).await
    }
}
