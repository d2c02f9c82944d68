//! G35: how far each hand screw at the corners of the bed is to be turned.

use super::screws::tell_hand_screws;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature};

/// S is the thread: 30, 40, 50 for M3, M4, M5; one more for a thread that turns the other way.
pub(in crate::machine) const ENTRY: Entry = Entry::g("Motors and drivers", &[35])
    .nature(Nature::Work)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"S"))
    .does("S", "probes the corners of the bed, and says how far to turn each hand screw; thread: 30, 40, 50 is M3..")
    .examples(&[
        ("G35 S40", &["echo:no probe configured, ignored"]),
        ("G35 S60", &["echo:G35 ignored: S is 30, 31, 40, 41, 50 or 51"]),
    ]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    tell_hand_screws(main_loop, command.number(b'S')).await
}
