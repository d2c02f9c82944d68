//! The Z probe.

use super::states::States;
use crate::gcode::{Number, ProbeCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::probe_answer::ProbeAnswer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::probe::reach::reach;
use crate::machine::probe::touch::{AfterTouch, touch_bed};
use crate::machine::state::modal::Modal;
use crate::port::{EndstopSet, Pend};
use crate::units::Mm;

/// Carries out a command of the probe.
pub(super) async fn carry_out<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &ProbeCommand,
) -> Result<Answer<'static>, Interrupt> {
    if !main_loop.settings.probe.is_fitted() || !main_loop.status.inputs().has(EndstopSet::PROBE) {
        return Ok(Answer::Probe(ProbeAnswer::None));
    }
    match *command {
        ProbeCommand::Touch { x, y, stays_out } => {
            let at = match place(main_loop, &states.modal, [x, y]) {
                Ok(at) => at,
                Err(answer) => return Ok(answer),
            };
            let end = if stays_out { AfterTouch::Out } else { AfterTouch::In };
            let height = touch_bed(main_loop, Some(at), end).await?;
            main_loop.reply(Answer::Probe(ProbeAnswer::Bed { at, height })).await?;
            Ok(Answer::Position { real: false })
        }
    }
}

/// The place of the probe that the words mean, by default its own, if it can touch there.
fn place<P: PortSet, W: Pend>(
    main_loop: &MainLoop<'_, P, W>,
    modal: &Modal,
    words: [Option<Number>; 2],
) -> Result<[Mm; 2], Answer<'static>> {
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Err(Answer::NotHomed);
    }
    let s = &*main_loop.settings;
    let ([x, y, ..], offset, [wanted_x, wanted_y]) = (main_loop.motion.end_mm(), s.probe.offset, words);
    let of = |at: Mm, offset: Mm, word: Option<Number>| {
        word.map_or_else(|| at.saturating_add(offset), |number| modal.length(number))
    };
    let at = [of(x, offset.x, wanted_x), of(y, offset.y, wanted_y)];
    let reaches = reach(s);
    if at.iter().zip(reaches).all(|(at, reach)| reach.holds(*at)) {
        Ok(at)
    } else {
        Err(Answer::Probe(ProbeAnswer::OutOfReach { at, reaches }))
    }
}
