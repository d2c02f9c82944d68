//! M25, M125, M24, M602: pause the print, and continue it.

use super::park_words::ParkWords;
use super::pause::{pause, resume};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

pub(in crate::machine) const PAUSE: Entry = Entry::m("Jobs, pauses and waits", &[25])
    .nature(Nature::Work)
    .does("", "pauses")
    .examples(&[("M25", &["//action:paused action:pause"])]);

/// It parks the tool even if nothing is printed.
pub(in crate::machine) const PARK: Entry = Entry::m("Jobs, pauses and waits", &[125])
    .nature(Nature::Work)
    .does("X Y Z L", "pauses and parks, also without a print")
    .examples(&[("M125", &["//action:paused action:pause"]), ("M125 L1 X20 Z2 P1", &["//action:paused action:pause"])]);

/// A wait for the user is ended on the receive path.
pub(in crate::machine) const RESUME: Entry =
    Entry::m("Jobs, pauses and waits", &[24, 602]).does("", "resumes").examples(&[("M24", &[]), ("M602", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let (parks, words) = match command.code() {
        25 => (false, ParkWords::default()),
        125 => (true, ParkWords::of_pause(command)),
        _ => return resume(main_loop, states).await,
    };
    pause(main_loop, states, parks, &words).await
}
