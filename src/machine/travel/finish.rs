//! M400: waits until the motion has ended, and with U1 for the user.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature, Number};
use crate::machine::print::park_words::ParkWords;
use crate::machine::print::pause::await_user;

/// With U1 it is the pause of Bambu's slicer, as M601.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[400])
    .nature(Nature::Mode)
    .works_if(pauses)
    .mark(Mark::AfterRest)
    .grammar(&Grammar::numbers(b""))
    .does("U", "waits until the motion has ended; U1 then pauses until the user answers")
    .examples(&[
        ("M400", &[]),
        ("M400 U0", &[]),
        ("M400 U1", &["//action:paused", "*", "*", "*", "echo:busy: paused for user", "*", "//action:resumed"]),
    ]);

/// Whether it pauses.
fn pauses(command: &TableCommand<'_>) -> bool {
    command.number(b'U').is_some_and(|number| number != Number::ZERO)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if pauses(command) {
        return await_user(main_loop, states, (0, false), &ParkWords::default()).await;
    }
    Ok(Answer::Nothing)
}
