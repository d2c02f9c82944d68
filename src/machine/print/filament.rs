//! M603, M701, M702: filament goes in and comes out by lengths that M603 sets. M500 does not keep them.

use super::parking::change;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature, Part};
use crate::machine::print::pause::{LOAD_SPEED, UNLOAD_SPEED};
use crate::settings::Range;
use crate::units::Mm;

const FAMILY: &str = "Jobs, pauses and waits";

/// T is the tool, of which there is one.
const TOOL: &[(u8, Part)] = &[(b'T', Part::Tool)];

pub(in crate::machine) const LENGTHS: Entry = Entry::m(FAMILY, &[603])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"LU").parts(TOOL))
    .does("L U", "lengths that M701 pushes in and M702 pulls out; or reports")
    .examples(&[
        ("M603", &["  M603 L100 U100"]),
        ("M603 U80", &[]),
        ("M603 L-1", &["echo:M603 ignored: L-1 is out of range (0 to 2000), stays 100"]),
    ]);

pub(in crate::machine) const LOAD: Entry = Entry::m(FAMILY, &[701])
    .nature(Nature::Work)
    .mark(Mark::AfterRest)
    .grammar(&Grammar::numbers(b"L").parts(TOOL))
    .does("L", "pushes filament in, at 6 mm/s; a hotend that is too cold moves none")
    .examples(&[("M701 L5", &[])]);

pub(in crate::machine) const UNLOAD: Entry = Entry::m(FAMILY, &[702])
    .nature(Nature::Work)
    .mark(Mark::AfterRest)
    .grammar(&Grammar::numbers(b"U").parts(TOOL))
    .does("U", "pulls filament out, at 10 mm/s; a hotend that is too cold moves none")
    .examples(&[("M702 U5", &[])]);

/// The longest tube that filament is pulled out of.
const LENGTH: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(2000) };

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let (code, letters): (&str, &[(&str, u8)]) = match command.code() {
        701 => ("M701", &[("L", b'L')]),
        702 => ("M702", &[("U", b'U')]),
        _ => ("M603", &[("L", b'L'), ("U", b'U')]),
    };
    let (mut lengths, mut is_given) = (states.filament, false);
    for (name, letter) in letters {
        let [load, unload] = &mut lengths;
        if let Some(number) = command.number(*letter) {
            is_given = true;
            let length = if *letter == b'L' { load } else { unload };
            states.clamps.length(&states.modal, [code, name], number, LENGTH, length);
        }
    }
    if states.clamps.refuses_line() {
        return Ok(Answer::Nothing);
    }
    let [load, unload] = lengths;
    match command.code() {
        603 if !is_given => {
            let [load, unload] = lengths.map(|length| length.to_num::<i32>());
            main_loop.tell(|to, _| to.setting(text!("M603 L{load} U{unload}")));
            return Ok(Answer::Said);
        }
        603 => states.filament = lengths,
        701 => push(main_loop, states, load, true).await?,
        _ => push(main_loop, states, unload, false).await?,
    }
    Ok(Answer::Nothing)
}

/// Filament goes in, or comes out, in moves of the longest length that one may have.
async fn push<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &States,
    length: Mm,
    goes_in: bool,
) -> Result<(), Interrupt> {
    let (most, mut left) = (main_loop.settings.axes.e.length, length);
    while left > Mm::ZERO {
        let part = left.min(most);
        left = if states.is_too_cold(main_loop) { Mm::ZERO } else { left.saturating_sub(part) };
        let (by, speed) = if goes_in { (part, LOAD_SPEED) } else { (part.saturating_neg(), UNLOAD_SPEED) };
        change(main_loop, states, by, speed).await?;
    }
    Ok(())
}
