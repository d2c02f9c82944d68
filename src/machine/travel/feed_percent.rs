//! M220: the feed override in percent.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature};
use crate::machine::state::modal::PERCENT;

/// B and R stand alone in practice; with either of them S is ignored.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[220])
    .nature(Nature::Mode)
    .mark(Mark::SaidOnConnecting)
    .grammar(&Grammar::numbers(b"S"))
    .does("S, B, R", "feed in percent; B keeps it, R restores it; or reports")
    .examples(&[
        ("M220 S90", &[]),
        ("M220", &["FR:100%"]),
        ("M220 B", &[]),
        ("M220 R", &[]),
        ("M220 S5", &["echo:M220 S5 is out of range, set to 10"]),
    ]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if command.has(b'B') {
        modal.kept_feed_percent = main_loop.motion.feed_percent();
    } else if command.has(b'R') {
        main_loop.override_feed(modal.kept_feed_percent).await?;
    } else if let Some(number) = command.number(b'S') {
        if let Some(percent) = clamps.whole_of(["M220", "S"], number, PERCENT, None) {
            main_loop.override_feed(percent).await?;
        }
    } else {
        main_loop.say(text!("FR:{}%", main_loop.motion.feed_percent()));
        return Ok(Answer::Said);
    }
    Ok(Answer::Nothing)
}
