//! How G10 and G11 retract, as lines set it: M207, M208; and what ends a retraction without a move. The moves
//! themselves are in `moves`.

use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::words::Words;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::state::retraction::RetractionSettings;
use crate::port::Pend;
use crate::settings::Range;
use crate::units::Mm;

/// The longest retraction and the highest lift: bowden tubes need less than a tenth of it.
const RETRACTION: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };

/// A retraction left over from one print does not apply to the next. In a pause it is part of what the print goes on
/// with.
pub(super) fn forget_retraction<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) {
    if !main_loop.job.is_paused() {
        main_loop.commanded.forget_retraction();
    }
}

/// M207. Retracted filament is recovered by the length of its retraction.
pub(in crate::machine) fn set_retraction(
    [length, feed, lift]: [Option<Number>; 3],
    settings: &mut RetractionSettings,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if length.or(feed).or(lift).is_none() {
        return Answer::Words(Words::of_retraction(settings));
    }
    let mut wanted = *settings;
    if let Some(length) = length {
        clamps.length(modal, ["M207", "S"], length, RETRACTION, &mut wanted.length);
    }
    if let Some(feed) = feed {
        clamps.speed_a_minute(modal, ["M207", "F"], feed, &mut wanted.speed);
    }
    if let Some(lift) = lift {
        clamps.length(modal, ["M207", "Z"], lift, RETRACTION, &mut wanted.lift);
    }
    if !clamps.refuses_line() {
        *settings = wanted;
    }
    Answer::Nothing
}

/// M208.
pub(in crate::machine) fn set_recovery(
    [extra, feed]: [Option<Number>; 2],
    settings: &mut RetractionSettings,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if extra.or(feed).is_none() {
        return Answer::Words(Words::of_recovery(settings));
    }
    let mut wanted = *settings;
    if let Some(extra) = extra {
        clamps.length(modal, ["M208", "S"], extra, RETRACTION, &mut wanted.extra);
    }
    if let Some(feed) = feed {
        clamps.speed_a_minute(modal, ["M208", "F"], feed, &mut wanted.recover_speed);
    }
    if !clamps.refuses_line() {
        *settings = wanted;
    }
    Answer::Nothing
}
