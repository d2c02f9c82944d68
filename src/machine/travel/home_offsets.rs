//! M428: home offsets by which the program counts from now on as if each axis stood at its switch, or at 0 if a switch
//! at the upper end is too far away (Marlin). Nothing moves.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature};
use crate::machine::main_loop::offsets::use_home_offsets;
use crate::machine::main_loop::place::tell_place;
use crate::settings::{AxisEnd, HomedAxis, Range};
use crate::units::Mm;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Offsets", &[428])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "home offsets (M206) that make the present place that of the switches, at most 20 mm away")
    .examples(&[("M428", &["echo:Too far from reference point"])]);

/// How far it reaches (Marlin, M428.cpp).
const NEAR: Range<Mm> = Range { least: Mm::const_from_int(-20), most: Mm::const_from_int(20) };

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Answer::Line(packed!("echo:M428 ignored: home first (G28)"));
    }
    let mut offsets = main_loop.settings.home_offsets();
    for ((offset, at), axis) in offsets.iter_mut().zip(main_loop.commanded.position()).zip(HomedAxis::ALL) {
        let endstop = main_loop.settings.endstops.of(axis);
        *offset = endstop.position.saturating_sub(at);
        if !NEAR.holds(*offset) && endstop.end == AxisEnd::Max {
            *offset = -at;
        }
        if !NEAR.holds(*offset) {
            return Answer::Line(packed!("echo:Too far from reference point"));
        }
    }
    use_home_offsets(main_loop, offsets);
    tell_place(main_loop, false)
}
