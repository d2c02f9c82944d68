//! M422: where the screws of z are, and the points of the bed that are probed for them.

use crate::gcode::{Number, ScrewWords};
use crate::kinematics::SCREWS;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::Setting;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::port::Pend;
use crate::settings::{Range, Screw, Settings, WholePlace, ranges};
use crate::units::Mm;

/// Half a mm: places are rounded.
const HALF: Mm = const { Mm::lit("0.5") };

/// M422.
pub(super) fn place_screw<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    clamps: &mut Clamps,
    words: &ScrewWords,
) -> Answer<'static> {
    let ScrewWords { point, place, x, y, resets } = *words;
    if resets {
        let screws = main_loop.settings.defaults().screws;
        let wanted = Settings { screws, ..*main_loop.settings };
        main_loop.live_settings().set_plain(&wanted);
        return Answer::Nothing;
    }
    let (letter, screw) = match (point, place) {
        (None, None) => return Answer::Setting(Setting::Screws),
        (Some(screw), None) => ("S", screw),
        (None, Some(screw)) => ("W", screw),
        (Some(_), Some(_)) => {
            return Answer::Line("echo:M422 ignored: S is a probed point, W a screw; give one of them");
        }
    };
    let screws = Range { least: 1, most: SCREWS as u16 };
    let Some(number) = clamps.whole_of(["M422", letter], screw, screws, None) else { return Answer::Nothing };
    let mut wanted = *main_loop.settings;
    let Some(screw) = wanted.screws.get_mut(usize::from(number) - 1) else { return Answer::Nothing };
    let Screw { place, point } = screw;
    let kept = if letter == "S" { point } else { place };
    let WholePlace { x: old_x, y: old_y } = *kept;
    let mut whole = |letter, asked: Option<Number>, old: i16| match asked {
        Some(asked) => {
            let old = Mm::const_from_int(old.into());
            let mm = clamps.length_of(modal, ["M422", letter], asked, ranges::PLACE, Some(old));
            mm.map(|mm| mm.saturating_add(HALF).to_num())
        }
        None => Some(old),
    };
    if let (Some(x), Some(y)) = (whole("X", x, old_x), whole("Y", y, old_y)) {
        *kept = WholePlace { x, y };
        main_loop.live_settings().set_plain(&wanted);
    }
    Answer::Nothing
}
