//! M106: the speed of a fan, in its turn among the moves.

use super::fans::order_fan;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Number, Part};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[106])
    .grammar(&Grammar::numbers(b"SP").parts(&[(b'I', Part::Preset)]))
    .does("P S", "fan P: S of 255")
    .examples(&[
        ("M106", &[]),
        ("M106 S91.8", &[]),
        ("M106 P3 S10", &[]),
        ("M106 P9 S10", &["echo:M106 ignored: there is no fan 9"]),
        ("M106 P-1", &["echo:M106 ignored: there is no fan of that number"]),
        ("M106 P1", &["echo:fan 1 is not commanded"]),
        ("M106 S300", &["echo:M106 S300 is out of range, set to 255"]),
        ("M106 S-5", &["echo:M106 S-5 is out of range, set to 0"]),
        ("M106 Sinf", &["echo:line ignored: S needs a number"]),
    ]);

/// Without S it is full speed.
const FULL_SPEED: i32 = 255;

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    order_fan(main_loop, states, command, command.number(b'S').unwrap_or(Number::from(FULL_SPEED))).await
}
