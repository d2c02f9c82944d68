//! Ways to a place that is known: up before aside, and aside before down.

use super::moves::{Asked, Gate, Moves, moving};
use crate::gcode::{AxisWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::print::detour::is_own;
use crate::machine::state::modal::Modal;
use crate::port::Wake;
use crate::units::{Feed, Mm};

impl<P: PortSet, W: Wake> Moves<'_, '_, P, W> {
    /// The tool goes to a place in machine coordinates, along the axes that have one. Filament stays.
    pub async fn visit(&mut self, place: [Option<Mm>; 3], feed: Feed) -> Result<Answer<'static>, Interrupt> {
        let ([x, y, z, e], [to_x, to_y, to_z]) = (self.main_loop.commanded.position(), place);
        let [to_x, to_y, to_z] = [to_x.unwrap_or(x), to_y.unwrap_or(y), to_z.unwrap_or(z)];
        let to = [to_x, to_y, to_z, e];
        let moves = moving([x, y, z, e], to);
        if self.hold_back(Asked { moves, filament: Mm::ZERO }, None).await? == Gate::Held {
            return Ok(Answer::Held);
        }
        if !self.may_move(moves) {
            return Ok(Answer::NotHomed);
        }
        let [x_word, y_word, z_word] = place.map(|at| at.map(|_| Number::ZERO));
        let words = AxisWords { x: x_word, y: y_word, z: z_word, e: None };
        let (modal, may_be_script) = (Modal { absolute: true, ..self.states.modal }, is_own(self.main_loop));
        self.main_loop.commanded.leave_park(to, &words, &modal, may_be_script);
        let corner = if to_z > z { [x, y, to_z, e] } else { [to_x, to_y, z, e] };
        self.go(corner, feed).await?;
        self.go(to, feed).await?;
        Ok(Answer::Nothing)
    }
}
