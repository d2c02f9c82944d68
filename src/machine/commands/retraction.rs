//! How G10 and G11 retract, as lines set and show it: M207, M208. The moves themselves are in `moves`.

use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::Setting;
use crate::machine::answers::speaker::Speaker;
use crate::machine::numbers::exact;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::state::retraction::RetractionSettings;
use crate::settings::Range;
use crate::units::Mm;

/// The longest retraction and the highest lift: bowden tubes ask for less than a tenth of it.
const RETRACTION: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };

/// M207. A filament that is retracted is recovered as far as it was retracted.
pub(in crate::machine) fn set_retraction(
    [length, feed, lift]: [Option<Number>; 3],
    settings: &mut RetractionSettings,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if length.or(feed).or(lift).is_none() {
        return Answer::Setting(Setting::Retraction);
    }
    if let Some(length) = length {
        settings.length = clamps.length(modal, ["M207", "S"], length, RETRACTION);
    }
    if let Some(feed) = feed {
        settings.speed = clamps.speed_a_minute(modal, ["M207", "F"], feed);
    }
    if let Some(lift) = lift {
        settings.lift = clamps.length(modal, ["M207", "Z"], lift, RETRACTION);
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
        return Answer::Setting(Setting::Recovery);
    }
    if let Some(extra) = extra {
        settings.extra = clamps.length(modal, ["M208", "S"], extra, RETRACTION);
    }
    if let Some(feed) = feed {
        settings.recover_speed = clamps.speed_a_minute(modal, ["M208", "F"], feed);
    }
    Answer::Nothing
}

/// M503, the line of M207.
pub(in crate::machine) fn say_retraction(to: &mut Speaker<'_>, settings: &RetractionSettings) {
    let (length, feed, lift) = (exact(settings.length), exact(Mm::from(settings.speed) * 60), exact(settings.lift));
    to.say(format_args!("echo:  M207 S{length} F{feed} Z{lift}"));
}

/// M503, the line of M208.
pub(in crate::machine) fn say_recovery(to: &mut Speaker<'_>, settings: &RetractionSettings) {
    let (extra, feed) = (exact(settings.extra), exact(Mm::from(settings.recover_speed) * 60));
    to.say(format_args!("echo:  M208 S{extra} F{feed}"));
}
