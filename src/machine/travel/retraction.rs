//! Retractions (G10, G11): their moves, the limits of their settings, and what ends one without a move.

use super::moves::{Asked, Gate, Moves};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::settings::Range;
use crate::units::Mm;

/// The longest retraction and the highest lift: bowden tubes need less than a tenth of it.
pub(in crate::machine) const RETRACTION: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };

/// A retraction left over from one print does not apply to the next. In a pause it is part of what the print goes on
/// with.
pub(in crate::machine) fn forget_retraction<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    if !main_loop.job.is_paused() {
        main_loop.commanded.forget_retraction();
    }
}

impl<P: PortSet, W: Wake> Moves<'_, '_, P, W> {
    /// G10: away from the commanded position; G11: back to it.
    ///
    /// Not with a cold hotend: filament that was pulled back stays so until the hotend is hot.
    pub async fn retract(&mut self, recovers: bool) -> Result<Answer<'static>, Interrupt> {
        let (commanded, settings) = (&self.main_loop.commanded, &self.states.retraction);
        let speed = self.main_loop.settings.axes.z.max_speed;
        let (moves, filament) = if recovers {
            let [_, length] = commanded.retracted();
            (commanded.moves_back(settings, speed), length)
        } else {
            (commanded.moves_away(settings, speed), -settings.length)
        };
        if moves.is_some() && self.hold_back(Asked { moves: [false; 3], filament }, None).await? == Gate::Held {
            return Ok(Answer::Held);
        }
        if self.states.is_too_cold(self.main_loop) {
            self.tell_of_cold();
            return Ok(Answer::Nothing);
        }
        for step in moves.into_iter().flatten() {
            let position = self.main_loop.commanded.after(step);
            self.main_loop
                .plan(Target { position, speed: step.speed.into(), has_overrides: false, watch: EndstopSet::NONE })
                .await?;
            self.main_loop.commanded.note_retraction(step);
        }
        self.main_loop.commanded.take_extra();
        Ok(Answer::Nothing)
    }
}
