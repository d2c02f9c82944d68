//! C in G0 and G1: the belt circulates, with the tool at rest or moving in x and y.

use super::moves::{Moves, moving};
use crate::gcode::{AxisWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::belt::circulate::run_round;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::main_loop::surface::leave_surface;
use crate::machine::ports::PortSet;
use crate::machine::state::modal::FARTHEST;
use crate::machine::state::soft_endstops::clamp;
use crate::port::Wake;
use core::pin::pin;

impl<P: PortSet, W: Wake> Moves<'_, '_, P, W> {
    /// G0, G1 with C. The move begins and ends at rest.
    pub async fn circulate(
        &mut self,
        to: &AxisWords,
        belt: Number,
        feed: Option<Number>,
    ) -> Result<Answer<'static>, Interrupt> {
        if !self.main_loop.settings.belt.is_closed {
            return Ok(Answer::Line(packed!("echo:line ignored: there is no axis C")));
        }
        if to.z.is_some() || to.e.is_some() {
            return Ok(Answer::Line(packed!("echo:line ignored: C goes with X, Y and F alone")));
        }
        // Z stands still meanwhile, at whatever height.
        leave_surface(self.main_loop).await?;
        let speed = self.states.clamps.feed(&self.states.modal, feed).unwrap_or(self.states.modal.feed);
        let wanted = self.target(to).position;
        let at = self.main_loop.commanded.position();
        if !self.may_move(moving(at, wanted)) {
            return Ok(Answer::NotHomed);
        }
        let (inside, moved) =
            clamp(wanted, at, self.main_loop.homed, &self.main_loop.settings, z_reach(self.main_loop));
        if moved {
            self.tell_of_edge();
        }
        let belt = self.states.modal.length(belt);
        let target =
            if self.states.modal.absolute { belt } else { self.main_loop.circulation.commanded().saturating_add(belt) };
        if !FARTHEST.holds(target) {
            self.tell_of_edge();
        }
        let [x, y, ..] = inside;
        apart(pin!(run_round(self.main_loop, [x, y], FARTHEST.clamp(target), speed))).await?;
        self.states.modal.feed = speed;
        self.main_loop.commanded.go_to(inside);
        Ok(Answer::Nothing)
    }
}
