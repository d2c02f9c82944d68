//! M211: moves are kept inside the reachable space.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature};
use crate::machine::answers::words::Facts;
use crate::machine::numbers::Hundredths;
use crate::settings::HomedAxis;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Settings", &[211])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("S", "soft endstops; or reports")
    .examples(&[
        ("M211 S1", &[]),
        ("M211", &["Soft endstops: ON  Min:  X0.00 Y0.00 Z0.00   Max:  X390.00 Y417.60 Z335.00"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.switch() {
        Some(on) => {
            main_loop.live_settings().set_soft_endstops(on);
            Answer::Nothing
        }
        None => {
            let known = if main_loop.homed.lacks_one_of([true; 3]) { "  (once homed)" } else { "" };
            main_loop.tell(|to, Facts { settings: s, .. }| {
                let state = if s.soft_endstops { "ON" } else { "OFF" };
                let reaches = HomedAxis::ALL.map(|axis| s.reach(axis));
                let [[x, to_x], [y, to_y], [z, to_z]] =
                    reaches.map(|reach| [reach.least, reach.most].map(Hundredths::of));
                to.say(text!("Soft endstops: {state}  Min:  X{x} Y{y} Z{z}   Max:  X{to_x} Y{to_y} Z{to_z}{known}"));
            });
            Answer::Said
        }
    }
}
