//! M422: where the screws of z are, and the points of the bed that are probed for them.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Number};
use crate::kinematics::SCREWS;
use crate::machine::reports::setting::Setting;
use crate::machine::reports::settings_report::report_setting;
use crate::settings::{Range, Screw, WholePlace, ranges};
use crate::units::Mm;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motors and drivers", &[422])
    .grammar(&Grammar::numbers(b"SWXY"))
    .does("S X Y, W X Y, R", "point that is probed for a screw of z (S), its place (W), as made (R); or reports")
    .examples(&[
        ("M422", &["  M422 S1 X40 Y200", "  M422 W1 X-25 Y200", "  M422 S2 X350 Y200", "  M422 W2 X415 Y200"]),
        ("M422 S2 X300", &[]),
        ("M422 S1 W1", &["echo:M422 ignored: S is a probed point, W a screw; give one of them"]),
        ("M422 R", &[]),
    ]);

/// Half a mm: places are rounded.
const HALF: Mm = const { Mm::lit("0.5") };

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    if command.has(b'R') {
        let screws = main_loop.settings.defaults().screws;
        main_loop.live_settings().set_screws(screws);
        return Answer::Nothing;
    }
    let [point, place, x, y] = [b'S', b'W', b'X', b'Y'].map(|letter| command.number(letter));
    let (letter, screw) = match (point, place) {
        (None, None) => return Answer::words(&|to, facts| report_setting(to, Setting::Screws, facts.settings)),
        (Some(screw), None) => ("S", screw),
        (None, Some(screw)) => ("W", screw),
        (Some(_), Some(_)) => {
            return Answer::Line(packed!("echo:M422 ignored: S is a probed point, W a screw; give one of them"));
        }
    };
    let numbers = Range { least: 1, most: SCREWS as u16 };
    let Some(number) = clamps.whole_of(["M422", letter], screw, numbers, None) else { return Answer::Nothing };
    let mut screws = main_loop.settings.screws;
    let Some(screw) = screws.get_mut(usize::from(number) - 1) else { return Answer::Nothing };
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
        main_loop.live_settings().set_screws(screws);
    }
    Answer::Nothing
}
