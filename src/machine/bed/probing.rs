//! Places of the Z probe in a line.

use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::probe::reach::{OutOfReach, nozzle_for};
use crate::machine::state::modal::Modal;
use crate::port::Wake;
use crate::units::Mm;

/// A place of the probe is the machine's, as in Marlin: M206 does not count in it, and the host gets to know.
pub(in crate::machine) fn tell_of_home_offsets<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    let [x, y, _] = main_loop.settings.home_offsets();
    if [x, y] != [Mm::ZERO; 2] {
        main_loop.say(text!("echo:places of the probe are the machine's: M206 does not count in X and Y"));
    }
}

/// Why a place is not touched.
pub(in crate::machine) enum NoPlace {
    /// An axis is not homed.
    NotHomed,
    OutOfReach(OutOfReach),
}

impl NoPlace {
    /// The answer that says so.
    pub fn answer<P: PortSet, W: Wake>(self, main_loop: &mut MainLoop<'_, P, W>) -> Answer<'static> {
        match self {
            Self::NotHomed => Answer::NotHomed,
            Self::OutOfReach(place) => place.answer(main_loop),
        }
    }
}

/// The place of the probe that the words mean, by default its own, if it can touch there.
pub(in crate::machine) fn place<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    modal: &Modal,
    words: [Option<Number>; 2],
) -> Result<[Mm; 2], NoPlace> {
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Err(NoPlace::NotHomed);
    }
    let s = &*main_loop.settings;
    let ([x, y, ..], offset, [wanted_x, wanted_y]) = (main_loop.motion.end_mm(), s.probe.offset, words);
    let of = |at: Mm, offset: Mm, word: Option<Number>| {
        word.map_or_else(|| at.saturating_add(offset), |number| modal.length(number))
    };
    let at = [of(x, offset.x, wanted_x), of(y, offset.y, wanted_y)];
    nozzle_for(s, at).map(|_| at).map_err(NoPlace::OutOfReach)
}
