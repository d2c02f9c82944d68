//! M48: how much touches at a place differ.

use super::probing::{place, tell_of_home_offsets};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature, Number};
use crate::machine::numbers::Thousandths;
use crate::machine::probe::repeatability::{Repeatability, Spread};
use crate::machine::probe::touch::{AfterTouch, find_bed, set_out, touch_again};
use crate::machine::state::clamps::Clamps;
use crate::machine::states::tell_clamps;
use crate::settings::Range;
use crate::units::Mm;
use core::fmt;

/// V0 tells the deviation alone, V2 each touch. With L or S the tool is to move in between, which it does not.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Z probe", &[48])
    .nature(Nature::Work)
    .mark(Mark::NeedsProbe)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"PXYV"))
    .does("P X Y V", "touches the bed P times at a place and reports how much they differ; V2 reports each")
    .examples(&[("M48", &["echo:no probe configured, ignored"])]);

/// Touches of M48 (Marlin, M48.cpp).
const TOUCHES: Range<u16> = Range { least: 4, most: 50 };

/// The same without P.
const USUAL_TOUCHES: u16 = 10;

/// What it tells (V).
const VERBOSITY: Range<u16> = Range { least: 0, most: 4 };

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let touches = whole(clamps, "P", command.number(b'P'), TOUCHES, USUAL_TOUCHES);
    let verbosity = whole(clamps, "V", command.number(b'V'), VERBOSITY, 1);
    if clamps.refuses_line() {
        return Ok(Answer::Nothing);
    }
    let named = command.numbers(b"XY");
    match place(main_loop, modal, named) {
        Ok(at) => {
            if named != [None; 2] {
                tell_of_home_offsets(main_loop);
            }
            repeat(main_loop, at, touches, verbosity).await?;
        }
        Err(none) => {
            tell_clamps(main_loop, clamps);
            return Ok(none.answer(main_loop));
        }
    }
    Ok(if command.has(b'L') {
        Answer::NotObeyed("M48", b"L")
    } else if command.has(b'S') {
        Answer::NotObeyed("M48", b"S")
    } else {
        Answer::Nothing
    })
}

fn whole(clamps: &mut Clamps, letter: &'static str, number: Option<Number>, range: Range<u16>, usual: u16) -> u16 {
    number.and_then(|number| clamps.whole_of(["M48", letter], number, range, None)).unwrap_or(usual)
}

/// Each touch counts by itself, unlike those of G30. So the deviation is that of the probe. The words are those of
/// Marlin's M48.cpp.
async fn repeat<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    at: [Mm; 2],
    touches: u16,
    verbosity: u16,
) -> Result<(), Interrupt> {
    if verbosity > 0 {
        main_loop.say(text!("M48 Z-Probe Repeatability Test"));
    }
    find_bed(main_loop, Some(at)).await?;
    let mut found = Repeatability::default();
    for number in 1..=touches {
        let height = touch_again(main_loop).await?;
        found.add(height);
        if verbosity > 1 {
            let height = Thousandths(height);
            main_loop.reply(Answer::words(&|to, _| to.say(text!("{number} of {touches}: z: {height}")))).await?;
        }
    }
    set_out(main_loop, AfterTouch::In).await?;
    let Spread { mean_nm, least, most, sigma_nm } = found.spread();
    main_loop.say(text!("Finished!"));
    if verbosity > 0 {
        let range = Thousandths(most.saturating_sub(least));
        let [least, most] = [least, most].map(Thousandths);
        main_loop.say(text!("Mean: {} Min: {least} Max: {most} Range: {range}", Millionths(mean_nm)));
    }
    main_loop.say(text!("Standard Deviation: {}", Millionths(sigma_nm.cast_signed())));
    Ok(())
}

/// Nanometres as mm with six decimals.
struct Millionths(i64);

impl fmt::Display for Millionths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sign, size) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        write!(f, "{sign}{}.{:06}", size / 1_000_000, size % 1_000_000)
    }
}
