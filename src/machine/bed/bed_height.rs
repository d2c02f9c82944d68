//! G30: the height of the bed at a place, where the probe is if none is named.

use super::probing::{place, tell_of_home_offsets};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature, Number};
use crate::machine::main_loop::place::tell_place;
use crate::machine::numbers::Hundredths;
use crate::machine::numbers::Thousandths;
use crate::machine::probe::touch::{AfterTouch, touch_bed};

pub(in crate::machine) const ENTRY: Entry = Entry::g("Z probe", &[30])
    .nature(Nature::Work)
    .mark(Mark::NeedsProbe)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"XYE"))
    .does("X Y E", "height of the bed below the probe, or at that place of the probe; E0 leaves it out")
    .examples(&[("G30", &["echo:no probe configured, ignored"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let named = command.numbers(b"XY");
    let at = match place(main_loop, modal, named) {
        Ok(at) => at,
        Err(none) => return Ok(none.answer(main_loop)),
    };
    if named != [None; 2] {
        tell_of_home_offsets(main_loop);
    }
    let end = if command.number(b'E') == Some(Number::ZERO) { AfterTouch::Out } else { AfterTouch::In };
    let height = touch_bed(main_loop, Some(at), end).await?;
    // Marlin's words (G30.cpp).
    let [x, y] = at.map(Hundredths::of);
    main_loop.say(text!("Bed X:{x} Y:{y} Z:{}", Thousandths(height)));
    Ok(tell_place(main_loop, false))
}
